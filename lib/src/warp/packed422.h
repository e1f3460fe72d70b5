/* SPDX-License-Identifier: MIT */
/*
 * Packed 4:2:2: the warp splits a frame into planes, renders these, and merges the result.
 *
 * A pair of pixels is four bytes in memory, two of luma and one of each chroma component. Luma and chroma have
 * different resolutions, so they are planes for the warp.
 */
#ifndef L1L2_WARP_PACKED422_H
#define L1L2_WARP_PACKED422_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/pool.h"
#include "image/format.h"

/* The planes of a frame. Rows of luma have room for whole pairs of pixels. */
typedef struct L1L2WarpPlanes {
    uint8_t *data[L1L2_MAX_PLANES];
    ptrdiff_t stride[L1L2_MAX_PLANES]; /* bytes */
    int width, height;                 /* of the frame, pixels */
} L1L2WarpPlanes;

bool l1l2_warp_packed422_is(const L1L2FormatInfo *format);

/* Planes in the layout of Y42B, with memory of their own. False when out of memory. */
bool l1l2_warp_packed422_new(L1L2WarpPlanes *planes, int width, int height);
void l1l2_warp_packed422_free(L1L2WarpPlanes *planes);

/* Both work row by row on the pool's threads. Rows have (width + 1) / 2 whole pairs. If the width is odd, the second
 * pixel of the last pair is not read, but is written, with any level. */
void l1l2_warp_packed422_split(L1L2Pool *pool, const L1L2FormatInfo *packed, const uint8_t *data, ptrdiff_t stride,
                               const L1L2WarpPlanes *planes);
void l1l2_warp_packed422_merge(L1L2Pool *pool, const L1L2FormatInfo *packed, const L1L2WarpPlanes *planes,
                               uint8_t *data, ptrdiff_t stride);

#endif
