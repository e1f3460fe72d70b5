/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/similarity_by_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit/least_squares.h"

enum { BANDS = 10, LEAST = 4 /* pairs that tell a band's shift */, ROUNDS = 6 /* similarity and shifts in turn */ };

/* Of the squared residuals, weighed by votes, the rows explain all but this: of two surfaces that share rows, half. No
 * residual counts more than the second, in thresholds. */
static const double most_left = 0.3, most_counted = 4.0;
/* From band to band, in thresholds: a subject's edge is a jump. Within the second, a track follows its row. */
static const double steepest = 4.0, near_row = 1.5;

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

static double capped(double x, double y, double threshold)
{
    const double most = most_counted * threshold;
    return fmin(x * x + y * y, most * most);
}

/* Bands of rows, from -1/2 to BANDS - 1/2 at their middles. */
static double band_position(const L1L2Pair *pair, double half_h)
{
    const double at = (pair->from.y / half_h + 1.0) * 0.5 * BANDS - 0.5;
    return fmin(fmax(at, 0.0), BANDS - 1.0);
}

/* The shift of a pair's row, between the bands' middles. */
static L1L2Point row_shift(const L1L2Point shift[BANDS], const L1L2Pair *pair, double half_h)
{
    const double at = band_position(pair, half_h);
    const int band = (int)fmin(floor(at), BANDS - 2);
    const double part = at - band;
    return (L1L2Point){(1.0 - part) * shift[band].x + part * shift[band + 1].x,
                       (1.0 - part) * shift[band].y + part * shift[band + 1].y};
}

/* The similarity of all but for their rows' shifts. Weights fall with the residual, for what is no part of it. */
static bool fit_all(const L1L2Pair *pairs, int count, const L1L2Point shift[BANDS], double half_h, double threshold,
                    L1L2Mat *fit)
{
    L1L2Pair unshifted[L1L2_RANSAC_MAX_PAIRS];
    double weights[L1L2_RANSAC_MAX_PAIRS];
    for (int i = 0; i < count; i++) {
        const L1L2Point s = row_shift(shift, &pairs[i], half_h);
        unshifted[i] = (L1L2Pair){pairs[i].from, {pairs[i].to.x - s.x, pairs[i].to.y - s.y}};
    }
    for (int i = 0; i < count; i++) {
        const L1L2Point r = residual(fit, &unshifted[i]);
        weights[i] = 1.0 / (1.0 + (r.x * r.x + r.y * r.y) / (16.0 * threshold * threshold));
    }
    return l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, unshifted, weights, count, fit);
}

/* The bands' median shifts; false where a band has too few pairs to tell, or the shift jumps from one to the next. */
static bool band_shifts(const L1L2Pair *pairs, int count, double half_h, double threshold, const L1L2Mat *fit,
                        L1L2Point shift[BANDS])
{
    double x[L1L2_RANSAC_MAX_PAIRS], y[L1L2_RANSAC_MAX_PAIRS];
    for (int band = 0; band < BANDS; band++) {
        int n = 0;
        for (int i = 0; i < count; i++)
            if ((int)lround(band_position(&pairs[i], half_h)) == band) {
                const L1L2Point r = residual(fit, &pairs[i]);
                x[n] = r.x, y[n++] = r.y;
            }
        if (n < LEAST)
            return false;
        shift[band] = (L1L2Point){median(x, n), median(y, n)};
        if (band > 0 && hypot(shift[band].x - shift[band - 1].x, shift[band].y - shift[band - 1].y) >
                            steepest * threshold)
            return false;
    }
    L1L2Point mean = {0.0, 0.0}; /* belongs to the similarity */
    for (int band = 0; band < BANDS; band++)
        mean.x += shift[band].x / BANDS, mean.y += shift[band].y / BANDS;
    for (int band = 0; band < BANDS; band++)
        shift[band].x -= mean.x, shift[band].y -= mean.y;
    return true;
}

int l1l2_shutter_similarity_by_rows(const L1L2Pair *pairs, const double *votes, int count, double half_h,
                                    double threshold, bool *inlier, L1L2Mat *fit)
{
    L1L2Point shift[BANDS] = {{0.0, 0.0}};
    bool near[L1L2_RANSAC_MAX_PAIRS];
    double before = 0.0, after = 0.0;
    int inliers = 0;
    L1L2Mat all, without;
    if (!l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, pairs, NULL, count, &all))
        return 0;
    without = all;
    for (int k = 0; k < ROUNDS; k++)
        if (!fit_all(pairs, count, shift, half_h, threshold, &all) ||
            !band_shifts(pairs, count, half_h, threshold, &all, shift))
            return 0;
    for (int i = 0; i < count; i++) {
        const L1L2Point s = row_shift(shift, &pairs[i], half_h), r = residual(&all, &pairs[i]);
        const L1L2Point plain = residual(&without, &pairs[i]);
        near[i] = hypot(r.x - s.x, r.y - s.y) <= near_row * threshold;
        inliers += near[i];
        before += votes[i] * capped(plain.x, plain.y, threshold);
        after += votes[i] * capped(r.x - s.x, r.y - s.y, threshold);
    }
    if (after > most_left * before)
        return 0;
    memcpy(inlier, near, (size_t)count * sizeof *near);
    *fit = all;
    return inliers;
}
