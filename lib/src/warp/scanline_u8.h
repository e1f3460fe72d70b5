/* SPDX-License-Identifier: MIT */
/*
 * Renders runs of 8-bit samples along the scanlines that they follow through the source (coords.h), in two passes: down
 * each source column to the value where the scanline crosses it, then along the scanline.
 *
 * Source: Catmull and Smith, "3-D transformations of images in scanline order", 1980. The paper has an intermediate
 * picture. Here each output row has an intermediate row of its own, so no detail is lost where the paper's picture
 * shrinks. A sample takes 2 * taps products in place of taps * taps, and half of them read neighbors in memory. The
 * kernel is sheared along the scanline.
 *
 * Fixed point. G is the largest sum of a kernel's |weights|, 1.55 for Lanczos, 1.375 for bicubic.
 *
 *   down   sum of (sample - 128) * weight, each product rounded to 7 fractional bits.
 *          |sum| <= 128 * 2^7 * G + taps / 2 <= 25399: it fits 16 bits.
 *   along  sum of value * weight, 7 + 14 = 21 fractional bits, rounded once, after 128 is added again.
 *          |sum| <= 25399 * 2^14 * G + 2^28 + 2^20 < 0.92e9: it fits 32 bits.
 *
 * Rounding the products costs at most taps / 256 of a level for each column, taps * G / 256 in all: 0.04. Every
 * implementation does exactly this, so all give the same bytes.
 */
#ifndef L1L2_WARP_SCANLINE_U8_H
#define L1L2_WARP_SCANLINE_U8_H

#include "warp/sample.h"

enum {
    L1L2_WARP_SCANLINE_SHIFT = 7 + L1L2_WARP_WEIGHT_BITS,
    L1L2_WARP_SCANLINE_ROUND = (128 << L1L2_WARP_SCANLINE_SHIFT) + (1 << (L1L2_WARP_SCANLINE_SHIFT - 1))
};

/* Writes scanline->count samples with all their components to dst. Taps beyond the plane repeat its edge. */
typedef void L1L2WarpScanlineRun(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel,
                                 const L1L2WarpScanline *scanline, uint8_t *dst);

#endif
