/* SPDX-License-Identifier: MIT */
/*
 * The warp's sample type of 9 to 16 bits in two bytes, the low one first. Fixed point, rows first, as warp_u8.h has it,
 * and again every implementation does exactly this:
 *
 * Narrow, to 12 bits: a row of taps sums to depth + 14 bits and is cut to 14 - depth fractional bits, so it fits 16
 * bits with its overshoot. The column's sum has 28 - depth and is rounded once.
 *
 * Wide, 16 bits: samples are taken less 2^15, so that they have a sign and fit. A row is cut to 7 fractional bits; its
 * upper part (unit 2) and its lower one (unit 1/128) are weighed by themselves, to 13 fractional bits together.
 *
 * The cuts cost a small part of a level: 1/16 of a 10-bit one at most, 1/5 of a 12-bit one, 1/50 of a 16-bit one.
 */
#ifndef L1L2_WARP_DIRECT_U16_H
#define L1L2_WARP_DIRECT_U16_H

#include "warp/sample.h"

enum {
    L1L2_WARP_DIRECT_U16_NARROW = 12, /* the largest depth */
    L1L2_WARP_DIRECT_U16_BIAS = 1 << 15,
    L1L2_WARP_DIRECT_U16_ROW_SHIFT = L1L2_WARP_WEIGHT_BITS - 7,
    L1L2_WARP_DIRECT_U16_PART_BITS = 8, /* of a wide row, the lower part */
    L1L2_WARP_DIRECT_U16_SHIFT = L1L2_WARP_WEIGHT_BITS - 1,
    /* One half of the result's unit, and one half of what a row's cut takes off. */
    L1L2_WARP_DIRECT_U16_ROUND = (1 << (L1L2_WARP_DIRECT_U16_SHIFT - 1)) + (1 << (L1L2_WARP_DIRECT_U16_SHIFT - 8))
};

/* The same for narrow samples of that depth. */
static inline int l1l2_warp_direct_u16_narrow_shift(int depth)
{
    return 2 * L1L2_WARP_WEIGHT_BITS - depth;
}

static inline int l1l2_warp_direct_u16_narrow_round(int depth)
{
    return (1 << (l1l2_warp_direct_u16_narrow_shift(depth) - 1)) + (1 << (L1L2_WARP_WEIGHT_BITS - 1));
}

/* For a kernel of 2, 4 or 6 taps, 1, 2 or 4 interleaved components and a depth of 9..12 or 16 bits: the fastest that
 * this processor has. */
L1L2WarpRun *l1l2_warp_direct_u16_run(int taps, int components, int depth);

/* Plain C, for every processor. */
L1L2WarpRun *l1l2_warp_direct_u16_run_plain(int taps, int components, int depth);

/* There only where the build defines L1L2_WARP_AVX2, and for processors that have it. */
L1L2WarpRun *l1l2_warp_direct_u16_run_avx2(int taps, int components, int depth);

#endif
