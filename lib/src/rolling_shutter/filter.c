/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/filter.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/mem.h"
#include "rolling_shutter/mesh.h"

/* Of the sum in wobble.h. The memory is 1/sqrt(leak) frames: longer gathers errors, shorter leaves slow wobble. */
static const double leak = 0.03;
/* w_t where nothing was measured; it is 0 where a path starts, and else 1. */
static const double unmeasured = 0.1;
/* What bends the frame more is scaled down: diagonals, and parts of its length by which it becomes longer one way than
 * across. A fast pan leans by more; the picture shall not be made over, even where that would be right. */
static const double max_reach = 0.02, max_stretch = 0.03;

/* The differences count as far as each witness explains them, over some frames. Of halves of the points, noise alone
 * explains -6 %, ten real clips 3 to 72 %; where it was under 30 % one got worse. Of what the inner columns do, the
 * outer ones and they explain 10 to 50 % on real clips, 90 % where the shutter is all there is, and less than nothing
 * where something in the middle moved slowly by itself. The camera explains 30 to 80 % on real clips, 80 to 98 % where
 * the shutter is all there is, and of what moves by itself 5 % at most, in 95 of 100 frames. */
static const struct {
    int witness;
    double little, enough;
} gate[] = {{L1L2_SPLIT_HALVES, 0.3, 0.5}, {L1L2_SPLIT_COLUMNS, 0.0, 0.15}, {L1L2_VALIDATION_CAMERA, 0.15, 0.3}};
static const double explained_fade = 0.95;

/* The readout is believed where it explains so much of what the rows do, and where it is possible at all. */
static const double min_agreement = 0.4, full_agreement = 0.6, max_readout = 1.0, impossible_readout = 1.5;
static const double forget = 0.998; /* each frame: another lens setting, another mode */
enum { MIN_FRAMES = 20, AROUND = 4 /* frames before and after one that its share in the readout takes */ };

typedef struct Item {
    L1L2Mat F;
    L1L2ShutterMeasurement step;
    bool measured;
    double weight; /* w_t */
} Item;

struct L1L2ShutterFilter {
    L1L2ShutterFilterConfig cfg;
    L1L2ShutterModel shape;
    L1L2WarpMesh mesh;
    Item *items;          /* frame t at t modulo capacity */
    int capacity;
    int64_t pushed, pulled;
    L1L2ShutterResidual last;    /* e of the frame pulled last */
    L1L2ShutterResidual last_guess; /* k of it */
    L1L2ShutterResidual given;   /* the same, as it was given out */
    double explained[L1L2_VALIDATIONS], all[L1L2_VALIDATIONS]; /* of the frames before, fading */
    double xy, xx, yy, n; /* sums for the readout: accelerations x, changes of the skew y */
};

static Item *item(const L1L2ShutterFilter *w, int64_t t)
{
    return &w->items[t % w->capacity];
}

L1L2StabResult l1l2_shutter_filter_create(L1L2ShutterFilter **out, const L1L2ShutterFilterConfig *cfg)
{
    *out = NULL;
    if (cfg->model == L1L2STAB_ROLLING_SHUTTER_NONE)
        return L1L2STAB_OK;
    L1L2ShutterFilter *w = l1l2_mem_new(1, sizeof *w);
    if (!w)
        return L1L2STAB_ERR_NOMEM;
    const double diagonal_px = hypot(cfg->in_width, cfg->in_height);
    w->cfg = *cfg;
    w->shape = (L1L2ShutterModel){cfg->model, 0.5 * cfg->in_width / diagonal_px, 0.5 * cfg->in_height / diagonal_px};
    w->capacity = cfg->capacity + 2 * AROUND + 1;
    w->items = l1l2_mem_new((size_t)w->capacity, sizeof *w->items);
    if (!w->items || !l1l2_warp_mesh_init(&w->mesh, cfg->out_width, cfg->out_height)) {
        l1l2_shutter_filter_free(w);
        return L1L2STAB_ERR_NOMEM;
    }
    l1l2_shutter_filter_reset(w);
    *out = w;
    return L1L2STAB_OK;
}

void l1l2_shutter_filter_free(L1L2ShutterFilter *w)
{
    if (!w)
        return;
    l1l2_mem_free(w->items);
    l1l2_warp_mesh_clear(&w->mesh);
    l1l2_mem_free(w);
}

static void forget_explained(L1L2ShutterFilter *w)
{
    memset(w->explained, 0, sizeof w->explained);
    memset(w->all, 0, sizeof w->all);
}

