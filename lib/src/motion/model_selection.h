/* SPDX-License-Identifier: MIT */
/*
 * Step 2: the model of the motion into a frame, from the highest rung that the tracks can bear
 *
 *   affine (where it is asked for) -> similarity -> translation -> predicted -> identity
 *
 * A rung has gates: what a camera does from one frame to the next, and enough tracks that agree. Down is at once; up
 * again takes plenty of tracks or three good frames in a row, so that the model does not flip from frame to frame.
 *
 * Quality, [0, 1]: the part of the votes that agree; less where another motion has many votes too, and where they cover
 * little of the frame. Where two motions have about as many votes, neither is followed.
 */
#ifndef L1L2_MOTION_MODEL_SELECTION_H
#define L1L2_MOTION_MODEL_SELECTION_H

#include "fit/ransac.h"
#include "motion/track_weights.h"

typedef struct L1L2ModelSelection {
    L1L2StabMotionModel wanted; /* the highest rung: similarity or affine */
    double threshold;           /* of the inliers, in the pairs' unit */
    L1L2StabMotionModel rung;   /* that was borne last */
    int waiting;                /* frames in a row that a higher one was */
    L1L2Mat last;               /* the last measured motion, fading while it is predicted from */
    int lost;                   /* frames since then */
    struct {                    /* a camera that stands still, as far as can be told */
        int frames;             /* so long */
        double sum[6];          /* of F less the identity, fading */
        double variance;        /* that noise has given it, at the corners */
    } still;
    double agreed;              /* quality when points were chosen last: after that, only those that agree are left */
} L1L2ModelSelection;

typedef struct L1L2SelectedModel {
    L1L2StabMotionSource model; /* NONE: nothing was measured */
    L1L2Mat F;
    int inliers;
    double quality;      /* [0, 1] */
} L1L2SelectedModel;

/* A path starts: the motion before it means nothing. */
void l1l2_motion_model_reset(L1L2ModelSelection *l);

/* selected: points were chosen anew for this frame. inlier, core: `count` flags out; of the inliers, the core is what F
 * was fitted to. */
L1L2SelectedModel l1l2_motion_model_select(L1L2ModelSelection *l, const L1L2TrackWeights *v, const L1L2Pair *pairs,
                                           L1L2PairWeights say, int count, bool selected, L1L2Rng *rng, bool *inlier,
                                           bool *core);

/* A similarity that was found otherwise. */
L1L2SelectedModel l1l2_motion_model_adopt(L1L2ModelSelection *l, const L1L2Mat *F, int inliers, double quality);

/* The motion where nothing was measured: the one before it, fading, and then none. */
L1L2SelectedModel l1l2_motion_model_predict(L1L2ModelSelection *l);

#endif
