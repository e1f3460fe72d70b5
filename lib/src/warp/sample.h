/* SPDX-License-Identifier: MIT */
/* The warp's sample types share this: a plane to read, and a function that renders a run of samples out of it. */
#ifndef L1L2_WARP_SAMPLE_H
#define L1L2_WARP_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

#include "warp/kernel.h"

/* One body is compiled for every number of taps and components. These must be constants for the loops over them to
 * unroll, so all that the body calls is inlined into it. */
#if defined(__GNUC__)
#define SPECIALIZED static inline __attribute__((always_inline))
#else
#define SPECIALIZED static inline
#endif

typedef struct L1L2WarpPlane {
    const uint8_t *data;
    ptrdiff_t stride;   /* bytes */
    int width, height;  /* samples */
    int depth, shift;   /* of a component, bits: as in L1L2FormatInfo. 8-bit samples look at neither */
} L1L2WarpPlane;

/* Beyond the plane its edge is repeated. */
static inline int l1l2_warp_clamp(int index, int size)
{
    return index < 0 ? 0 : index < size ? index : size - 1;
}

/* Writes count samples of all their components to dst from positions x[], y[] (fixed point of warp_coords.h); taps
 * beyond the plane repeat its edge. */
typedef void L1L2WarpRun(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                         int count, uint8_t *dst);

#endif
