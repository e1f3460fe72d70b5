/* SPDX-License-Identifier: MIT */
/*
 * Renders runs of 8-bit samples by the lines that they take through the source (warp_coords.h), in two passes: down
 * each column to the value where the line crosses it, then along the line. Catmull and Smith, "3-D transformations of
 * images in scanline order" (1980), without their intermediate picture, and so without what it loses. A sample takes
 * 2 x taps products in place of taps x taps, and half of them read what lies side by side. The kernel is as if sheared
 * along the line.
 *
 * Fixed point. Down: the sum over the taps of (sample - 128) * weight, each rounded to 7 fractional bits; with the
 * overshoot of any kernel here, below 1.6 times 128, that fits 16 bits. Along: sums of 21 fractional bits, rounded
 * once. Every implementation does exactly this, so all give the same bytes.
 */
#ifndef L1L2_WARP_SCANLINE_U8_H
#define L1L2_WARP_SCANLINE_U8_H

#include "warp/sample.h"

enum {
    L1L2_WARP_SCANLINE_SHIFT = 7 + L1L2_WARP_WEIGHT_BITS,
    L1L2_WARP_SCANLINE_ROUND =
        (128 << L1L2_WARP_SCANLINE_SHIFT) + (1 << (L1L2_WARP_SCANLINE_SHIFT - 1)) /* 128 is put back */
};

/* Writes line->count samples of all their components to dst; taps beyond the plane repeat its edge. */
typedef void L1L2WarpScanlineRun(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *line,
                             uint8_t *dst);

/* For a kernel of 2, 4 or 6 taps and 1..4 interleaved components: the fastest that this processor has. */
L1L2WarpScanlineRun *l1l2_warp_scanline_run(int taps, int components);

/* Plain C, for every processor. */
L1L2WarpScanlineRun *l1l2_warp_scanline_run_plain(int taps, int components);

/* There only where the build defines L1L2_WARP_AVX2, and for processors that have it. */
L1L2WarpScanlineRun *l1l2_warp_scanline_run_avx2(int taps, int components);

#endif
