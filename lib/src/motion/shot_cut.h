/* SPDX-License-Identifier: MIT */
/*
 * Detection of hard cuts: a frame whose motion could not be measured starts another shot if its thumbnail differs from
 * all that the current shot has shown lately.
 */
#ifndef L1L2_MOTION_SHOT_CUT_H
#define L1L2_MOTION_SHOT_CUT_H

#include "image/thumbnail.h"

/* The last frame and three older ones, 8 frames apart: a second of video at 30 frames/s. */
enum { L1L2_CUT_MEMORY = 4, L1L2_CUT_STEP = 8 /* frames */ };
typedef struct L1L2ShotCut {
    L1L2Thumbnail shown[L1L2_CUT_MEMORY]; /* by the shot, the newest first */
    int count;                            /* of thumbnails */
    int frames;                           /* since the second thumbnail */
    bool unsure;                          /* the motion was lost, and no frame was measured since then */
} L1L2ShotCut;

/* Forgets all pictures but this one, the first of a shot. */
void l1l2_motion_cut_start(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail);

/* Takes the next frame. True if it starts another shot: its motion, or that of a frame shortly before, could not be
 * measured, and its picture differs from all recent pictures of the shot. A picture without detail starts no shot. */
bool l1l2_motion_cut_push(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail, bool measured);

#endif
