/* SPDX-License-Identifier: MIT */
/*
 * Hard cuts: a frame whose motion could not be measured starts another shot if its thumbnail is unlike everything that
 * the shot has shown lately.
 */
#ifndef L1L2_MOTION_SHOT_CUT_H
#define L1L2_MOTION_SHOT_CUT_H

#include "image/thumbnail.h"

/* A shot, by what it has shown. */
enum { L1L2_CUT_MEMORY = 4, L1L2_CUT_STEP = 8 /* frames */ };
typedef struct L1L2ShotCut {
    L1L2Thumbnail shown[L1L2_CUT_MEMORY]; /* the newest first, the others some frames apart */
    int count, frames;                     /* thumbnails; frames since the second one */
    bool unsure;                           /* the motion was lost, and nothing has shown the same scene since then */
} L1L2ShotCut;

/* The first frame. */
void l1l2_motion_cut_start(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail);

/* The next one. True where it belongs to another shot: its motion (or that of a frame a moment ago) could not be
 * measured, and it shows something that is unlike all that the shot has shown lately. While nothing is to be seen, no
 * other shot begins. */
bool l1l2_motion_cut_push(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail, bool measured);

#endif
