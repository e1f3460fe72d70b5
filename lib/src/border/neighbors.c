/* SPDX-License-Identifier: MIT */
#include "border/neighbors.h"

#include <math.h>
#include <stdlib.h>

#include "common/mem.h"

enum {
    LATTICE = 64,        /* points along each axis of the output */
    MOST_NEIGHBORS = 2 * L1L2_BORDER_MAX_FRAMES + 1
};

/* A neighbor is used if it brings the missing points nearer by so many frames in the mean. Each one takes time. */
static const double least_gain = 0.3;
/* A neighbor is rendered this far around the points that it is shown at: from point to point, and the blend. */
static const double part_reach = 3.0;

typedef struct MissingPoint {
    L1L2Point at;    /* in the frame that is filled */
    L1L2Point out;   /* in the output, pixels from its top left corner */
    int64_t distance; /* to the frame that shows it, frames; more than any if none does */
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
                missing->point[missing->count++] = (MissingPoint){at, out, L1L2_BORDER_MAX_FRAMES + 1};
        }
}

/* What the search goes through. */
typedef struct Search {
    const L1L2BorderNeed *need;
    const L1L2BorderNeighbor *neighbors;
    int count;
    int64_t gain[MOST_NEIGHBORS]; /* of each neighbor: as it was when it was worked out last */
    L1L2BorderChoice choice;
    L1L2BorderMissing *missing;
} Search;

static bool covers(const Search *search, int neighbor, const MissingPoint *point)
{
    const L1L2Point at = l1l2_mat_apply_affine(&search->neighbors[neighbor].map, point->at);
    return inside(at, 0.5 * search->need->width - L1L2_BORDER_MARGIN_PX,
                  0.5 * search->need->height - L1L2_BORDER_MARGIN_PX);
}

static int64_t distance(const Search *search, int neighbor)
{
    return llabs(search->neighbors[neighbor].t - search->need->t);
}

/* What it costs to show a point from a neighbor so far away, or to have nothing to show. */
/* How much nearer a neighbor would bring the missing points, all together. */
static int64_t gain_of(const Search *search, int neighbor)
{
    const int64_t away = distance(search, neighbor);
    int64_t gain = 0;
    for (int i = 0; i < search->missing->count; i++) {
        const MissingPoint *point = &search->missing->point[i];
        if (point->distance > away && covers(search, neighbor, point))
            gain += point->distance - away;
    }
    return gain;
}

/* Adds a neighbor, in the order of distance. */
static void choose(Search *search, int neighbor)
{
    L1L2BorderChoice *choice = &search->choice;
    const int64_t away = distance(search, neighbor);
    int place = choice->count++;
    for (; place > 0 && distance(search, choice->neighbor[place - 1]) > away; place--)
        choice->neighbor[place] = choice->neighbor[place - 1];
    choice->neighbor[place] = neighbor;
    for (int i = 0; i < search->missing->count; i++) {
        MissingPoint *point = &search->missing->point[i];
        if (point->distance > away && covers(search, neighbor, point))
            point->distance = away;
    }
}

static int best_of(const Search *search)
{
    int best = 0;
    for (int k = 1; k < search->count; k++)
        if (search->gain[k] > search->gain[best])
            best = k;
    return best;
}

/* One neighbor after the other, each time the one that gains most. A gain only falls while others are chosen. So a
 * neighbor whose gain is still the largest after it was worked out again is the best one. */
static void choose_all(Search *search)
{
    const double least = fmax(least_gain * search->missing->count, 1.0);
    for (int k = 0; k < search->count; k++)
        search->gain[k] = gain_of(search, k);
    while (search->count > 0 && search->choice.count < L1L2_BORDER_MAX_SOURCES) {
        const int best = best_of(search);
        if ((double)search->gain[best] < least)
            return;
        search->gain[best] = gain_of(search, best);
        if (best_of(search) != best || (double)search->gain[best] < least)
            continue;
        choose(search, best);
        search->gain[best] = 0;
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
    choose_all(&search);
    share_out(&search);
    return search.choice;
}
