/* SPDX-License-Identifier: MIT */
#include "fit/ransac.h"

#include <math.h>

#include "fit/least_squares.h"

/* With half of the pairs wrong, 300 draws of two miss all good pairs once in 10^37; the count adapts downwards. */
static const int max_draws = 300, min_draws = 10;
static const double miss_probability = 1e-4;
static const int max_refits = 8;
static const double settled = 1e-3; /* of the threshold */

typedef struct Problem {
    L1L2StabMotionModel model;
    int size; /* pairs in a smallest set */
    const L1L2Pair *pairs;
    L1L2PairWeights say;
    int count;
    double threshold;
    L1L2Rng *rng;
} Problem;

/* Draws a smallest set and fits it exactly. False where it is degenerate: nearer to each other, or to one line, than a
 * few thresholds, noise turns and stretches the map at will. */
static bool draw(const Problem *p, L1L2Mat *fit)
{
    L1L2Pair set[L1L2_FIT_MAX_SIZE];
    for (int i = 0; i < p->size; i++)
        set[i] = p->pairs[l1l2_rng_below(p->rng, (uint32_t)p->count)];
    return l1l2_fit_extent(p->model, set) >= 10.0 * p->threshold && l1l2_fit(p->model, set, NULL, p->size, fit);
}

static double squared_residual(const L1L2Mat *fit, const L1L2Pair *pair)
{
    const L1L2Point at = l1l2_mat_apply(fit, pair->from);
    const double dx = at.x - pair->to.x, dy = at.y - pair->to.y;
    return dx * dx + dy * dy;
}

static double share(const double *of, int i)
{
    return of ? of[i] : 1.0;
}

/* Returns the inliers' votes. */
static double mark_inliers(const Problem *p, const L1L2Mat *fit, bool *inlier, int *inliers)
{
    double votes = 0.0;
    *inliers = 0;
    for (int i = 0; i < p->count; i++) {
        inlier[i] = squared_residual(fit, &p->pairs[i]) <= p->threshold * p->threshold;
        *inliers += inlier[i];
        if (inlier[i])
            votes += share(p->say.votes, i);
    }
    return votes;
}

/* Draws after which a set of good pairs has most probably come up, at this share of inliers. */
static int draws_needed(double share, int size)
{
    const double good = pow(share, size);
    if (good >= 1.0)
        return min_draws;
    const double needed = log(miss_probability) / log1p(-good);
    return needed < min_draws ? min_draws : needed > max_draws ? max_draws : (int)ceil(needed);
}

/* Tukey's weights, with a scale at which the last of the inliers still has half: their noise is far below the
 * threshold, and what lies near it is another depth or drifting. */
static bool refit(const Problem *p, const bool *inlier, L1L2Mat *fit)
{
    double weights[L1L2_RANSAC_MAX_PAIRS];
    for (int i = 0; i < p->count; i++) {
        const double r2 = squared_residual(fit, &p->pairs[i]) / (4.0 * p->threshold * p->threshold);
        weights[i] = inlier[i] ? (1.0 - r2) * (1.0 - r2) * share(p->say.weights, i) : 0.0;
    }
    return l1l2_fit(p->model, p->pairs, weights, p->count, fit);
}

/* How far apart two maps put the pairs' points. */
static double change(const Problem *p, const L1L2Mat *a, const L1L2Mat *b)
{
    double most = 0.0;
    for (int i = 0; i < p->count; i++) {
        const L1L2Point u = l1l2_mat_apply(a, p->pairs[i].from), v = l1l2_mat_apply(b, p->pairs[i].from);
        most = fmax(most, hypot(u.x - v.x, u.y - v.y));
    }
    return most;
}

/* Reweighted least squares until map and inliers settle; returns their number. */
static int settle(const Problem *p, bool *inlier, L1L2Mat *fit)
{
    int inliers;
    mark_inliers(p, fit, inlier, &inliers);
    for (int i = 0; i < max_refits && inliers >= p->size; i++) {
        const L1L2Mat before = *fit;
        if (!refit(p, inlier, fit))
            return 0;
        mark_inliers(p, fit, inlier, &inliers);
        if (change(p, &before, fit) <= settled * p->threshold)
            break;
    }
    return inliers >= p->size ? inliers : 0;
}

int l1l2_ransac(L1L2StabMotionModel model, const L1L2Pair *pairs, L1L2PairWeights say, int count, double threshold,
                L1L2Rng *rng, bool *inlier, L1L2Mat *fit)
{
    const Problem p = {model, l1l2_fit_size(model), pairs, say, count, threshold, rng};
    double most = 0.0, all = 0.0;
    int inliers = 0;
    for (int i = 0; i < count; i++)
        all += share(say.votes, i);
    *fit = l1l2_mat_identity();
    for (int drawn = 0, draws = max_draws; count >= p.size && drawn < draws; drawn++) {
        L1L2Mat candidate;
        int agreeing;
        if (!draw(&p, &candidate))
            continue;
        const double agreed = mark_inliers(&p, &candidate, inlier, &agreeing);
        if (agreed > most) {
            most = agreed;
            *fit = candidate;
            /* While the others have more votes, it may be a smaller set of theirs that wins. */
            const int smaller = agreed < all - agreed && 2 * agreeing > count ? count - agreeing : agreeing;
            draws = draws_needed((double)smaller / count, p.size);
        }
    }
    if (most > 0.0)
        inliers = settle(&p, inlier, fit);
    if (inliers == 0) {
        for (int i = 0; i < count; i++)
            inlier[i] = false;
        *fit = l1l2_mat_identity();
    }
    return inliers;
}
