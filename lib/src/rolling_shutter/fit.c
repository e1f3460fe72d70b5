/* SPDX-License-Identifier: MIT */
/*
 * The fit minimizes, over the parameters p of the residual r,
 *
 *     sum_i w_i |d_i - r(x_i)|^2 + (count / 200) (penalties of p),
 *
 * where d_i is the part of track i's motion that F does not explain, at the middle x_i of the track. The weights are
 * Geman and McClure's, w = 1 / (1 + |left|^2 / scale^2)^2, where `left` is what the fit of the round before leaves of
 * d_i. Each round solves normal equations; the scale shrinks in the last rounds. The first round has no fit yet: it
 * takes the tracks that agree with F, all with weight 1, so that a subject that moves by itself has no influence on the
 * start.
 *
 * The penalties pull the parameters to zero and smooth the bands along the rows. Bands without tracks then follow their
 * neighbors, and a few tracks alone change nothing. They grow with the number of tracks, so that the same scene gives
 * the same fit whatever the number of tracks on it.
 */
#include "rolling_shutter/fit.h"

#include <math.h>
#include <string.h>

#include "common/cholesky.h"

enum { N = L1L2_SHUTTER_SIZE };

/* Rounds of reweighted least squares with the wide and then the narrow scale. The fit has converged by then: half or
 * twice as many of either changed nothing in bench_shutter_parameters. */
enum { WIDE_ROUNDS = 3, NARROW_ROUNDS = 2 };

/* The penalty of a homography's parameters, as in the table. It only keeps the normal equations positive definite where
 * the tracks lie badly: half or twice of it changed nothing in bench_shutter_parameters. */
static const double homography_weight = 0.05;

/* The number of tracks for which the parameters state the penalties' weights. */
static const double reference_count = 200.0;

/* What all steps of one fit share. */
typedef struct Tracks {
    const L1L2ShutterModel *model;
    const L1L2ShutterParameters *parameters;
    const L1L2Pair *pairs;
    const L1L2Mat *F;
    int count;
} Tracks;

/* Normal equations A p = b: the lower triangle of A. */
typedef struct Normal {
    double A[N][N], b[N];
} Normal;

static void add_penalties(const Tracks *tracks, int count, Normal *normal)
{
    const L1L2ShutterParameters *parameters = tracks->parameters;
    const double factor = count / reference_count;
    if (tracks->model->kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE) {
        for (int i = 0; i < 8; i++)
            normal->A[i][i] += homography_weight * factor;
        return;
    }
    for (int i = 0; i < N; i++)
        normal->A[i][i] +=
            (i < L1L2_SHUTTER_ROLL ? parameters->translation_weight : parameters->linear_weight) * factor;
    for (int first = 0; first < L1L2_SHUTTER_ROLL; first += L1L2_SHUTTER_BANDS)
        for (int k = first; k + 2 < first + L1L2_SHUTTER_BANDS; k++) {
            static const double difference[3] = {1.0, -2.0, 1.0};
            for (int i = 0; i < 3; i++)
                for (int j = 0; j <= i; j++)
                    normal->A[k + i][k + j] += parameters->bend_weight * factor * difference[i] * difference[j];
        }
}

/* Adds one coordinate of one track. Half of a mixture's basis is zero: those products are left out. */
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

/* Leaves the solution in *fit. False if there is none, or it is not finite. */
static bool solve(Normal *normal, int size, L1L2ShutterResidual *fit)
{
    if (!l1l2_cholesky_factorize(&normal->A[0][0], size, N))
        return false;
    l1l2_cholesky_solve(&normal->A[0][0], size, N, normal->b);
    for (int i = 0; i < size; i++)
        fit->p[i] = normal->b[i];
    return l1l2_shutter_residual_is_finite(fit);
}

/* What F leaves of track i's motion, and the position at which it counts: the middle of the track. */
static L1L2Point displacement(const Tracks *tracks, int i, L1L2Point *at)
{
    const L1L2Pair *pair = &tracks->pairs[i];
    const L1L2Point moved = l1l2_mat_apply(tracks->F, pair->from);
    *at = (L1L2Point){0.5 * (pair->from.x + pair->to.x), 0.5 * (pair->from.y + pair->to.y)};
    return (L1L2Point){pair->to.x - moved.x, pair->to.y - moved.y};
}

/* What F and the fit leave of track i's motion. *d: what F alone leaves. */
static L1L2Point remainder_of(const Tracks *tracks, const L1L2ShutterResidual *fit, int i, L1L2Point *d)
{
    L1L2Point at;
    *d = displacement(tracks, i, &at);
    const L1L2Point r = l1l2_shutter_residual_at(tracks->model, fit, at);
    return (L1L2Point){d->x - r.x, d->y - r.y};
}

/* Geman and McClure's weight of a track that a fit leaves so far off. */
static double robust_weight(L1L2Point left, double scale)
{
    const double ratio = 1.0 / (1.0 + (left.x * left.x + left.y * left.y) / (scale * scale));
    return ratio * ratio;
}

/* How the validation tests split the tracks. A shutter moves all of a row alike; a subject that moves by itself has a
 * left and a right edge. So two of the splits are by columns. */
static const int split_parts[L1L2_SPLITS] = {2, 3, 2};

