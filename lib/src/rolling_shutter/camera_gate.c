/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/camera_gate.h"

#include <math.h>
#include <string.h>

enum { N = L1L2_SHUTTER_GATE_SIZE };

static const double forget = 0.99; /* of what is learned, each frame */
static const double fade = 0.95;   /* of what was explained */
/* Diagonals, 8 px at 640x360: motions of so much, all together, do not tell yet. At half of it, a mover that happened
 * to go along with the first 24 frames bent them by 1.2 px, not 0.5; at twice, a shutter was believed too late. */
static const double least_motion = 0.011;
/* A turn or zoom moves the frame's points by so many diagonals on average. */
static const double mean_arm = 0.3;

/* All translations, and the turn and zoom of the frame itself. */
static void gather(const L1L2ShutterGate *cause, double x[N])
{
    const L1L2Mat *middle = &cause->F[L1L2_SHUTTER_GATE_DELAY];
    for (int k = 0; k < L1L2_SHUTTER_GATE_FRAMES; k++)
        x[2 * k] = cause->F[k].m[2], x[2 * k + 1] = cause->F[k].m[5];
    x[N - 2] = mean_arm * middle->m[3];
    x[N - 1] = mean_arm * (middle->m[0] - 1.0);
}

/* y = (xx + least_motion^2)^-1 x, by Cholesky. */
static void weigh(const L1L2ShutterGate *cause, const double x[N], double y[N])
{
    double L[N][N];
    for (int i = 0; i < N; i++) {
        y[i] = x[i];
        for (int j = 0; j <= i; j++) {
            double sum = cause->xx[i][j] + (i == j ? least_motion * least_motion : 0.0);
            for (int k = 0; k < j; k++)
                sum -= L[i][k] * L[j][k];
            L[i][j] = i == j ? sqrt(fmax(sum, 1e-300)) : sum / L[j][j];
        }
        for (int k = 0; k < i; k++)
            y[i] -= L[i][k] * y[k];
        y[i] /= L[i][i];
    }
    for (int i = N - 1; i >= 0; i--) {
        for (int k = i + 1; k < N; k++)
            y[i] -= L[k][i] * y[k];
        y[i] /= L[i][i];
    }
}

static double mean_square(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r)
{
    enum { COLUMNS = 3, ROWS = 5 };
    double sum = 0.0;
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        const L1L2Point p = {(i % COLUMNS - 1) * 0.9 * shape->half_w, (i / COLUMNS - 2) * 0.45 * shape->half_h};
        const L1L2Point d = l1l2_shutter_residual_at(shape, r, p);
        sum += d.x * d.x + d.y * d.y;
    }
    return sum / (COLUMNS * ROWS);
}

/* The frame in the middle: foretold, compared, and then learned from. */
static void compare(L1L2ShutterGate *cause, const L1L2ShutterModel *shape, double *explained, double *all)
{
    const L1L2ShutterResidual *r = &cause->r[L1L2_SHUTTER_GATE_DELAY];
    L1L2ShutterResidual left = *r;
    double x[N], y[N];
    gather(cause, x);
    weigh(cause, x, y);
    for (int i = 0; i < N; i++) {
        for (int p = 0; p < L1L2_SHUTTER_SIZE; p++) {
            left.p[p] -= y[i] * cause->xr[i][p];
            cause->xr[i][p] = forget * cause->xr[i][p] + x[i] * r->p[p];
        }
        for (int j = 0; j <= i; j++)
            cause->xx[i][j] = forget * cause->xx[i][j] + x[i] * x[j];
    }
    *all = mean_square(shape, r);
    *explained = *all - mean_square(shape, &left);
}

void l1l2_shutter_gate_break(L1L2ShutterGate *cause)
{
    cause->known = 0;
    cause->explained = cause->all = 0.0;
}

void l1l2_shutter_gate_push(L1L2ShutterGate *cause, const L1L2ShutterModel *shape, const L1L2Mat *F,
                            L1L2ShutterMeasurement *step)
{
    double explained = 0.0, all = 0.0;
    memmove(cause->F, cause->F + 1, (L1L2_SHUTTER_GATE_FRAMES - 1) * sizeof *cause->F);
    memmove(cause->r, cause->r + 1, (L1L2_SHUTTER_GATE_FRAMES - 1) * sizeof *cause->r);
    cause->F[L1L2_SHUTTER_GATE_FRAMES - 1] = *F;
    cause->r[L1L2_SHUTTER_GATE_FRAMES - 1] = step->r;
    if (++cause->known >= L1L2_SHUTTER_GATE_FRAMES)
        compare(cause, shape, &explained, &all);
    cause->explained = fade * cause->explained + explained;
    cause->all = fade * cause->all + all;
    step->explained[L1L2_VALIDATION_CAMERA] = explained;
    step->all[L1L2_VALIDATION_CAMERA] = all;
}

double l1l2_shutter_gate_share(const L1L2ShutterGate *cause)
{
    return cause->all > 0.0 ? cause->explained / cause->all : 0.0;
}
