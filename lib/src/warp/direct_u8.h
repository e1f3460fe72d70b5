/* SPDX-License-Identifier: MIT */
/*
 * The sample type of 8 bits for maps that turn far or zoom out, so that rows are not scanlines (coords.h): weighs the
 * taps around given positions, sample by sample. Plain C alone: stabilization does not make such maps.
 *
 * Fixed point, along the rows first. A row of taps sums to 8 + 14 bits and is cut to 6 fractional bits. The positive
 * weights of a kernel sum to at most 1.275 and the negative ones to -0.275 (Lanczos), so a cut row lies in -4488 ..
 * 20808 and fits 16 bits. The column's sum has 6 + 14 = 20 fractional bits and stays below 20808 * 1.55 * 2^14 + 2^20 =
 * 0.53e9. It is rounded once.
 */
#ifndef L1L2_WARP_DIRECT_U8_H
#define L1L2_WARP_DIRECT_U8_H

#include "warp/sample.h"

enum {
    L1L2_WARP_DIRECT_U8_ROW_SHIFT = L1L2_WARP_WEIGHT_BITS - 6,
    L1L2_WARP_DIRECT_U8_SHIFT = L1L2_WARP_WEIGHT_BITS + 6,
    /* One half of the result's unit; and one half of a row's unit, which is what a cut takes off in the mean. */
    L1L2_WARP_DIRECT_U8_ROUND = (1 << (L1L2_WARP_DIRECT_U8_SHIFT - 1)) + (1 << (L1L2_WARP_WEIGHT_BITS - 1))
};

#endif