static int part_of(const Tracks *tracks, int split, int i)
{
    const double x = tracks->pairs[i].from.x / tracks->model->half_w;
    switch (split) {
    case L1L2_SPLIT_HALVES:
        return i % 2;
    case L1L2_SPLIT_THIRDS:
        return (x > -1.0 / 3.0) + (x > 1.0 / 3.0);
    default:
        return fabs(x) > 0.5;
    }
}

/* Which tracks a round uses: all but those of one part of a split; split < 0: all. */
typedef struct LeftOut {
    int split, part;
} LeftOut;

static const LeftOut none_left_out = {-1, 0};

/* One round. Weights: if `inlier` is given, 1 for inliers and 0 for the others; else by what `before` leaves. */
static bool refit(const Tracks *tracks, LeftOut left_out, const bool *inlier, double scale,
                  const L1L2ShutterResidual *before, L1L2ShutterResidual *fit)
{
    const int size = l1l2_shutter_model_size(tracks->model);
    int used = 0;
    Normal normal;
    memset(&normal, 0, sizeof normal);
    for (int i = 0; i < tracks->count; i++)
        used += left_out.split < 0 || part_of(tracks, left_out.split, i) != left_out.part;
    add_penalties(tracks, used, &normal);
    for (int i = 0; i < tracks->count; i++) {
        if (left_out.split >= 0 && part_of(tracks, left_out.split, i) == left_out.part)
            continue;
        double x[N], y[N];
        L1L2Point at;
        const L1L2Point d = displacement(tracks, i, &at);
        L1L2Point left = d;
        l1l2_shutter_model_basis(tracks->model, at, x, y);
        for (int k = 0; k < size; k++)
            left.x -= x[k] * before->p[k], left.y -= y[k] * before->p[k];
        const double weight = inlier ? inlier[i] : robust_weight(left, scale);
        add_row(&normal, x, size, weight, d.x);
        add_row(&normal, y, size, weight, d.y);
    }
    return solve(&normal, size, fit);
}

/* Adds one split's sums to the measurement: each part is predicted by a fit to the others. That fit is one round,
 * weighted by what the whole fit leaves. */
static void validate(const Tracks *tracks, int split, double scale, L1L2ShutterMeasurement *measurement)
{
    const L1L2ShutterResidual *whole = &measurement->r;
    for (int part = 0; part < split_parts[split]; part++) {
        L1L2ShutterResidual others = {{0.0}};
        if (!refit(tracks, (LeftOut){split, part}, NULL, scale, whole, &others))
            continue;
        for (int i = 0; i < tracks->count; i++) {
            if (part_of(tracks, split, i) != part)
                continue;
            L1L2Point d;
            const double weight = robust_weight(remainder_of(tracks, whole, i, &d), scale);
            const L1L2Point left = remainder_of(tracks, &others, i, &d);
            measurement->all[split] += weight * (d.x * d.x + d.y * d.y);
            measurement->explained[split] += weight * (d.x * d.x + d.y * d.y - left.x * left.x - left.y * left.y);
        }
    }
}

/* All rounds. scale: out, of the last one. */
static bool fit_all(const Tracks *tracks, double threshold, const bool *inlier, L1L2ShutterResidual *fit, double *scale)
{
    const L1L2ShutterParameters *parameters = tracks->parameters;
    L1L2ShutterResidual before = {{0.0}};
    *scale = threshold;
    bool ok = refit(tracks, none_left_out, inlier, 0.0, &before, fit);
    for (int round = 0; round < WIDE_ROUNDS + NARROW_ROUNDS && ok; round++) {
        before = *fit;
        *scale = (round < WIDE_ROUNDS ? parameters->wide_scale : parameters->narrow_scale) * threshold;
        ok = refit(tracks, none_left_out, NULL, *scale, &before, fit);
    }
    return ok;
}

static int mark_inliers(const Tracks *tracks, const L1L2ShutterResidual *fit, double threshold, bool *inlier)
{
    int inliers = 0;
    for (int i = 0; i < tracks->count; i++) {
        L1L2Point d;
        const L1L2Point left = remainder_of(tracks, fit, i, &d);
        inlier[i] = hypot(left.x, left.y) <= threshold;
        inliers += inlier[i];
    }
    return inliers;
}

int l1l2_shutter_fit(const L1L2ShutterModel *model, const L1L2Pair *pairs, int count, double threshold, bool *inlier,
                     const L1L2Mat *F, L1L2ShutterMeasurement *measurement)
{
    const L1L2ShutterParameters *parameters = l1l2_shutter_parameters_or_default(model->parameters);
    const Tracks tracks = {model, parameters, pairs, F, count};
    double scale;
    memset(measurement, 0, sizeof *measurement);
    if (l1l2_fit_coverage(model->half_w, model->half_h, pairs, inlier, count) < parameters->min_coverage ||
        !fit_all(&tracks, threshold, inlier, &measurement->r, &scale)) {
        memset(measurement, 0, sizeof *measurement);
        return 0;
    }
    for (int split = 0; split < L1L2_SPLITS; split++)
        validate(&tracks, split, scale, measurement);
    return mark_inliers(&tracks, &measurement->r, threshold, inlier);
}
