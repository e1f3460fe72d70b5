/* SPDX-License-Identifier: MIT */
/*
 * The inner loops of Lucas-Kanade: a window of pixels, sampled between pixels by bilinear weights.
 *
 * Fixed point. The four weights have 14 fractional bits and sum to exactly 1. Sampled gray levels keep 5 fractional
 * bits, so they are at most 255 * 32 = 8160, and so is the size of a difference of two. Slopes are rounded to integers;
 * Scharr's filter has weights 3, 10, 3, so they are at most 16 * 255 = 4080 in size.
 *
 * Sums over the window are exact. A vector has four sums of 32 bits. A row of 16 words, 5 of them zero, adds at most
 * four products to each of them, so the window's 11 rows add 44: at most 44 * 8160 * 4080 = 1.46e9 < 2^31. The four are
 * added up in 64 bits.
 */
#ifndef L1L2_MOTION_LUCAS_KANADE_PATCH_H
#define L1L2_MOTION_LUCAS_KANADE_PATCH_H

#include "motion/lucas_kanade.h"

enum {
    L1L2_LK_WEIGHT_BITS = 14,
    L1L2_LK_GREY_SHIFT = L1L2_LK_WEIGHT_BITS - 5,
    L1L2_LK_GREY_ROUND = 1 << (L1L2_LK_GREY_SHIFT - 1),
    L1L2_LK_SLOPE_ROUND = 1 << (L1L2_LK_WEIGHT_BITS - 1)
};

#endif
