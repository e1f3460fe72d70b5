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

/* Both show something, and not the same. */
bool l1l2_thumbnails_differ(const L1L2Thumbnail *a, const L1L2Thumbnail *b);

#endif
