/* SPDX-License-Identifier: MIT */
/*
 * What the warp's sample types share: a plane to read, and the type of a function that renders a run of samples from
 * it.
 *
 * Samples are read and written byte by byte, or by instructions that accept any alignment. So planes and rows may begin
 * at any address. A right shift of a negative number is assumed to be arithmetic, as it is with all compilers in use.
 */
#ifndef L1L2_WARP_SAMPLE_H
#define L1L2_WARP_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

#include "common/compiler.h"
#include "warp/kernel.h"

typedef struct L1L2WarpPlane {
    const uint8_t *data;
    ptrdiff_t stride;   /* bytes, of any sign */
    int width, height;  /* samples, each >= 1 */
    int depth, shift;   /* of a component, bits: as in L1L2FormatInfo. Not used for 8-bit samples */
} L1L2WarpPlane;

/* The nearest index of a plane's sample: taps beyond the plane repeat its edge. */
static inline int l1l2_warp_clamp(int index, int size)
{
    return index < 0 ? 0 : index < size ? index : size - 1;
}

/* Renders samples one by one: writes count samples with all their components to dst, from positions x[], y[] in the
 * fixed point of coords.h. Taps beyond the plane repeat its edge. */
typedef void L1L2WarpDirectRun(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x,
                               const int32_t *y, int count, uint8_t *dst);

#endif
