/* SPDX-License-Identifier: MIT */
/*
 * Whether the camera is the cause of what a similarity leaves of the motions. Rows that are read one after the other,
 * a lens, depth: what these do follows from how the camera moves. What moves by itself does not follow it, however
 * large and slow it is, and wherever in the picture.
 *
 * The residual of each frame is foretold from the camera's motions around it, by least squares over the frames before,
 * which fade. What goes along by chance for a while explains less than nothing soon: it was foretold otherwise.
 */
#ifndef L1L2_ROLLING_SHUTTER_CAMERA_GATE_H
#define L1L2_ROLLING_SHUTTER_CAMERA_GATE_H

#include "rolling_shutter/model.h"

enum {
    L1L2_SHUTTER_GATE_DELAY = 2,                       /* frames; motions before and after a frame tell of it */
    L1L2_SHUTTER_GATE_FRAMES = 2 * L1L2_SHUTTER_GATE_DELAY + 1, /* 20 Hz at 30 frames/s need five */
    L1L2_SHUTTER_GATE_SIZE = 2 * L1L2_SHUTTER_GATE_FRAMES + 2
};

/* Zeroed is new. */
typedef struct L1L2ShutterGate {
    double xx[L1L2_SHUTTER_GATE_SIZE][L1L2_SHUTTER_GATE_SIZE]; /* sums, fading; lower triangle */
    double xr[L1L2_SHUTTER_GATE_SIZE][L1L2_SHUTTER_SIZE];
    L1L2Mat F[L1L2_SHUTTER_GATE_FRAMES];                /* of the last frames, the newest last */
    L1L2ShutterResidual r[L1L2_SHUTTER_GATE_FRAMES];
    int known;                                   /* of them, in a row */
    double explained, all;                       /* of the frames so far, fading */
} L1L2ShutterGate;

/* What comes is not preceded by what was. What has been learned stays: it is the camera's. */
void l1l2_shutter_gate_break(L1L2ShutterGate *cause);

/* The next frame. step->explained and ->all of WITNESS_CAMERA become those of the frame DELAY frames before: mean
 * squares over the picture; 0 where not all was measured around it. */
void l1l2_shutter_gate_push(L1L2ShutterGate *cause, const L1L2ShutterModel *shape, const L1L2Mat *F,
                            L1L2ShutterMeasurement *step);

/* Part that the camera explained lately, at most 1. */
double l1l2_shutter_gate_share(const L1L2ShutterGate *cause);

#endif
