/* SPDX-License-Identifier: MIT */
/*
 * The camera gate: how much of the rolling-shutter residual follows from the camera's motion.
 *
 * Rows that are read one after the other, a lens, and depth all leave a residual that is a function of how the camera
 * moves. A subject that moves by itself leaves one that is not, however large and slow it is, and wherever it is in the
 * picture. So the residual of each frame is predicted from the camera's motions around it, by a linear regression that
 * was learned from the frames before. The part that the prediction explains is the camera's. A residual that follows
 * the camera by chance soon scores negative, because each frame is predicted before it is learned.
 *
 * This is not part of G2011, which limits the homographies' terms instead. Convention: as in model.h.
 */
#ifndef L1L2_ROLLING_SHUTTER_CAMERA_GATE_H
#define L1L2_ROLLING_SHUTTER_CAMERA_GATE_H

#include "rolling_shutter/model.h"

enum {
    L1L2_SHUTTER_GATE_DELAY = 2, /* frames before and after a frame from whose motions it is predicted */
    L1L2_SHUTTER_GATE_FRAMES = 2 * L1L2_SHUTTER_GATE_DELAY + 1, /* 20 Hz at 30 frames/s need five */
    L1L2_SHUTTER_GATE_SIZE = 2 * L1L2_SHUTTER_GATE_FRAMES + 2   /* regressors: all translations, one roll, one zoom */
};

/* All zero is a new one. It owns nothing. */
typedef struct L1L2ShutterGate {
    double xx[L1L2_SHUTTER_GATE_SIZE][L1L2_SHUTTER_GATE_SIZE]; /* faded sum of x x'; lower triangle */
    double xr[L1L2_SHUTTER_GATE_SIZE][L1L2_SHUTTER_SIZE];      /* faded sum of x r' */
    L1L2Mat F[L1L2_SHUTTER_GATE_FRAMES];                       /* of the last frames, the newest last */
    L1L2ShutterResidual r[L1L2_SHUTTER_GATE_FRAMES];           /* the same */
    int known;             /* frames in a row up to now */
    double explained, all; /* faded sums over the frames so far */
} L1L2ShutterGate;

/* Discontinuity: drops the motion history, keeps the regression. It belongs to the camera, which stays the same. */
void l1l2_shutter_gate_break(L1L2ShutterGate *gate);

/* Takes the next frame. F: its motion. measurement: in, its residual; out, the sums of L1L2_VALIDATION_CAMERA of the
 * frame L1L2_SHUTTER_GATE_DELAY frames before it, mean squares over the picture. They are 0 if that frame or one around
 * it was not measured. Numbers that are not finite count as a discontinuity. */
void l1l2_shutter_gate_push(L1L2ShutterGate *gate, const L1L2ShutterModel *model, const L1L2Mat *F,
                            L1L2ShutterMeasurement *measurement);

/* The part of the last frames' residuals that the camera's motion explains: at most 1, negative if the predictions make
 * them larger, 0 if nothing was compared. */
double l1l2_shutter_gate_share(const L1L2ShutterGate *gate);

#endif
