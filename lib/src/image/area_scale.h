/* SPDX-License-Identifier: MIT */
/*
 * Scales the first plane of a frame down to a small gray picture by area averaging: each output pixel is the mean of
 * the part of the source that it covers. Color components are mixed to gray with the weights of the format.
 *
 * Fixed point. A column's weighted sum is exact if it fits 15 bits. For bytes it does if an output covers at most 128
 * parts of the column (255 * 128 < 2^15), as with factors that are ratios of small numbers, such as 2, 3, 4/3 and 9/8.
 * Otherwise the sum is rounded to 15 bits at most. The sum across is exact for one component, and rounded to 8 bits
 * once, halves up. It fits 32 bits, since a column's sum and the sum of an output's weights are both below 2^15.
 */
#ifndef L1L2_IMAGE_AREA_SCALE_H
#define L1L2_IMAGE_AREA_SCALE_H

#include <stddef.h>
#include <stdint.h>

#include "image/format.h"
#include "image/level_range.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct L1L2AreaScaler L1L2AreaScaler;

/* From the first plane of frames of width x height pixels to out_width x out_height, which is 1 x 1 at least and not
 * larger than the frame. NULL: out of memory. */
L1L2AreaScaler *l1l2_image_scale_new(const L1L2FormatInfo *format, int width, int height, int out_width,
                                     int out_height);
void l1l2_image_scale_free(L1L2AreaScaler *s);

/* From now on the picture is stretched: the source's levels [low, high) become [0, 256) of the gray picture, and levels
 * beyond are clipped. A new scaler uses the full range. */
void l1l2_image_scale_set_levels(L1L2AreaScaler *s, L1L2Levels levels);

/* Writes the gray picture, 8 bits a pixel, to out. Strides are in bytes, of any sign and parity; data may have any
 * alignment, also where a component has two bytes. A scaler is used by one thread at a time. */
void l1l2_image_scale_run(L1L2AreaScaler *s, const uint8_t *data, ptrdiff_t stride, uint8_t *out, ptrdiff_t out_stride);

#ifdef __cplusplus
}
#endif

#endif
