/* SPDX-License-Identifier: MIT */
#include "border/neighbors.h"

#include <math.h>
#include <stdlib.h>

#include "common/mem.h"

enum {
    LATTICE = 64,        /* points along each axis of the output */
    MARGIN_PX = 2,       /* a neighbor's outermost pixels are not relied on */
    FAR_SOURCES = 3      /* are reserved for what the nearest neighbors do not cover */
};

/* A neighbor is used if it covers this part of the missing points that are not covered yet: a near one, a far one. Near
 * ones that cover little cost time and places. */
static const double least_near_share = 0.1, least_far_share = 0.003;
/* A neighbor is rendered this far around the points that it is shown at: from point to point, and the blend. */
static const double part_reach = 3.0;

typedef struct MissingPoint {
    L1L2Point at;    /* in the frame that is filled */
    L1L2Point out;   /* in the output, pixels from its top left corner */
    bool covered;
} MissingPoint;

struct L1L2BorderMissing {
    int count;
    MissingPoint point[LATTICE * LATTICE];
};

L1L2BorderMissing *l1l2_border_missing_new(void)
{
    return l1l2_mem_new(1, sizeof(L1L2BorderMissing));
}

void l1l2_border_missing_free(L1L2BorderMissing *missing)
{
    l1l2_mem_free(missing);
}

static bool inside(L1L2Point p, double half_w, double half_h)
{
    return fabs(p.x) <= half_w && fabs(p.y) <= half_h;
}

static void find_missing(L1L2BorderMissing *missing, const L1L2BorderNeed *need)
{
    const double width = need->width, height = need->height, half_w = 0.5 * width, half_h = 0.5 * height;
    missing->count = 0;
    for (int row = 0; row < LATTICE; row++)
        for (int column = 0; column < LATTICE; column++) {
            const L1L2Point out = {(double)column / (LATTICE - 1) * width, (double)row / (LATTICE - 1) * height};
            const L1L2Point at = l1l2_mat_apply(need->map, (L1L2Point){out.x - half_w, out.y - half_h});
            if (!inside(at, half_w, half_h))
                missing->point[missing->count++] = (MissingPoint){at, out, false};
        }
}

/* What the search goes through. */
typedef struct Search {
    const L1L2BorderNeed *need;
    const L1L2BorderNeighbor *neighbors;
    int count;
    L1L2BorderChoice choice;
    L1L2BorderMissing *missing;
} Search;

static bool covers(const Search *search, int neighbor, const MissingPoint *point)
{
    const double *m = search->neighbors[neighbor].map.m; /* affine */
    const L1L2Point p = point->at, at = {m[0] * p.x + m[1] * p.y + m[2], m[3] * p.x + m[4] * p.y + m[5]};
    return inside(at, 0.5 * search->need->width - MARGIN_PX, 0.5 * search->need->height - MARGIN_PX);
}

static int64_t distance(const Search *search, int neighbor)
{
    return llabs(search->neighbors[neighbor].t - search->need->t);
}

/* How many points a neighbor would add. */
static int gain_of(const Search *search, int neighbor)
{
    int gain = 0;
    for (int i = 0; i < search->missing->count; i++)
        gain += !search->missing->point[i].covered && covers(search, neighbor, &search->missing->point[i]);
    return gain;
}

/* Adds a neighbor, in the order of distance. */
static void choose(Search *search, int neighbor)
{
    L1L2BorderChoice *choice = &search->choice;
    int place = choice->count++;
    for (; place > 0 && distance(search, choice->neighbor[place - 1]) > distance(search, neighbor); place--)
        choice->neighbor[place] = choice->neighbor[place - 1];
    choice->neighbor[place] = neighbor;
    for (int i = 0; i < search->missing->count; i++) {
        MissingPoint *point = &search->missing->point[i];
        point->covered = point->covered || covers(search, neighbor, point);
    }
}

