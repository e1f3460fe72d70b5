/* SPDX-License-Identifier: MIT */
/*
 * All tunable numbers of this folder in one table. This header says what each one does, and in which unit. The values
 * are in parameters.c, each with the measurement or the source that chose it.
 *
 * Lengths are in the frame's diagonals unless a field says "thresholds": those are multiples of the inlier threshold
 * that motion/ uses for its tracks. "Explained" is a part of a sum of squares: 1 is all of it, 0 nothing.
 */
#ifndef L1L2_ROLLING_SHUTTER_PARAMETERS_H
#define L1L2_ROLLING_SHUTTER_PARAMETERS_H

/* Where the confidence of a validation test begins, and where it is full. It is linear between. */
typedef struct L1L2ShutterRamp {
    double none, full;
} L1L2ShutterRamp;

typedef struct L1L2ShutterParameters {
    /* fit.c: the fit between two frames. The first three are weights of squared terms, against one track's weight of 1,
     * in a fit to 200 tracks. They grow with the number of tracks. */
    double bend_weight;        /* of the second difference of neighboring bands' translations: smooths along the rows */
    double translation_weight; /* of each band's translation: pulls it to zero */
    double linear_weight;      /* of a mixture's roll, zoom and perspective */
    double wide_scale;         /* thresholds: in the first rounds, a track that is so far off weighs a quarter ... */
    double narrow_scale;       /* ... and in the last rounds */
    double min_coverage;       /* part of the frame's cells that must hold an inlier; else nothing is fitted */

    /* camera_gate.c: the regression of the residual on the camera's motions. */
    double gate_ridge; /* ridge of the regression, as a motion: less motion than this predicts nearly nothing */
    double gate_arm;   /* by how much a roll of 1 rad, or a zoom of 1, moves the frame's points on average */

    /* filter.c: the residual of each frame. */
    double leak; /* weight of |e_t - k_t|^2 against a measured change's weight of 1 */
    double unmeasured_weight; /* of a frame's predicted change where nothing was measured */
    double confidence_fade; /* factor per frame of distance: the validation tests' sums around a frame */
    L1L2ShutterRamp halves, columns, camera; /* parts explained, for each validation test */
    double max_reach; /* longest correction; a longer one is scaled down */
    double max_stretch; /* most that a correction makes the frame longer one way than across, as a part of 1 */

    /* readout.c: the time from the first row to the last. */
    L1L2ShutterRamp readout_agreement; /* squared correlation of the skew's changes with the accelerations */
    double max_readout; /* frames: a longer estimate is clipped to this ... */
    L1L2ShutterRamp readout_too_long;  /* frames: ... and its confidence falls from full to none between these */

    /* mesh.c */
    double compress_zone; /* part of the source's side that is compressed where the mesh reaches across that side */

    /* similarity_by_rows.c: the similarity of a frame whose rows moved differently. */
    double rows_unexplained; /* the largest part of the squared residuals that the rows' shifts may leave unexplained */
    double rows_cap;         /* thresholds: no residual counts as longer, and one of this length has half weight */
    double rows_max_jump;    /* thresholds: from one band's shift to the next; a subject's edge is a larger jump */
} L1L2ShutterParameters;

extern const L1L2ShutterParameters l1l2_shutter_default_parameters;

/* The given table, or the default values if it is NULL. */
static inline const L1L2ShutterParameters *l1l2_shutter_parameters_or_default(const L1L2ShutterParameters *parameters)
{
    return parameters ? parameters : &l1l2_shutter_default_parameters;
}

#endif
