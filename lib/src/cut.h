/* SPDX-License-Identifier: MIT */
/*
 * Is this another shot? Two thumbnails of grey levels are compared by their normalised cross-correlation, the best over
 * small shifts: it sees neither brightness nor contrast, so neither a flash nor a change of exposure is a cut.
 * Pictures with nothing on them (a covered lens, black frames) are neither alike nor different.
 */
#ifndef L1L2_CUT_H
#define L1L2_CUT_H

#include <stdbool.h>
#include <stdint.h>

#define L1L2_THUMBNAIL_W 32
#define L1L2_THUMBNAIL_H 18

typedef struct L1L2Thumbnail {
    uint8_t level[L1L2_THUMBNAIL_H * L1L2_THUMBNAIL_W]; /* row by row */
} L1L2Thumbnail;

/* Is there anything to be seen? */
bool l1l2_thumbnail_shows_something(const L1L2Thumbnail *thumbnail);

/* The best correlation over shifts of an eighth of the picture, [-1, 1]; 0 where one of them shows nothing. */
double l1l2_thumbnail_likeness(const L1L2Thumbnail *a, const L1L2Thumbnail *b);

/* Both show something, and not the same, not even in parts. */
bool l1l2_thumbnails_differ(const L1L2Thumbnail *a, const L1L2Thumbnail *b);

/* A shot, by what it has shown. */
enum { L1L2_SHOT_MEMORY = 4, L1L2_SHOT_STEP = 8 /* frames */ };
typedef struct L1L2Shot {
    L1L2Thumbnail shown[L1L2_SHOT_MEMORY]; /* the newest first, the others some frames apart */
    int count, frames;                     /* thumbnails; frames since the second one */
    bool unsure;                           /* the motion was lost, and nothing has shown the same scene since then */
} L1L2Shot;

/* The first frame. */
void l1l2_shot_start(L1L2Shot *shot, const L1L2Thumbnail *thumbnail);

/* The next one. True where it belongs to another shot: its motion (or that of a frame a moment ago) could not be
 * measured, and it shows something that is unlike all that the shot has shown lately. While nothing is to be seen, no
 * other shot begins. */
bool l1l2_shot_push(L1L2Shot *shot, const L1L2Thumbnail *thumbnail, bool measured);

#endif
