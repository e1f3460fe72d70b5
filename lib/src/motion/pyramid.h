/* SPDX-License-Identifier: MIT */
/*
 * Gaussian image pyramid with the slopes that Lucas-Kanade needs (Burt & Adelson, "The Laplacian pyramid as a compact
 * image code", 1983; slopes by Scharr's 3x3 kernel).
 *
 * Each level is half the size of the one below it, rounded up. A level is stored with a border of L1L2_LK_BORDER_X by
 * L1L2_LK_BORDER_Y pixels: the picture is mirrored about its edge pixels there, and slopes are 0. The arithmetic is
 * exact in integers. All memory is allocated at creation, so building cannot fail; it uses no other thread.
 */
#ifndef L1L2_MOTION_PYRAMID_H
#define L1L2_MOTION_PYRAMID_H

#include "motion/lucas_kanade.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The picture itself and four halvings: at 640 px, points are followed over 80 px a frame. One level less loses half of
 * the points at 40 px a frame, and each level costs a third of the one below it at most. */
enum { L1L2_PYRAMID_MAX_LEVELS = 5 };

typedef struct L1L2Pyramid {
    int levels; /* fewer than L1L2_PYRAMID_MAX_LEVELS for pictures that a border would outgrow */
    L1L2LkLevel level[L1L2_PYRAMID_MAX_LEVELS]; /* [0] is the picture itself */
    uint8_t *grey[L1L2_PYRAMID_MAX_LEVELS];     /* the levels' pixels (0, 0), to be written to */
    int16_t *slope[L1L2_PYRAMID_MAX_LEVELS];    /* the levels' slopes, to be written to */
    void *memory;
} L1L2Pyramid;

/* For pictures of width x height pixels, 1 or more each. NULL: out of memory. */
L1L2Pyramid *l1l2_motion_pyramid_new(int width, int height);
void l1l2_motion_pyramid_free(L1L2Pyramid *p);

/* Builds the borders, the higher levels and all slopes from the pixels of grey[0], rows level[0].stride apart. */
void l1l2_motion_pyramid_build(L1L2Pyramid *p);

#ifdef __cplusplus
}
#endif

#endif
