/* SPDX-License-Identifier: MIT */
/*
 * Bilinear runs of 8-bit samples by lines. With two taps a second pass costs more than it saves: a sample's four are
 * weighed at once, and `down` of such a line has the rows of its samples, not of its columns.
 *
 * Fixed point: a row, a + (b - a) w, is rounded to 7 fractional bits, and so are two rows. Every implementation does
 * exactly this.
 */
#ifndef L1L2_WARP_BILINEAR_U8_H
#define L1L2_WARP_BILINEAR_U8_H

#include "warp/scanline_u8.h"

enum { L1L2_WARP_BILINEAR_BITS = 7, L1L2_WARP_BILINEAR_ROUND = 1 << (L1L2_WARP_BILINEAR_BITS - 1) };

/* For 1..4 interleaved components. Plain C. */
L1L2WarpScanlineRun *l1l2_warp_bilinear_run_plain(int components);

/* There only where the build defines L1L2_WARP_AVX2, and for processors that have it. */
L1L2WarpScanlineRun *l1l2_warp_bilinear_run_avx2(int components);

#endif
