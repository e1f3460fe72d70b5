/* SPDX-License-Identifier: MIT */
#include "ransac.h"

#include <math.h>

/* With half of the pairs wrong, 300 draws of two miss all good pairs once in 10^37; the count adapts downwards. */
static const int max_draws = 300, min_draws = 10;
static const double miss_probability = 1e-4;
static const int max_refits = 8;

typedef struct Sums {
    double n, fx, fy, tx, ty; /* count and means */
} Sums;

static Sums means(const L1L2Pair *pairs, int count, const bool *inlier)
{
    Sums s = {0};
    for (int i = 0; i < count; i++)
        if (inlier[i]) {
            s.n += 1.0;
            s.fx += pairs[i].from.x, s.fy += pairs[i].from.y;
            s.tx += pairs[i].to.x, s.ty += pairs[i].to.y;
        }
    if (s.n > 0.0)
        s.fx /= s.n, s.fy /= s.n, s.tx /= s.n, s.ty /= s.n;
    return s;
}

/* Least squares over the inliers, closed form: with both sides' means taken off, points are complex numbers u -> v and
 * a + ib = sum conj(u) v / sum |u|^2. */
static bool fit_similarity(const L1L2Pair *pairs, int count, const bool *inlier, L1L2Mat *fit)
{
    const Sums s = means(pairs, count, inlier);
    double a = 0.0, b = 0.0, spread = 0.0;
    for (int i = 0; i < count; i++)
        if (inlier[i]) {
            const double ux = pairs[i].from.x - s.fx, uy = pairs[i].from.y - s.fy;
            const double vx = pairs[i].to.x - s.tx, vy = pairs[i].to.y - s.ty;
            a += ux * vx + uy * vy;
            b += ux * vy - uy * vx;
            spread += ux * ux + uy * uy;
        }
    if (!(spread > 0.0))
        return false;
    a /= spread, b /= spread;
    *fit = l1l2_mat_similarity(a, b, s.tx - (a * s.fx - b * s.fy), s.ty - (b * s.fx + a * s.fy));
    return l1l2_mat_is_finite(fit) && hypot(a, b) > 0.0;
}

static bool fit_translation(const L1L2Pair *pairs, int count, const bool *inlier, L1L2Mat *fit)
{
    const Sums s = means(pairs, count, inlier);
    *fit = l1l2_mat_translation(s.tx - s.fx, s.ty - s.fy);
    return s.n > 0.0 && l1l2_mat_is_finite(fit);
}

/* Draws a smallest set and fits it exactly. False where it is degenerate. */
static bool draw_similarity(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, L1L2Mat *fit)
{
    const L1L2Pair *p = &pairs[l1l2_rng_below(rng, (uint32_t)count)];
    const L1L2Pair *q = &pairs[l1l2_rng_below(rng, (uint32_t)count)];
    const L1L2Pair two[2] = {*p, *q};
    const bool both[2] = {true, true};
    /* Nearer than a few thresholds, noise turns and scales the map at will. */
    if (hypot(p->from.x - q->from.x, p->from.y - q->from.y) < 10.0 * threshold)
        return false;
    return fit_similarity(two, 2, both, fit);
}

static bool draw_translation(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, L1L2Mat *fit)
{
    const L1L2Pair *p = &pairs[l1l2_rng_below(rng, (uint32_t)count)];
    *fit = l1l2_mat_translation(p->to.x - p->from.x, p->to.y - p->from.y);
    return l1l2_mat_is_finite(fit);
}

static int mark_inliers(const L1L2Pair *pairs, int count, double threshold, const L1L2Mat *fit, bool *inlier)
{
    int inliers = 0;
    for (int i = 0; i < count; i++) {
        const L1L2Point p = l1l2_mat_apply(fit, pairs[i].from);
        const double dx = p.x - pairs[i].to.x, dy = p.y - pairs[i].to.y;
        inlier[i] = dx * dx + dy * dy <= threshold * threshold;
        inliers += inlier[i];
    }
    return inliers;
}

/* Draws after which a set of `size` good pairs has most probably come up, at this share of inliers. */
static int draws_needed(double share, int size)
{
    const double good = pow(share, size);
    if (good >= 1.0)
        return min_draws;
    const double needed = log(miss_probability) / log1p(-good);
    return needed < min_draws ? min_draws : needed > max_draws ? max_draws : (int)ceil(needed);
}

typedef struct Model {
    int size; /* pairs in a smallest set */
    bool (*draw)(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, L1L2Mat *fit);
    bool (*fit)(const L1L2Pair *pairs, int count, const bool *inlier, L1L2Mat *fit);
} Model;

static int ransac(const Model *model, const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, bool *inlier,
                  L1L2Mat *fit)
{
    L1L2Mat best = l1l2_mat_identity();
    int most = 0;
    for (int draw = 0, draws = max_draws; count >= model->size && draw < draws; draw++) {
        L1L2Mat candidate;
        if (!model->draw(pairs, count, threshold, rng, &candidate))
            continue;
        const int inliers = mark_inliers(pairs, count, threshold, &candidate, inlier);
        if (inliers > most) {
            most = inliers;
            best = candidate;
            draws = draws_needed((double)most / count, model->size);
        }
    }
    /* Refit on the inliers until they settle. */
    int inliers = most >= model->size ? mark_inliers(pairs, count, threshold, &best, inlier) : 0;
    for (int i = 0; i < max_refits && inliers >= model->size; i++) {
        const int before = inliers;
        if (!model->fit(pairs, count, inlier, &best)) {
            inliers = 0;
            break;
        }
        inliers = mark_inliers(pairs, count, threshold, &best, inlier);
        if (inliers == before)
            break;
    }
    if (inliers < model->size) {
        for (int i = 0; i < count; i++)
            inlier[i] = false;
        *fit = l1l2_mat_identity();
        return 0;
    }
    *fit = best;
    return inliers;
}

int l1l2_ransac_similarity(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, bool *inlier, L1L2Mat *fit)
{
    static const Model similarity = {2, draw_similarity, fit_similarity};
    return ransac(&similarity, pairs, count, threshold, rng, inlier, fit);
}

int l1l2_ransac_translation(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, bool *inlier,
                            L1L2Mat *fit)
{
    static const Model translation = {1, draw_translation, fit_translation};
    return ransac(&translation, pairs, count, threshold, rng, inlier, fit);
}
