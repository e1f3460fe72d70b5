/* SPDX-License-Identifier: MIT */
/*
 * Recursive least squares with exponential forgetting (Haykin, "Adaptive Filter Theory"; here by normal equations,
 * which at this size cost less than they would save).
 *
 * The residual of frame t is taken to be linear in the motions around it: r_t = W' x_t + noise. x_t holds the
 * translations of frames t-2 to t+2 and the roll and zoom of frame t, all as lengths. With forgetting factor f, the W
 * that fits the frames before t minimizes
 *
 *     sum_{s<t} f^(t-1-s) |r_s - W' x_s|^2 + ridge^2 |W|^2,     so     W = (XX + ridge^2 I)^-1 XR,
 *
 * with XX = sum f^(t-1-s) x_s x_s' and XR = sum f^(t-1-s) x_s r_s'. The prediction for frame t is
 *
 *     W' x_t = XR' y,     where     (XX + ridge^2 I) y = x_t:
 *
 * one solve with a single right-hand side, whatever the number of residual parameters. Only then is frame t added to
 * the sums. So each frame is predicted by a regression that has not seen it, and the number of regressors does not help
 * the prediction: twelve regressors explain part of any twelve frames to which they are fitted, but nothing of the next
 * frame.
 *
 * The ridge keeps the prediction near zero while the camera has hardly moved. Without it, any regressors would fit the
 * first few frames exactly.
 */
#include "rolling_shutter/camera_gate.h"

#include <math.h>
#include <string.h>

#include "common/cholesky.h"

/* Factors per frame: of what the regression has learned (a memory of 100 frames: the camera may zoom), and of the sums
 * of l1l2_shutter_gate_share() (20 frames). Half and twice the first memory changed nothing in
 * bench_shutter_parameters. */
static const double forget = 0.99, share_fade = 0.95;

enum { N = L1L2_SHUTTER_GATE_SIZE, DELAY = L1L2_SHUTTER_GATE_DELAY, FRAMES = L1L2_SHUTTER_GATE_FRAMES };

/* x_t of the frame in the middle of the history. */
static void gather_regressors(const L1L2ShutterGate *gate, double arm, double x[N])
{
    const L1L2Mat *middle = &gate->F[DELAY];
    for (int k = 0; k < FRAMES; k++)
        x[2 * k] = gate->F[k].m[2], x[2 * k + 1] = gate->F[k].m[5];
    x[N - 2] = arm * middle->m[3];
    x[N - 1] = arm * (middle->m[0] - 1.0);
}

/* y = (XX + ridge^2 I)^-1 x. False where rounding has left no positive definite matrix. */
static bool solve(const L1L2ShutterGate *gate, double ridge, const double x[N], double y[N])
{
    double A[N][N];
    memcpy(A, gate->xx, sizeof A);
    memcpy(y, x, N * sizeof *y);
    for (int i = 0; i < N; i++)
        A[i][i] += ridge * ridge;
    if (!l1l2_cholesky_factorize(&A[0][0], N, N))
        return false;
    l1l2_cholesky_solve(&A[0][0], N, N, y);
    return true;
}

/* The mean square of a residual's displacements over the picture. */
static double mean_square(const L1L2ShutterModel *model, const L1L2ShutterResidual *r)
{
    enum { COLUMNS = 3, ROWS = 5 };
    double sum = 0.0;
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        const L1L2Point p = {(i % COLUMNS - 1) * 0.9 * model->half_w, (i / COLUMNS - 2) * 0.45 * model->half_h};
        const L1L2Point d = l1l2_shutter_residual_at(model, r, p);
        sum += d.x * d.x + d.y * d.y;
    }
    return sum / (COLUMNS * ROWS);
}

/* Predicts the frame in the middle of the history and compares. Returns its residual less the prediction. */
static L1L2ShutterResidual prediction_error(const L1L2ShutterGate *gate, double ridge, const double x[N])
{
    L1L2ShutterResidual left = gate->r[DELAY];
    double y[N];
    if (!solve(gate, ridge, x, y))
        return left;
    for (int i = 0; i < N; i++)
        for (int p = 0; p < L1L2_SHUTTER_SIZE; p++)
            left.p[p] -= y[i] * gate->xr[i][p];
    return left;
}

/* Adds the frame in the middle of the history to the sums. */
static void learn(L1L2ShutterGate *gate, const double x[N])
{
    const L1L2ShutterResidual *r = &gate->r[DELAY];
    for (int i = 0; i < N; i++) {
        for (int p = 0; p < L1L2_SHUTTER_SIZE; p++)
            gate->xr[i][p] = forget * gate->xr[i][p] + x[i] * r->p[p];
        for (int j = 0; j <= i; j++)
            gate->xx[i][j] = forget * gate->xx[i][j] + x[i] * x[j];
    }
}

void l1l2_shutter_gate_break(L1L2ShutterGate *gate)
{
    gate->known = 0;
    gate->explained = gate->all = 0.0;
}

void l1l2_shutter_gate_push(L1L2ShutterGate *gate, const L1L2ShutterModel *model, const L1L2Mat *F,
                            L1L2ShutterMeasurement *measurement)
{
    const L1L2ShutterParameters *parameters = l1l2_shutter_parameters_or_default(model->parameters);
    double explained = 0.0, all = 0.0;
    measurement->explained[L1L2_VALIDATION_CAMERA] = measurement->all[L1L2_VALIDATION_CAMERA] = 0.0;
    /* The sums would never recover from a NaN. */
    if (!l1l2_mat_is_finite(F) || !l1l2_shutter_residual_is_finite(&measurement->r)) {
        l1l2_shutter_gate_break(gate);
        return;
    }
    memmove(gate->F, gate->F + 1, (FRAMES - 1) * sizeof *gate->F);
    memmove(gate->r, gate->r + 1, (FRAMES - 1) * sizeof *gate->r);
    gate->F[FRAMES - 1] = *F;
    gate->r[FRAMES - 1] = measurement->r;
    if (gate->known < FRAMES)
        gate->known++;
    if (gate->known == FRAMES) {
        double x[N];
        gather_regressors(gate, parameters->gate_arm, x);
        const L1L2ShutterResidual left = prediction_error(gate, parameters->gate_ridge, x);
        all = mean_square(model, &gate->r[DELAY]);
        explained = all - mean_square(model, &left);
        learn(gate, x);
    }
    gate->explained = share_fade * gate->explained + explained;
    gate->all = share_fade * gate->all + all;
    measurement->explained[L1L2_VALIDATION_CAMERA] = explained;
    measurement->all[L1L2_VALIDATION_CAMERA] = all;
}

double l1l2_shutter_gate_share(const L1L2ShutterGate *gate)
{
    return gate->all > 0.0 ? gate->explained / gate->all : 0.0;
}