void l1l2_shutter_filter_reset(L1L2ShutterFilter *w)
{
    if (!w)
        return;
    w->pushed = w->pulled = 0;
    memset(&w->last, 0, sizeof w->last);
    memset(&w->last_guess, 0, sizeof w->last_guess);
    memset(&w->given, 0, sizeof w->given);
    forget_explained(w);
    w->xy = w->xx = w->yy = w->n = 0.0;
}

/* How fast the bands' translations change with the row, from the first row to the last. */
static L1L2Point slope(const L1L2ShutterResidual *r)
{
    L1L2Point sum = {0.0, 0.0};
    double norm = 0.0;
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        const double row = l1l2_shutter_band_row(k);
        sum.x += row * r->p[L1L2_SHUTTER_X + k], sum.y += row * r->p[L1L2_SHUTTER_Y + k];
        norm += row * row;
    }
    return (L1L2Point){sum.x / norm, sum.y / norm};
}

/* A row's skew is the readout times the camera's speed, so its change is the readout times the acceleration: here the
 * difference of the speeds at frames t-1 and t. Both are low-passed alike, for between frames
 * the path is known only where it is slow. */
static void learn_readout(L1L2ShutterFilter *w)
{
    static const double derivative[5] = {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0};
    static const double lowpass[5] = {0.0625, 0.25, 0.375, 0.25, 0.0625};
    const int64_t t = w->pushed - 1 - AROUND;
    if (t < AROUND)
        return;
    for (int j = -AROUND; j <= AROUND; j++)
        if (item(w, t + j)->weight < 1.0)
            return;
    L1L2Point x = {0.0, 0.0}, y = {0.0, 0.0};
    for (int j = -2; j <= 2; j++) {
        const L1L2Point change = slope(&item(w, t + j)->step.r);
        for (int k = -2; k <= 2; k++) {
            const L1L2Mat *F = &item(w, t + j + k)->F;
            x.x += lowpass[j + 2] * derivative[k + 2] * F->m[2];
            x.y += lowpass[j + 2] * derivative[k + 2] * F->m[5];
        }
        y.x += lowpass[j + 2] * change.x, y.y += lowpass[j + 2] * change.y;
    }
    w->xy = forget * w->xy + x.x * y.x + x.y * y.y;
    w->xx = forget * w->xx + x.x * x.x + x.y * x.y;
    w->yy = forget * w->yy + y.x * y.x + y.y * y.y;
    w->n = forget * w->n + 1.0;
}

static double ramp(double value, double from, double to)
{
    return fmin(fmax((value - from) / (to - from), 0.0), 1.0);
}

double l1l2_shutter_filter_readout(const L1L2ShutterFilter *w)
{
    if (!w || w->shape.kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE || w->n < MIN_FRAMES ||
        !(w->xx > 0.0 && w->yy > 0.0))
        return 0.0;
    const double readout = w->xy / w->xx, agreement = w->xy * w->xy / (w->xx * w->yy);
    const double belief = ramp(agreement, min_agreement, full_agreement) *
                          ramp(-fabs(readout), -impossible_readout, -1.2 * max_readout);
    return belief * fmin(fmax(readout, -max_readout), max_readout);
}

/* k_t: the camera's way from the frame's time to each row's, by its speed and acceleration at the frame. */
static L1L2ShutterResidual guess(const L1L2ShutterFilter *w, int64_t t, double readout)
{
    L1L2ShutterResidual k;
    memset(&k, 0, sizeof k);
    if (readout == 0.0)
        return k;
    const Item *here = item(w, t), *next = t + 1 < w->pushed ? item(w, t + 1) : here;
    const Item *into = here->weight > 0.0 ? here : next, *out = next->weight > 0.0 ? next : here;
    const int entry[3] = {2, 5, 3}; /* x, y, sine of the roll */
    double speed[3], acceleration[3];
    for (int i = 0; i < 3; i++) {
        speed[i] = 0.5 * (into->F.m[entry[i]] + out->F.m[entry[i]]);
        acceleration[i] = out->F.m[entry[i]] - into->F.m[entry[i]];
    }
    for (int b = 0; b < L1L2_SHUTTER_BANDS; b++) {
        const double time = readout * l1l2_shutter_band_row(b);
        k.p[L1L2_SHUTTER_X + b] = time * speed[0] + 0.5 * time * time * acceleration[0];
        k.p[L1L2_SHUTTER_Y + b] = time * speed[1] + 0.5 * time * time * acceleration[1];
    }
    k.p[L1L2_SHUTTER_ROLL_BY_ROW] = readout * speed[2];
    return k;
}

