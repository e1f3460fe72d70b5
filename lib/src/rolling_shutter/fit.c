/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/fit.h"

#include <math.h>
#include <string.h>

#include "fit/least_squares.h"

enum { N = L1L2_SHUTTER_SIZE };

/* Against a point's weight of 1. A second difference of the bands costs `bending`: at less, noise bends the rows; at
 * more, 20 Hz are too fast for it (docs/rolling-shutter.md). */
static const double bending = 3.0, band_size = 0.1, other_size = 0.3, homography_size = 0.05;
static const double usual_count = 200.0; /* points for which these hold */

/* The scale of Geman and McClure's weights, inlier thresholds, one round each. */
static const double scale[] = {1.0, 1.0, 1.0, 0.7, 0.7};
enum { ROUNDS = sizeof scale / sizeof *scale };

/* The points have to lie in so many of the frame's cells (MediaPipe asks for 30 %). */
static const double min_coverage = 0.3;

typedef struct Normal {
    double A[N][N], b[N]; /* lower triangle */
} Normal;

static void regularise(const L1L2ShutterModel *shape, int count, Normal *normal)
{
    const double factor = count / usual_count;
    memset(normal, 0, sizeof *normal);
    if (shape->kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE) {
        for (int i = 0; i < 8; i++)
            normal->A[i][i] = homography_size * factor;
        return;
    }
    for (int i = 0; i < N; i++)
        normal->A[i][i] = (i < L1L2_SHUTTER_ROLL ? band_size : other_size) * factor;
    for (int first = 0; first < L1L2_SHUTTER_ROLL; first += L1L2_SHUTTER_BANDS)
        for (int k = first; k + 2 < first + L1L2_SHUTTER_BANDS; k++) {
            static const double difference[3] = {1.0, -2.0, 1.0};
            for (int i = 0; i < 3; i++)
                for (int j = 0; j <= i; j++)
                    normal->A[k + i][k + j] += bending * factor * difference[i] * difference[j];
        }
}

/* One coordinate of one point. Half of a mixture's basis is zero. */
static void add_row(Normal *normal, const double *basis, int size, double weight, double value)
{
    int used[N], count = 0;
    for (int i = 0; i < size; i++)
        if (basis[i] != 0.0)
            used[count++] = i;
    for (int i = 0; i < count; i++) {
        const double wi = weight * basis[used[i]];
        for (int j = 0; j <= i; j++)
            normal->A[used[i]][used[j]] += wi * basis[used[j]];
        normal->b[used[i]] += wi * value;
    }
}

/* Cholesky, in place. */
static bool solve(Normal *normal, int size, double x[N])
{
    for (int i = 0; i < size; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = normal->A[i][j];
            for (int k = 0; k < j; k++)
                sum -= normal->A[i][k] * normal->A[j][k];
            if (i == j && !(sum > 0.0))
                return false;
            normal->A[i][j] = i == j ? sqrt(sum) : sum / normal->A[j][j];
        }
        double sum = normal->b[i];
        for (int k = 0; k < i; k++)
            sum -= normal->A[i][k] * x[k];
        x[i] = sum / normal->A[i][i];
    }
    for (int i = size - 1; i >= 0; i--) {
        for (int k = i + 1; k < size; k++)
            x[i] -= normal->A[k][i] * x[k];
        x[i] /= normal->A[i][i];
    }
    for (int i = 0; i < size; i++)
        if (!isfinite(x[i]))
            return false;
    return true;
}

/* Where a pair's displacement is counted, and how long it is. */
static L1L2Point displacement(const L1L2Pair *pair, const L1L2Mat *F, L1L2Point *at)
{
    const L1L2Point moved = l1l2_mat_apply(F, pair->from);
    *at = (L1L2Point){0.5 * (pair->from.x + pair->to.x), 0.5 * (pair->from.y + pair->to.y)};
    return (L1L2Point){pair->to.x - moved.x, pair->to.y - moved.y};
}

typedef struct Points {
    const L1L2ShutterModel *shape;
    const L1L2Pair *pairs;
    const L1L2Mat *F;
    int count;
} Points;

/* The weight of a displacement that the fit leaves so much of. */
static double trust(L1L2Point left, double width)
{
    const double ratio = 1.0 / (1.0 + (left.x * left.x + left.y * left.y) / (width * width));
    return ratio * ratio;
}

