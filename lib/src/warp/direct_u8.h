/* SPDX-License-Identifier: MIT */
/*
 * The warp's sample type of 8 bits where rows are no lines (warp_line.h), for maps that turn far or zoom out: weighs
 * the taps around given positions, sample by sample. Plain C: no picture that is steadied needs it.
 *
 * Fixed point, rows first. A row of taps sums to 8 + 14 bits and is cut to 6 fractional bits: with the overshoot of any
 * kernel here, below 1.3, that fits 16 bits. The column's sum has 20 fractional bits and is rounded once.
 */
#ifndef L1L2_WARP_DIRECT_U8_H
#define L1L2_WARP_DIRECT_U8_H

#include "warp/sample.h"

enum {
    L1L2_WARP_DIRECT_U8_ROW_SHIFT = L1L2_WARP_WEIGHT_BITS - 6,
    L1L2_WARP_DIRECT_U8_SHIFT = L1L2_WARP_WEIGHT_BITS + 6,
    /* One half of the result's unit, and one half of what a row's cut takes off: its mean. Flat stays flat. */
    L1L2_WARP_DIRECT_U8_ROUND = (1 << (L1L2_WARP_DIRECT_U8_SHIFT - 1)) + (1 << (L1L2_WARP_WEIGHT_BITS - 1))
};

/* For 1..4 interleaved components. */
L1L2WarpRun *l1l2_warp_direct_u8_run(int components);

#endif
