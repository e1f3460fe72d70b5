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
#include "motion/vision.h"

typedef struct L1L2WholePicture L1L2WholePicture;

/* Of the current picture, or the previous one, what l1l2_motion_whole_picture_advance() is given: the picture, and the
 * level of its pyramid at which motions are checked. */
enum { L1L2_WHOLE_PICTURE_FULL, L1L2_WHOLE_PICTURE_SMALL, L1L2_WHOLE_PICTURE_SIZES };

/* size: the pictures' (data is not read). frame_width, frame_height: of the frames that they show, any unit in which
 * pixels are square. False when out of memory. *out is NULL then, and for pictures too small to be aligned; the
 * functions below take NULL. */
bool l1l2_motion_whole_picture_create(L1L2WholePicture **out, const L1L2GrayPicture size[L1L2_WHOLE_PICTURE_SIZES],
                                      double frame_width, double frame_height);
void l1l2_motion_whole_picture_free(L1L2WholePicture *w);

/* Forgets all pictures: the next frame is the first. */
void l1l2_motion_whole_picture_reset(L1L2WholePicture *w);

/* A new frame. The pictures stay valid and unchanged until the next call. */
void l1l2_motion_whole_picture_advance(L1L2WholePicture *w, const L1L2GrayPicture previous[L1L2_WHOLE_PICTURE_SIZES],
                                       const L1L2GrayPicture current[L1L2_WHOLE_PICTURE_SIZES]);

/* What whole pictures say of a motion of the current frame that was measured otherwise. It is done on small pictures:
 * cheap enough for every frame. Masked places do not count. */
void l1l2_motion_whole_picture_check(L1L2WholePicture *w, const L1L2Mat *F, const L1L2Mat *expected,
                                     L1L2Mask mask, L1L2AlignmentCheck *out);

/* F of the current frame to the previous one. *out is written in any case. True if the evidence is that of a right
 * motion. */
bool l1l2_motion_whole_picture_align(L1L2WholePicture *w, const L1L2AlignmentGuide *guide, L1L2Alignment *out);

/* Keeps the previous picture as the reference. */
void l1l2_motion_whole_picture_keep(L1L2WholePicture *w);

/* The same between the current picture and the reference, which was kept. */
bool l1l2_motion_whole_picture_bridge(L1L2WholePicture *w, const L1L2AlignmentGuide *guide, L1L2Alignment *out);

/* True if the current picture is about as sharp as the reference. */
bool l1l2_motion_whole_picture_is_sharp(L1L2WholePicture *w);

#endif
