/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 2: which model of the motion into a frame the tracks support
 *
 *   affine (if configured) -> similarity -> translation -> predicted -> identity
 *
 * The highest model that passes its acceptance tests is selected: it has to be a motion that a camera makes from one
 * frame to the next, with enough inliers. A lower model is taken at once. A higher one is taken again if it has many
 * inliers, after three acceptable frames in a row, or if no lower one is acceptable, so that the model does not change
 * from frame to frame.
 *
 * Quality, [0, 1]: the part of the consensus weight that agrees. It is less if another motion has much weight too, if
 * the inliers cover little of what is measured, and if the tracks are noisy. If two motions have about equal weight,
 * neither is followed.
 */
#ifndef L1L2_MOTION_MODEL_SELECTION_H
#define L1L2_MOTION_MODEL_SELECTION_H

#include <l1l2stab/l1l2stab.h>

#include "motion/track_weights.h"

typedef struct L1L2ModelSelection {
    const L1L2MotionParameters *parameters;
    L1L2StabMotionModel highest; /* that is fitted: similarity or affine */
    double threshold;            /* of the inliers, in the pairs' unit */
    double measured_share;       /* part of the frame that is measured, (0, 1]: inliers cannot cover more of it */
    L1L2StabMotionModel current; /* selected last */
    int acceptable_frames;       /* in a row, in which a higher model than the current one was acceptable */
    L1L2Mat last;                /* the last measured motion, decaying while it is used as the prediction */
    int lost;                    /* frames since then */
    struct {                     /* of a camera that may be standing still */
        int frames;              /* without significant motion */
        double sum[6];           /* of F less the identity, decaying */
        double variance;         /* of the corners under that sum, expected from noise */
    } still;
    double rivalry;              /* [0, 1], decaying: of the agreeing weight, what another motion had lately */
    double agreement;            /* lowest quality since corners were selected: outliers are dropped after each frame */
} L1L2ModelSelection;

typedef struct L1L2SelectedModel {
    L1L2StabMotionSource source; /* NONE: nothing was measured */
    L1L2Mat F;
    int inliers;
    double quality;              /* [0, 1] */
    bool ambiguous;              /* source NONE, but F is an acceptable motion: another one has about equal weight */
} L1L2SelectedModel;

/* Forgets the motion and the model: a path starts. */
void l1l2_motion_model_reset(L1L2ModelSelection *s);

/* Selects a model for the tracks of a frame. tracks->threshold: ours. reselected: new corners were selected for this
 * frame. inlier, core: tracks->count flags each, written. The core are the inliers to which F was fitted. */
L1L2SelectedModel l1l2_motion_model_select(L1L2ModelSelection *s, const L1L2TrackWeights *w,
                                           const L1L2TrackSet *tracks, bool reselected, bool *inlier, bool *core);

/* Selects a similarity that was found by other means. */
L1L2SelectedModel l1l2_motion_model_adopt(L1L2ModelSelection *s, const L1L2Mat *F, int inliers, double quality);

/* The motion of a frame in which nothing was measured: the last one, decaying, and after a while the identity. */
L1L2SelectedModel l1l2_motion_model_predict(L1L2ModelSelection *s);

#endif
