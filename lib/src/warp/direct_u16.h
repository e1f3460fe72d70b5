/* SPDX-License-Identifier: MIT */
/*
 * The sample type of 9 to 16 bits in two bytes, the low byte first: weighs the taps around given positions, sample by
 * sample.
 *
 * Fixed point, along the rows first. The positive weights of a kernel sum to at most 1.275 (Lanczos), the |weights| to
 * G = 1.55. Every implementation does exactly this, so all give the same bytes.
 *
 * Narrow, depth up to 12 bits. A row of taps sums to depth + 14 bits. It is cut to 14 - depth fractional bits, so it is
 * below 2^14 * 1.275 = 20890 and fits 16 bits. The column's sum has 14 - depth + 14 = 28 - depth fractional bits, stays
 * below 20890 * 2^14 * G = 0.54e9, and is rounded once.
 *
 * Wide, depth 16 bits. 2^15 is subtracted from samples, so that they fit 16 bits with a sign. A row's sum is below
 * 2^15 * 2^14 * G = 0.84e9. It is cut to 7 fractional bits, 24 bits with the sign, and taken apart: the upper part has
 * the unit 2 and is below 2^15 * G / 2 = 25396 in size, the lower part has 8 bits of the unit 1/128. The parts are
 * weighed separately and added with 13 fractional bits: below 25396 * 2^14 * G = 0.65e9.
 *
 * What the cuts cost at most: 1/16 of a level of 10 bits, 1/5 of one of 12 bits, 1/50 of one of 16 bits.
 */
#ifndef L1L2_WARP_DIRECT_U16_H
#define L1L2_WARP_DIRECT_U16_H

#include "warp/sample.h"

enum {
    L1L2_WARP_DIRECT_U16_NARROW = 12, /* the largest narrow depth */
    L1L2_WARP_DIRECT_U16_BIAS = 1 << 15,
    L1L2_WARP_DIRECT_U16_ROW_SHIFT = L1L2_WARP_WEIGHT_BITS - 7,
    L1L2_WARP_DIRECT_U16_PART_BITS = 8, /* of a wide row's lower part */
    L1L2_WARP_DIRECT_U16_SHIFT = L1L2_WARP_WEIGHT_BITS - 1,
    /* One half of the result's unit; and one half of a row's unit, which is what a cut takes off in the mean. */
    L1L2_WARP_DIRECT_U16_ROUND = (1 << (L1L2_WARP_DIRECT_U16_SHIFT - 1)) + (1 << (L1L2_WARP_DIRECT_U16_SHIFT - 8))
};

/* The same two numbers for narrow samples. */
static inline int l1l2_warp_direct_u16_narrow_shift(int depth)
{
    return 2 * L1L2_WARP_WEIGHT_BITS - depth;
}

static inline int l1l2_warp_direct_u16_narrow_round(int depth)
{
    return (1 << (l1l2_warp_direct_u16_narrow_shift(depth) - 1)) + (1 << (L1L2_WARP_WEIGHT_BITS - 1));
}

typedef struct L1L2WarpDirectU16Runs {
    L1L2WarpDirectRun *run[2][3][3]; /* [0 narrow, 1 wide][taps / 2 - 1][components / 2]: 1, 2 or 4 components */
} L1L2WarpDirectU16Runs;

/* In plain C. SIMD code uses them at the edges of a plane. */
extern const L1L2WarpDirectU16Runs l1l2_warp_direct_u16_plain;

#endif
