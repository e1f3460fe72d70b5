/* SPDX-License-Identifier: MIT */
/*
 * The values, and what each changes when it is halved and doubled.
 *
 * Figures come from two commands. "Tracks": tests/bench/bench_shutter_parameters.c on simulated tracks; "20 Hz" is its
 * clip "33 ms, 20 Hz", "10 Hz" its "20 ms, 10 Hz", "gaps" its "27 ms, gaps" and "pan" its "33 ms, fast pan"; wobble and
 * skew are errors in px, as "halved / value / doubled". "Clip": the same program with a real clip as input; the figures
 * are by how much the residual changes, rms px, "halved / doubled"; it is 0.72 px on walk-corridor and 1.29 px on bag.
 * A factor per frame is swept by its memory, 1 / (1 - factor), and a ramp by both of its ends. "Start" is a clip of 48
 * frames with a look-ahead of 24. What changed nothing is a constant where it is used.
 */
#include "rolling_shutter/parameters.h"

const L1L2ShutterParameters l1l2_shutter_default_parameters = {
    /* Tracks: wobble at 20 Hz 0.161 / 0.196 / 0.259, at 10 Hz 0.054 / 0.056 / 0.059. With less, noise bends the rows
     * where tracks are few; with more, the rows cannot follow a fast vibration. */
    .bend_weight = 3.0,
    /* Tracks: wobble at 20 Hz 0.187 / 0.196 / 0.216, at 10 Hz 0.054 / 0.056 / 0.063. */
    .translation_weight = 0.1,
    /* Tracks: wobble at 20 Hz 0.196, doubled 0.207, at 10 Hz 0.053 / 0.056 / 0.064. */
    .linear_weight = 0.3,
    /* Tracks: skew at 20 Hz 0.147 / 0.143, doubled unchanged. */
    .wide_scale = 1.0,
    /* Tracks: wobble at 20 Hz 0.267 / 0.196 / 0.174, at 10 Hz 0.065 / 0.056 / 0.054: wider is better there. Narrower is
     * better where a slow subject is near: skew of "shutter and subject" 0.388 / 0.403. */
    .narrow_scale = 0.7,
    /* Source: the share of cells that MediaPipe asks for. Tracks: wobble at 20 Hz 0.196, doubled 0.335; halved
     * unchanged, since the tracks are all over the frame. */
    .min_coverage = 0.3,

    /* 8 px at 640x360. Halved, a subject that moved with the camera by chance displaced the first frames of a clip by
     * 1.2 px instead of 0.5 (the case of test_shutter). Tracks: doubled, a shutter is confirmed late, and wobble at the
     * start is 0.186 instead of 0.047. Clip: bag 0.00 / 0.18. */
    .gate_ridge = 0.011,
    /* The rms distance of a 16:9 frame's points from its center is 0.29. Clip: bag 0.33 / 0.00. */
    .gate_arm = 0.3,

    /* Tracks: wobble in gaps 0.217 / 0.209, skew in gaps 0.294 / 0.271; of a homography, skew 0.138 / 0.151 / 0.172.
     * Clip: walk-corridor 0.19 / 0.15, bag 0.62 / 0.44. The memory is 1 / sqrt(leak) = 6 frames. */
    .leak = 0.03,
    /* Tracks: wobble in gaps 0.194 / 0.209 / 0.224. Clip: bag 0.11 / 0.13. */
    .unmeasured_weight = 0.1,
    /* A memory of 20 frames. Clip: walk-corridor 0.051 / 0.004, bag 0.074 / 0.008. */
    .confidence_fade = 0.95,
    /* The prediction explains -6 % of pure noise, and 3 to 72 % of the residuals of ten real clips. A clip with less
     * than 30 % became worse by the correction. Tracks: doubled, wobble at 10 Hz 0.097 instead of 0.056, of a
     * homography 0.282 instead of 0.138. Clip: walk-corridor 0.00 / 0.51, bag 0.01 / 0.74. */
    .halves = {0.3, 0.5},
    /* The prediction explains 90 % of a shutter alone, and 10 to 50 % on real clips. Of slow subjects in the middle it
     * explains less than nothing. Clip: walk-corridor 0.004 / 0.079, bag 0.00 / 0.05. */
    .columns = {0.0, 0.15},
    /* The camera's motion explains 80 to 98 % of a shutter alone, 30 to 80 % on real clips, and less than 5 % of
     * independent subjects in 95 of 100 frames. `none` is three times those 5 %. Tracks: doubled, wobble at the start
     * 0.188 instead of 0.047. Clip: bag 0.00 / 0.80, walk-corridor 0.00 / 0.01. */
    .camera = {0.15, 0.3},
    /* 15 px at 640x360. Clip: bag 0.03 / 0.00, since mostly max_stretch is the limit that is reached. It bounds the
     * error of the mesh's fixed point (mesh.c) and what a wrong residual can do. */
    .max_reach = 0.02,
    /* Tracks: skew of the pan 7.47 / 6.10 / 3.38; wobble at 20 Hz 0.730 / 0.196, doubled unchanged. More would be right
     * for a shutter, but such a correction reshapes the picture visibly. Clip: bag 0.22 / 0.01. */
    .max_stretch = 0.03,

    /* Tracks: doubled, skew at 10 Hz 0.061 instead of 0.050, at 20 Hz 0.177 instead of 0.143; halved unchanged, since
     * simulated tracks agree either fully or not at all. Clip: walk-corridor 0.00 / 0.19. */
    .readout_agreement = {0.4, 0.6},
    /* No camera takes longer for a frame than a frame lasts. Tracks: halved, skew at 20 Hz 0.152 instead of 0.143.
     * Clip: walk-corridor 0.11 / 0.00. */
    .max_readout = 1.0,
    /* The estimate is some 10 % too long (docs/rolling-shutter.md), so up to 1.2 counts in full. Tracks: halved, skew
     * of the pan 8.83 instead of 6.10, at 10 Hz 0.065 instead of 0.050. Clip: walk-corridor 0.23 / 0.00. */
    .readout_too_long = {1.5, 1.2},

    /* Tracks: where the mesh crosses the border, 0.30 / 0.38 / 0.50 of the correction is lost; the least local scale is
     * 0.83 / 0.91 / 0.95. Less loses less, but compresses what is left more visibly. */
    .compress_zone = 0.125,

    /* Of two surfaces that share rows, no shift of the rows explains more than half. Tracks: of 100 frames of a strong
     * vibration, 34 / 100 / 100 are accepted; of two surfaces, none. */
    .rows_unexplained = 0.3,
    /* Tracks: 100 / 100 / 31 frames of the vibration are accepted. */
    .rows_cap = 4.0,
    /* A subject's edge is a larger jump. Tracks: 8 / 100 / 100 frames of the vibration are accepted. */
    .rows_max_jump = 4.0,
};
