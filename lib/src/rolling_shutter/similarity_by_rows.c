/* SPDX-License-Identifier: MIT */
/*
 * Alternating least squares: the similarity of the pairs less their rows' shifts, then each band's shift as the median
 * of what the similarity leaves of its pairs, in turn. The mean of the shifts belongs to the similarity. The result is
 * accepted if the shifts leave little of the squared residuals of a plain similarity: for two surfaces at different
 * depths that share rows, no shift of the rows explains more than half.
 */
#include "rolling_shutter/similarity_by_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit/least_squares.h"

enum { BANDS = 10, MAX_PAIRS = L1L2_SHUTTER_ROWS_MAX_PAIRS };

/* Rounds of similarity and shifts in turn, and the pairs that a band needs for its median. Half and twice of either
 * changed nothing in bench_shutter_parameters. */
enum { ROUNDS = 6, MIN_PAIRS = 4 };

/* Thresholds: a pair that close to its row's shift is an inlier. Half and twice changed nothing there either. */
static const double inlier_reach = 1.5;

static int ascending(const void *a, const void *b)
{
    return *(const double *)a < *(const double *)b ? -1 : *(const double *)a > *(const double *)b;
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, ascending);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

static L1L2Point residual(const L1L2Mat *fit, const L1L2Pair *pair)
{
    const L1L2Point at = l1l2_mat_apply(fit, pair->from);
    return (L1L2Point){pair->to.x - at.x, pair->to.y - at.y};
}

/* The squared length of a residual, with an upper limit: one track far off must not decide. */
static double capped_square(const L1L2ShutterRowTracks *tracks, double x, double y)
{
    const double most = tracks->parameters->rows_cap * tracks->threshold;
    return fmin(x * x + y * y, most * most);
}

/* The position of a pair in bands: 0 is the middle of the first, BANDS - 1 that of the last; clipped to these. */
static double band_position(const L1L2ShutterRowTracks *tracks, int i)
{
    const double at = (tracks->pairs[i].from.y / tracks->half_h + 1.0) * 0.5 * BANDS - 0.5;
    return fmin(fmax(at, 0.0), BANDS - 1.0);
}

/* The shift of a pair's row: linear between the bands' middles. */
static L1L2Point row_shift(const L1L2ShutterRowTracks *tracks, const L1L2Point shift[BANDS], int i)
{
    const double at = band_position(tracks, i);
    const int band = (int)fmin(floor(at), BANDS - 2);
    const double part = at - band;
    return (L1L2Point){(1.0 - part) * shift[band].x + part * shift[band + 1].x,
                       (1.0 - part) * shift[band].y + part * shift[band + 1].y};
}

/* The similarity of the pairs less their rows' shifts. fit: in, of the round before, for the robust weights; out. */
static bool fit_similarity(const L1L2ShutterRowTracks *tracks, const L1L2Point shift[BANDS], L1L2Mat *fit)
{
    const double cap = tracks->parameters->rows_cap;
    L1L2Pair unshifted[MAX_PAIRS];
    double weights[MAX_PAIRS];
    for (int i = 0; i < tracks->count; i++) {
        const L1L2Pair *pair = &tracks->pairs[i];
        const L1L2Point s = row_shift(tracks, shift, i);
        unshifted[i] = (L1L2Pair){pair->from, {pair->to.x - s.x, pair->to.y - s.y}};
        const L1L2Point r = residual(fit, &unshifted[i]);
        weights[i] = 1.0 / (1.0 + (r.x * r.x + r.y * r.y) / (cap * cap * tracks->threshold * tracks->threshold));
    }
    return l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, unshifted, weights, tracks->count, fit);
}

/* The bands' median shifts. False if a band has too few pairs, or the shift jumps from one band to the next. */
static bool find_shifts(const L1L2ShutterRowTracks *tracks, const L1L2Mat *fit, L1L2Point shift[BANDS])
{
    const double steepest = tracks->parameters->rows_max_jump * tracks->threshold;
    double x[MAX_PAIRS], y[MAX_PAIRS];
    for (int band = 0; band < BANDS; band++) {
        int n = 0;
        for (int i = 0; i < tracks->count; i++)
            if ((int)lround(band_position(tracks, i)) == band) {
                const L1L2Point r = residual(fit, &tracks->pairs[i]);
                x[n] = r.x, y[n++] = r.y;
            }
        if (n < MIN_PAIRS)
            return false;
        shift[band] = (L1L2Point){median(x, n), median(y, n)};
        if (band > 0 && hypot(shift[band].x - shift[band - 1].x, shift[band].y - shift[band - 1].y) > steepest)
            return false;
    }
    L1L2Point mean = {0.0, 0.0};
    for (int band = 0; band < BANDS; band++)
        mean.x += shift[band].x / BANDS, mean.y += shift[band].y / BANDS;
    for (int band = 0; band < BANDS; band++)
        shift[band].x -= mean.x, shift[band].y -= mean.y;
    return true;
}

/* Marks the pairs that are within reach of their row's shift, and returns their number; 0 if the shifts leave too much.
 * plain: the similarity without shifts. */
static int accept(const L1L2ShutterRowTracks *tracks, const L1L2Mat *plain, const L1L2Mat *fit,
                  const L1L2Point shift[BANDS], bool near[MAX_PAIRS])
{
    const double reach = inlier_reach * tracks->threshold;
    double before = 0.0, after = 0.0;
    int inliers = 0;
    for (int i = 0; i < tracks->count; i++) {
        const L1L2Point s = row_shift(tracks, shift, i);
        const L1L2Point r = residual(fit, &tracks->pairs[i]), first = residual(plain, &tracks->pairs[i]);
        near[i] = hypot(r.x - s.x, r.y - s.y) <= reach;
        inliers += near[i];
        before += tracks->consensus_weights[i] * capped_square(tracks, first.x, first.y);
        after += tracks->consensus_weights[i] * capped_square(tracks, r.x - s.x, r.y - s.y);
    }
    return after <= tracks->parameters->rows_unexplained * before ? inliers : 0;
}

int l1l2_shutter_similarity_by_rows(const L1L2ShutterRowTracks *given, bool *inlier, L1L2Mat *fit)
{
    L1L2ShutterRowTracks tracks = *given;
    L1L2Point shift[BANDS] = {{0.0, 0.0}};
    bool near[MAX_PAIRS];
    L1L2Mat plain, all;
    tracks.parameters = l1l2_shutter_parameters_or_default(given->parameters);
    if (tracks.count > MAX_PAIRS ||
        !l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, tracks.pairs, NULL, tracks.count, &plain))
        return 0;
    all = plain;
    for (int k = 0; k < ROUNDS; k++)
        if (!fit_similarity(&tracks, shift, &all) || !find_shifts(&tracks, &all, shift))
            return 0;
    const int inliers = accept(&tracks, &plain, &all, shift, near);
    if (inliers == 0)
        return 0;
    memcpy(inlier, near, (size_t)tracks.count * sizeof *near);
    *fit = all;
    return inliers;
}
