/* SPDX-License-Identifier: MIT */
/*
 * Renders bilinear runs of 8-bit samples along scanlines. With two taps a second pass costs more than it saves: the
 * four pixels around a sample are weighed at once. So `down` of such a scanline has the rows of its samples, not of its
 * columns.
 *
 * Fixed point. a and b are the two levels of a row, with 7 fractional bits: at most 255 * 2^7 = 32640. The row's value
 * a + (b - a) * w, rounded to 7 fractional bits, lies between a and b, since 0 <= w < 1; so does the value between two
 * rows. All fits 16 bits. Rounded three times, a sample is off by at most 1/2 + 2/256 of a level. Every implementation
 * does exactly this, so all give the same bytes.
 */
#ifndef L1L2_WARP_BILINEAR_U8_H
#define L1L2_WARP_BILINEAR_U8_H

enum { L1L2_WARP_BILINEAR_BITS = 7, L1L2_WARP_BILINEAR_ROUND = 1 << (L1L2_WARP_BILINEAR_BITS - 1) };

#endif