/* The nearest neighbors that are of use. Of two that are as far, the one that adds more comes first. */
static void choose_near(Search *search)
{
    const double least = fmax(least_near_share * search->missing->count, 1.0);
    for (int64_t d = 1; d <= L1L2_BORDER_MAX_FRAMES; d++) {
        int at[2] = {-1, -1}, gain[2] = {0, 0}, found = 0;
        for (int k = 0; k < search->count && found < 2; k++)
            if (distance(search, k) == d)
                at[found++] = k;
        for (int i = 0; i < found; i++)
            gain[i] = gain_of(search, at[i]);
        const int first = gain[1] > gain[0];
        for (int i = 0; i < found && search->choice.count < L1L2_BORDER_MAX_SOURCES - FAR_SOURCES; i++) {
            const int k = at[i == 0 ? first : !first];
            if (k >= 0 && gain_of(search, k) >= least)
                choose(search, k);
        }
    }
}

/* Those that cover most of the rest. */
static void choose_far(Search *search)
{
    while (search->choice.count < L1L2_BORDER_MAX_SOURCES) {
        int best = -1, most = (int)fmax(least_far_share * search->missing->count, 1.0) - 1;
        for (int k = 0; k < search->count; k++) {
            const int gain = gain_of(search, k);
            if (gain > most) {
                best = k;
                most = gain;
            }
        }
        if (best < 0)
            return;
        choose(search, best);
    }
}

static int aligned_down(double at, int least)
{
    const int value = (int)floor(at / L1L2_BORDER_ALIGN) * L1L2_BORDER_ALIGN;
    return value > least ? value : least;
}

static int aligned_up(double at, int most)
{
    const int value = (int)ceil(at / L1L2_BORDER_ALIGN) * L1L2_BORDER_ALIGN;
    return value < most ? value : most;
}

/* Makes a strip's part hold a point, with what is around it up to the points beside it. */
static void include(L1L2WarpRect *part, const L1L2WarpRect *strip, L1L2Point at, double reach_x, double reach_y)
{
    const L1L2WarpRect around = {aligned_down(at.x - reach_x, strip->left), aligned_down(at.y - reach_y, strip->top),
                                 aligned_up(at.x + reach_x, strip->right), aligned_up(at.y + reach_y, strip->bottom)};
    if (l1l2_border_is_empty(&around))
        return;
    if (l1l2_border_is_empty(part)) {
        *part = around;
        return;
    }
    part->left = around.left < part->left ? around.left : part->left;
    part->top = around.top < part->top ? around.top : part->top;
    part->right = around.right > part->right ? around.right : part->right;
    part->bottom = around.bottom > part->bottom ? around.bottom : part->bottom;
}

/* Which parts each chosen neighbor has to be rendered in: each point is shown by the nearest one that covers it. */
static void share_out(Search *search)
{
    for (int i = 0; i < search->choice.count; i++)
        search->choice.part[i].count = L1L2_BORDER_STRIPS;
    const double reach_x = part_reach * search->need->width / (LATTICE - 1);
    const double reach_y = part_reach * search->need->height / (LATTICE - 1);
    for (int i = 0; i < search->missing->count; i++) {
        const MissingPoint *point = &search->missing->point[i];
        int shown = 0;
        while (shown < search->choice.count && !covers(search, search->choice.neighbor[shown], point))
            shown++;
        for (int k = 0; shown < search->choice.count && k < L1L2_BORDER_STRIPS; k++)
            include(&search->choice.part[shown].rect[k], &search->need->strips.rect[k], point->out, reach_x, reach_y);
    }
}

L1L2BorderChoice l1l2_border_choose(L1L2BorderMissing *missing, const L1L2BorderNeed *need,
                                    const L1L2BorderNeighbor *neighbors, int count)
{
    Search search = {.need = need, .neighbors = neighbors, .count = count, .missing = missing};
    find_missing(missing, need);
    choose_near(&search);
    choose_far(&search);
    share_out(&search);
    return search.choice;
}
