/* SPDX-License-Identifier: MIT */
/*
 * The readout: the time from the first row to the last, estimated from the motions themselves, without a calibration.
 *
 * Convention: in frames; negative where the last row is read first, as in a camera that is held upside down.
 */
#ifndef L1L2_ROLLING_SHUTTER_READOUT_H
#define L1L2_ROLLING_SHUTTER_READOUT_H

#include "rolling_shutter/model.h"

enum {
    L1L2_SHUTTER_READOUT_DELAY = 4, /* frames before and after a frame that its terms of the regression take */
    L1L2_SHUTTER_READOUT_FRAMES = 2 * L1L2_SHUTTER_READOUT_DELAY + 1
};

/* All zero is a new one. It owns nothing. */
typedef struct L1L2ShutterReadout {
    double xy, xx, yy; /* faded sums: accelerations x, changes of the skew y */
    double frames;     /* faded count */
} L1L2ShutterReadout;

/* A frame and those around it, oldest first, all measured, without a cut between them. Not owned. */
typedef struct L1L2ShutterReadoutFrames {
    const L1L2Mat *F[L1L2_SHUTTER_READOUT_FRAMES];
    const L1L2ShutterResidual *r[L1L2_SHUTTER_READOUT_FRAMES]; /* of a mixture, between frames */
} L1L2ShutterReadoutFrames;

/* Adds the frame in the middle to the regression. */
void l1l2_shutter_readout_learn(L1L2ShutterReadout *readout, const L1L2ShutterReadoutFrames *around);

/* The estimate, scaled by its confidence; in [-max_readout, max_readout]; 0 where it is not known. */
double l1l2_shutter_readout_estimate(const L1L2ShutterReadout *readout, const L1L2ShutterParameters *parameters);

/* The confidence of a value: 0 at ramp.none, 1 at ramp.full, linear between, clipped. The two must differ;
 * either may be the larger. */
double l1l2_shutter_ramp(double value, L1L2ShutterRamp ramp);

#endif
