/* SPDX-License-Identifier: MIT */
/*
 * Motion from whole pictures, for frames whose tracks do not yield it: motion blur, low contrast, dense overlays.
 *
 * The current picture is aligned with the previous one (direct_alignment.h). The object keeps two pictures, and
 * prepares them only when they are needed. Unit of motions: the frame's diagonal.
 */
#ifndef L1L2_MOTION_WHOLE_PICTURE_H
#define L1L2_MOTION_WHOLE_PICTURE_H

#include <stdbool.h>

#include "motion/direct_alignment.h"

typedef struct L1L2WholePicture L1L2WholePicture;

/* A gray picture of the size given at creation. stride: bytes. */
typedef struct L1L2GrayPicture {
    const uint8_t *data;
    ptrdiff_t stride;
} L1L2GrayPicture;

/* width, height: of the gray pictures; frame_width, frame_height: of the frames that they show, any unit in which
 * pixels are square. False when out of memory. *out is NULL then, and for pictures too small to be aligned; the
 * functions below take NULL. */
bool l1l2_motion_whole_picture_create(L1L2WholePicture **out, int width, int height, double frame_width,
                                      double frame_height);
void l1l2_motion_whole_picture_free(L1L2WholePicture *w);

/* Forgets all pictures: the next frame is the first. */
void l1l2_motion_whole_picture_reset(L1L2WholePicture *w);

/* A new frame: `previous` and `current` stay valid and unchanged until the next call. */
void l1l2_motion_whole_picture_advance(L1L2WholePicture *w, L1L2GrayPicture previous, L1L2GrayPicture current);

/* F of the current frame to the previous one. expected: the motion of the frame before; tracks: what tracks measured,
 * or NULL; trust: how much each cell counts, as in L1L2AlignmentGuide. *out is written in any case; start_residual[1]
 * is that of the tracks' motion. True if the evidence is that of a right motion. */
bool l1l2_motion_whole_picture_align(L1L2WholePicture *w, const L1L2Mat *expected, const L1L2Mat *tracks,
                                     const float trust[L1L2_ALIGN_CELLS], L1L2Alignment *out);

#endif
