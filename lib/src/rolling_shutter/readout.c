/* SPDX-License-Identifier: MIT */
/*
 * A camera that moves at velocity v_t has moved by readout * row * v_t, relative to the frame's time, when it reads a
 * row. So the slope of a frame's displacements along the rows is readout * v_t. It cannot be measured: what all frames
 * have in common is invisible. Its change from frame to frame can, as the slope of the residual between two frames:
 *
 *     slope(r_t) = readout * (v_t - v_{t-1}).
 *
 * F_t is the camera's path from frame t-1 to frame t, and thus the velocity halfway between them. v_t - v_{t-1} is the
 * path's acceleration at the same halfway point, one frame long, which is the derivative of the sequence F at t. From
 * five motions it is, to fourth order: (F_{t-2} - 8 F_{t-1} + 8 F_{t+1} - F_{t+2}) / 12.
 *
 * That holds for slow changes of the velocity only, so both sides go through the same binomial low-pass filter
 * (1 4 6 4 1)/16 before the regression. The readout is the least squares slope sum(xy) / sum(xx), with forgetting: the
 * camera may change its mode. It is trusted as far as the squared correlation sum(xy)^2 / (sum(xx) sum(yy)) is high and
 * the time is possible: no camera takes much longer for a frame than a frame lasts.
 */
#include "rolling_shutter/readout.h"

#include <math.h>

/* Factor per frame: a memory of 500 frames, since the camera may change its mode. And the (faded) frames before there
 * is an estimate. Half and twice of either changed nothing in bench_shutter_parameters. */
static const double forget = 0.998, min_frames = 20.0;

enum { DELAY = L1L2_SHUTTER_READOUT_DELAY };

double l1l2_shutter_ramp(double value, L1L2ShutterRamp ramp)
{
    return fmin(fmax((value - ramp.none) / (ramp.full - ramp.none), 0.0), 1.0);
}

/* The least squares slope of the bands' translations along the rows, from the first row to the last. */
static L1L2Point slope(const L1L2ShutterResidual *r)
{
    L1L2Point sum = {0.0, 0.0};
    double norm = 0.0;
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        const double row = l1l2_shutter_band_row(k);
        sum.x += row * r->p[L1L2_SHUTTER_X + k], sum.y += row * r->p[L1L2_SHUTTER_Y + k];
        norm += row * row;
    }
    return (L1L2Point){sum.x / norm, sum.y / norm};
}

void l1l2_shutter_readout_learn(L1L2ShutterReadout *readout, const L1L2ShutterReadoutFrames *around)
{
    static const double derivative[5] = {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0};
    static const double lowpass[5] = {0.0625, 0.25, 0.375, 0.25, 0.0625};
    L1L2Point x = {0.0, 0.0}, y = {0.0, 0.0};
    for (int j = -2; j <= 2; j++) {
        const L1L2Point change = slope(around->r[DELAY + j]);
        for (int k = -2; k <= 2; k++) {
            const L1L2Mat *F = around->F[DELAY + j + k];
            x.x += lowpass[j + 2] * derivative[k + 2] * F->m[2];
            x.y += lowpass[j + 2] * derivative[k + 2] * F->m[5];
        }
        y.x += lowpass[j + 2] * change.x, y.y += lowpass[j + 2] * change.y;
    }
    readout->xy = forget * readout->xy + x.x * y.x + x.y * y.y;
    readout->xx = forget * readout->xx + x.x * x.x + x.y * x.y;
    readout->yy = forget * readout->yy + y.x * y.x + y.y * y.y;
    readout->frames = forget * readout->frames + 1.0;
}

double l1l2_shutter_readout_estimate(const L1L2ShutterReadout *readout, const L1L2ShutterParameters *parameters)
{
    const double xx = readout->xx, xy = readout->xy, yy = readout->yy, most = parameters->max_readout;
    if (readout->frames < min_frames || !(xx > 0.0 && yy > 0.0))
        return 0.0;
    const double estimate = xy / xx, agreement = xy * xy / (xx * yy);
    const double confidence = l1l2_shutter_ramp(agreement, parameters->readout_agreement) *
                              l1l2_shutter_ramp(fabs(estimate), parameters->readout_too_long);
    return confidence * fmin(fmax(estimate, -most), most);
}