static L1L2Point left_by(const Points *points, const L1L2ShutterResidual *fit, int i, L1L2Point *moved)
{
    L1L2Point at;
    *moved = displacement(&points->pairs[i], points->F, &at);
    const L1L2Point r = l1l2_shutter_residual_at(points->shape, fit, at);
    return (L1L2Point){moved->x - r.x, moved->y - r.y};
}

/* One round, with weights by what `fit` leaves of them; where there is no fit yet, all of `inlier` weigh the same, and
 * what moves by itself has no say in the beginning. */
static bool refit(const Points *points, double width, const bool *inlier, const L1L2ShutterResidual *fit,
                  L1L2ShutterResidual *out)
{
    const int size = l1l2_shutter_model_size(points->shape);
    Normal normal;
    regularise(points->shape, points->count, &normal);
    for (int i = 0; i < points->count; i++) {
        double x[N], y[N];
        L1L2Point at;
        const L1L2Point d = displacement(&points->pairs[i], points->F, &at);
        L1L2Point left = d;
        l1l2_shutter_model_basis(points->shape, at, x, y);
        for (int k = 0; k < size; k++)
            left.x -= x[k] * fit->p[k], left.y -= y[k] * fit->p[k];
        const double weight = inlier ? inlier[i] : trust(left, width);
        add_row(&normal, x, size, weight, d.x);
        add_row(&normal, y, size, weight, d.y);
    }
    return solve(&normal, size, out->p);
}

/* The parts of a division, each of which the rest has to tell. A shutter bends all of a row alike; what moves by itself
 * has a width. */
static const int parts[L1L2_SPLITS] = {2, 3, 2};

static int part_of(const Points *points, int division, int i)
{
    const double x = points->pairs[i].from.x / points->shape->half_w;
    switch (division) {
    case L1L2_SPLIT_HALVES:
        return i % 2;
    case L1L2_SPLIT_THIRDS:
        return (x > -1.0 / 3.0) + (x > 1.0 / 3.0);
    default:
        return fabs(x) > 0.5;
    }
}

/* One round on all but one part, with weights by what `fit` leaves. */
static bool refit_rest(const Points *points, int division, int part, double width, const L1L2ShutterResidual *fit,
                       L1L2ShutterResidual *out)
{
    L1L2Pair pairs[L1L2_RANSAC_MAX_PAIRS];
    Points rest = {points->shape, pairs, points->F, 0};
    for (int i = 0; i < points->count; i++)
        if (part_of(points, division, i) != part)
            pairs[rest.count++] = points->pairs[i];
    return refit(&rest, width, NULL, fit, out);
}

static void validate(const Points *points, int division, double width, L1L2ShutterMeasurement *step)
{
    for (int part = 0; part < parts[division]; part++) {
        L1L2ShutterResidual other = {{0.0}};
        if (!refit_rest(points, division, part, width, &step->r, &other))
            continue;
        for (int i = 0; i < points->count; i++) {
            if (part_of(points, division, i) != part)
                continue;
            L1L2Point d;
            const double weight = trust(left_by(points, &step->r, i, &d), width);
            const L1L2Point left = left_by(points, &other, i, &d);
            step->all[division] += weight * (d.x * d.x + d.y * d.y);
            step->explained[division] += weight * (d.x * d.x + d.y * d.y - left.x * left.x - left.y * left.y);
        }
    }
}

int l1l2_shutter_fit(const L1L2ShutterModel *shape, const L1L2Pair *pairs, int count, double threshold,
                             bool *inlier, const L1L2Mat *F, L1L2ShutterMeasurement *step)
{
    const Points points = {shape, pairs, F, count};
    memset(step, 0, sizeof *step);
    L1L2ShutterResidual fit = {{0.0}};
    bool ok = l1l2_fit_coverage(shape->half_w, shape->half_h, pairs, inlier, count) >= min_coverage &&
              refit(&points, 0.0, inlier, &fit, &step->r);
    for (int k = 0; k < ROUNDS && ok; k++) {
        fit = step->r;
        ok = refit(&points, scale[k] * threshold, NULL, &fit, &step->r);
    }
    if (!ok) {
        memset(step, 0, sizeof *step);
        return 0;
    }
    for (int division = 0; division < L1L2_SPLITS; division++)
        validate(&points, division, scale[ROUNDS - 1] * threshold, step);
    int inliers = 0;
    for (int i = 0; i < count; i++) {
        L1L2Point d;
        const L1L2Point left = left_by(&points, &step->r, i, &d);
        inlier[i] = hypot(left.x, left.y) <= threshold;
        inliers += inlier[i];
    }
    return inliers;
}
