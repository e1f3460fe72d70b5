/* SPDX-License-Identifier: MIT */
#include "fit/ransac.h"

#include <math.h>

#include "fit/least_squares.h"

/* With half of the pairs wrong, the probability that none of 300 draws of two is all good is 10^-37. After a set of
 * inliers is found, fewer are drawn: so many that this probability is miss_probability. */
static const int max_draws = 300, min_draws = 10;
static const double miss_probability = 1e-4;
/* A minimal set nearer together than this many thresholds is degenerate: noise of its points rotates and scales the map
 * by a tenth or more. */
static const double min_extent = 10.0;
/* Refits end when the map moves no pair by more than this many thresholds. Two or three are usual. */
static const int max_refits = 8;
static const double converged = 1e-3;

/* Draws a minimal set and fits it exactly. False if it is degenerate. */
static bool draw(L1L2StabMotionModel model, const L1L2TrackSet *tracks, L1L2Mat *fit)
{
    L1L2Pair set[L1L2_FIT_MAX_SIZE];
    const int size = l1l2_fit_size(model);
    for (int i = 0; i < size; i++)
        set[i] = tracks->pairs[l1l2_rng_below(tracks->rng, (uint32_t)tracks->count)];
    return l1l2_fit_extent(model, set) >= min_extent * tracks->threshold && l1l2_fit(model, set, NULL, size, fit);
}

static double squared_residual(const L1L2Mat *fit, const L1L2Pair *pair)
{
    const L1L2Point at = l1l2_mat_apply(fit, pair->from);
    const double dx = at.x - pair->to.x, dy = at.y - pair->to.y;
    return dx * dx + dy * dy;
}

/* Marks the inliers and counts them. Returns their consensus weight. */
static double mark_inliers(const L1L2TrackSet *tracks, const L1L2Mat *fit, bool *inlier, int *inliers)
{
    double weight = 0.0;
    *inliers = 0;
    for (int i = 0; i < tracks->count; i++) {
        inlier[i] = squared_residual(fit, &tracks->pairs[i]) <= tracks->threshold * tracks->threshold;
        *inliers += inlier[i];
        if (inlier[i])
            weight += l1l2_fit_weight(tracks->consensus_weights, i);
    }
    return weight;
}

/* The number of draws n of `size` pairs each after which no draw was all good with miss_probability, at this share of
 * good pairs: (1 - share^size)^n = miss_probability. */
static int draws_needed(double share, int size)
{
    const double good = pow(share, size);
    if (good >= 1.0)
        return min_draws;
    const double needed = log(miss_probability) / log1p(-good);
    return needed < min_draws ? min_draws : needed > max_draws ? max_draws : (int)ceil(needed);
}

/* Least squares with Tukey's weights (1 - r^2 / (2 threshold)^2)^2. At this scale an inlier at the threshold still has
 * a weight of about half. The noise of good tracks is far below the threshold; tracks near it drift or lie at another
 * depth. */
static bool refit(L1L2StabMotionModel model, const L1L2TrackSet *tracks, const bool *inlier, L1L2Mat *fit)
{
    double weights[L1L2_RANSAC_MAX_PAIRS];
    for (int i = 0; i < tracks->count; i++) {
        const double r2 =
            squared_residual(fit, &tracks->pairs[i]) / (4.0 * tracks->threshold * tracks->threshold);
        weights[i] = inlier[i] ? (1.0 - r2) * (1.0 - r2) * l1l2_fit_weight(tracks->fit_weights, i) : 0.0;
    }
    return l1l2_fit(model, tracks->pairs, weights, tracks->count, fit);
}

/* The largest distance between two maps' images of the pairs' points. */
static double change(const L1L2TrackSet *tracks, const L1L2Mat *a, const L1L2Mat *b)
{
    double most = 0.0;
    for (int i = 0; i < tracks->count; i++) {
        const L1L2Point p = tracks->pairs[i].from, u = l1l2_mat_apply(a, p), v = l1l2_mat_apply(b, p);
        most = fmax(most, hypot(u.x - v.x, u.y - v.y));
    }
    return most;
}

/* Refits on the inliers until neither map nor inliers change. Returns the number of inliers, 0 for no map. */
static int refine(L1L2StabMotionModel model, const L1L2TrackSet *tracks, bool *inlier, L1L2Mat *fit)
{
    const int size = l1l2_fit_size(model);
    int inliers;
    mark_inliers(tracks, fit, inlier, &inliers);
    for (int i = 0; i < max_refits && inliers >= size; i++) {
        const L1L2Mat before = *fit;
        if (!refit(model, tracks, inlier, fit))
            return 0;
        mark_inliers(tracks, fit, inlier, &inliers);
        if (change(tracks, &before, fit) <= converged * tracks->threshold)
            break;
    }
    return inliers >= size ? inliers : 0;
}

int l1l2_ransac(L1L2StabMotionModel model, const L1L2TrackSet *tracks, bool *inlier, L1L2Mat *fit)
{
    const int count = tracks->count, size = l1l2_fit_size(model);
    double best = 0.0, all = 0.0;
    int inliers = 0;
    for (int i = 0; i < count; i++)
        all += l1l2_fit_weight(tracks->consensus_weights, i);
    *fit = l1l2_mat_identity();
    for (int drawn = 0, draws = max_draws; count >= size && drawn < draws; drawn++) {
        L1L2Mat candidate;
        int agreeing;
        if (!draw(model, tracks, &candidate))
            continue;
        const double weight = mark_inliers(tracks, &candidate, inlier, &agreeing);
        if (weight > best) {
            best = weight;
            *fit = candidate;
            /* While the others outweigh these inliers, the final winner may be a smaller set of the others. */
            const int smaller = weight < all - weight && 2 * agreeing > count ? count - agreeing : agreeing;
            draws = draws_needed((double)smaller / count, size);
        }
    }
    if (best > 0.0)
        inliers = refine(model, tracks, inlier, fit);
    if (inliers == 0) {
        for (int i = 0; i < count; i++)
            inlier[i] = false;
        *fit = l1l2_mat_identity();
    }
    return inliers;
}
