/* SPDX-License-Identifier: MIT */
/*
 * Pictures made smaller by area: each grey output pixel is the mean of the part of the source that it covers. A leaf.
 *
 * Fixed point. A column's weighted sum is exact as long as it fits 15 bits, which it does for bytes by any factor of
 * few parts (2, 3, 4/3, 9/8); else it is rounded to 14 bits or more. The sum across is exact for one component and
 * rounded once, halves up.
 */
#ifndef L1L2_IMAGE_AREA_SCALE_H
#define L1L2_IMAGE_AREA_SCALE_H

#include <stddef.h>
#include <stdint.h>

#include "image/format.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct L1L2AreaScaler L1L2AreaScaler;

/* From the first plane of frames of width x height pixels to out_width x out_height, 1 to as many. NULL: no memory. */
L1L2AreaScaler *l1l2_image_scale_new(const L1L2FormatInfo *format, int width, int height, int out_width,
                                     int out_height);
void l1l2_image_scale_free(L1L2AreaScaler *s);

/* Components of more than 8 bits become 8. Strides in bytes, of any sign; a scaler is used by one thread at a time. */
void l1l2_image_scale_run(L1L2AreaScaler *s, const uint8_t *data, ptrdiff_t stride, uint8_t *out, ptrdiff_t out_stride);

#ifdef __cplusplus
}
#endif

#endif
