/* SPDX-License-Identifier: MIT */
#include "motion_rows.h"

#include <math.h>
#include <stdlib.h>

#include "ransac_fit.h"

enum { BANDS = 10, LEAST = 4 /* pairs that tell a band's shift */, REFITS = 4 };

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

/* The similarity of all, whatever the rows did: weights fall with the residual, for what is no part of it at all. */
static bool fit_all(const L1L2Pair *pairs, int count, double threshold, L1L2Mat *fit)
{
    double weights[L1L2_RANSAC_MAX_PAIRS];
    bool found = l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, pairs, NULL, count, fit);
    for (int k = 0; k < REFITS && found; k++) {
        for (int i = 0; i < count; i++) {
            const L1L2Point r = residual(fit, &pairs[i]);
            weights[i] = 1.0 / (1.0 + (r.x * r.x + r.y * r.y) / (16.0 * threshold * threshold));
        }
        found = l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, pairs, weights, count, fit);
    }
    return found;
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
    return true;
}

int l1l2_rows_fit(const L1L2Pair *pairs, const double *votes, int count, double half_h, double threshold, bool *inlier,
                  L1L2Mat *fit)
{
    L1L2Point shift[BANDS];
    L1L2Mat all;
    double weights[L1L2_RANSAC_MAX_PAIRS];
    double before = 0.0, after = 0.0;
    int inliers = 0;
    if (!fit_all(pairs, count, threshold, &all) || !band_shifts(pairs, count, half_h, threshold, &all, shift))
        return 0;
    for (int i = 0; i < count; i++) {
        const double at = band_position(&pairs[i], half_h);
        const int band = (int)fmin(floor(at), BANDS - 2);
        const L1L2Point r = residual(&all, &pairs[i]);
        const double part = at - band;
        const double x = r.x - (1.0 - part) * shift[band].x - part * shift[band + 1].x;
        const double y = r.y - (1.0 - part) * shift[band].y - part * shift[band + 1].y;
        weights[i] = hypot(x, y) <= near_row * threshold ? 1.0 : 0.0;
        before += votes[i] * capped(r.x, r.y, threshold);
        after += votes[i] * capped(x, y, threshold);
    }
    if (after > most_left * before || !l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, pairs, weights, count, fit))
        return 0;
    for (int i = 0; i < count; i++) {
        inlier[i] = weights[i] > 0.0;
        inliers += inlier[i];
    }
    return inliers;
}