void l1l2_shutter_filter_push(L1L2ShutterFilter *w, const L1L2Mat *F, const L1L2ShutterMeasurement *step,
                              bool starts_path)
{
    if (!w)
        return;
    assert(w->pushed - w->pulled < w->cfg.capacity);
    Item *i = item(w, w->pushed);
    memset(i, 0, sizeof *i);
    starts_path = starts_path || w->pushed == 0;
    i->F = starts_path ? l1l2_mat_identity() : *F;
    i->measured = step && !starts_path;
    i->weight = starts_path ? 0.0 : step ? 1.0 : unmeasured;
    if (i->measured)
        i->step = *step;
    w->pushed++;
    if (w->shape.kind == L1L2STAB_ROLLING_SHUTTER_MIXTURE)
        learn_readout(w);
}

/* How far the differences count around frame t, [0, 1]. */
static double belief(const L1L2ShutterFilter *w, int64_t t, int64_t last)
{
    double least = 1.0;
    for (int k = 0; k < (int)(sizeof gate / sizeof *gate); k++) {
        const int witness = gate[k].witness;
        double explained = w->explained[witness], all = w->all[witness], fade = 1.0;
        for (int64_t j = t; j <= last; j++, fade *= explained_fade) {
            explained += fade * item(w, j)->step.explained[witness];
            all += fade * item(w, j)->step.all[witness];
        }
        least = fmin(least, all > 0.0 ? ramp(explained / all, gate[k].little, gate[k].enough) : 0.0);
    }
    return least;
}

/* Given e_{t-1}, all that comes after frame t costs q |e_t - r|^2 and a constant: found from the end backwards. */
static L1L2ShutterResidual estimate(const L1L2ShutterFilter *w, int64_t t)
{
    enum { LOOKAHEAD = 40 }; /* frames; by then what they say has faded to 0.1 % */
    const int size = l1l2_shutter_model_size(&w->shape);
    const double readout = l1l2_shutter_filter_readout(w);
    int64_t last = t;
    while (last + 1 < w->pushed && last < t + LOOKAHEAD && item(w, last + 1)->weight > 0.0)
        last++;
    const double believed = belief(w, t, last);
    double q = 0.0;
    L1L2ShutterResidual k = guess(w, last, readout), r, e;
    memset(&r, 0, sizeof r);
    memset(&e, 0, sizeof e);
    for (int64_t j = last; j >= t; j--) {
        const Item *i = item(w, j);
        const L1L2ShutterResidual before = j > t ? guess(w, j - 1, readout) : w->last_guess;
        const double own = leak + q; /* of e_j, when e_{j-1} is left out */
        const double measured = i->measured ? believed : 0.0;
        for (int p = 0; p < size; p++) {
            const double centre = (leak * k.p[p] + q * r.p[p]) / own;
            const double step = measured * i->step.r.p[p] + (1.0 - measured) * (k.p[p] - before.p[p]);
            if (j == t)
                e.p[p] = (own * centre + i->weight * (w->last.p[p] + step)) / (own + i->weight);
            r.p[p] = centre - step;
        }
        q = i->weight * own / (i->weight + own);
        k = before;
    }
    return e;
}

const L1L2ShutterResidual *l1l2_shutter_filter_pull(L1L2ShutterFilter *w)
{
    if (!w)
        return NULL;
    assert(w->pulled < w->pushed);
    const Item *now = item(w, w->pulled);
    if (now->weight == 0.0)
        forget_explained(w);
    w->given = w->last = estimate(w, w->pulled);
    w->last_guess = guess(w, w->pulled, l1l2_shutter_filter_readout(w));
    for (int k = 0; k < L1L2_VALIDATIONS; k++) {
        w->explained[k] = explained_fade * (w->explained[k] + now->step.explained[k]);
        w->all[k] = explained_fade * (w->all[k] + now->step.all[k]);
    }
    w->pulled++;
    const double excess = fmax(l1l2_shutter_residual_reach(&w->shape, &w->last) / max_reach,
                               l1l2_shutter_residual_stretch(&w->shape, &w->last) / max_stretch);
    for (int p = 0; p < L1L2_SHUTTER_SIZE && excess > 1.0; p++)
        w->given.p[p] /= excess;
    return &w->given;
}

const L1L2WarpMesh *l1l2_shutter_filter_mesh(L1L2ShutterFilter *w, const L1L2Mat *map, double part, double *reach_px)
{
    *reach_px = 0.0;
    if (!w)
        return NULL;
    L1L2ShutterResidual residual = w->given;
    for (int p = 0; p < L1L2_SHUTTER_SIZE; p++)
        residual.p[p] *= part;
    const double reach = l1l2_shutter_mesh_set(&w->mesh, map, &w->shape, &residual, w->cfg.in_width, w->cfg.in_height);
    if (!(reach > 0.0))
        return NULL;
    *reach_px = reach;
    return &w->mesh;
}
