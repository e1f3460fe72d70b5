/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 5: render a frame through the map of its update transform.
 *
 * Built as coordinate generator x kernel x sample type: a generator turns a map into source positions for a run of
 * output samples, or into the line that the run takes through the source; a kernel weighs the taps around each
 * position, a sample type reads and writes them.
 * All planes follow one map, chroma in its own coordinates with its siting.
 * "Inside the source": a sample position that lies in the frame's rectangle; taps beyond the edge repeat the edge.
 * Levels are cut off at the ends of the depth, not of a limited range, as other scalers do: overshoot and a camera's
 * super-white have their headroom.
 */
#ifndef L1L2_WARP_WARP_H
#define L1L2_WARP_WARP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/geom.h"
#include "common/pool.h"
#include "image/format.h"
#include "warp/mesh.h"

typedef struct L1L2Warp L1L2Warp;

/* Output pixel -> source pixel, both with the origin at their picture's centre. */
typedef struct L1L2WarpMap {
    L1L2Mat affine;           /* finite, last row 0 0 1; not looked at where there is a mesh */
    const L1L2WarpMesh *mesh; /* of the output's size; or NULL */
} L1L2WarpMap;

typedef struct L1L2WarpConfig {
    const L1L2FormatInfo *format;
    int in_width, in_height;   /* pixels */
    int out_width, out_height; /* pixels */
    L1L2StabChromaSite chroma_site;
    L1L2StabInterpolation interpolation;
    L1L2Pool *pool;            /* whose threads work; must outlive the object. NULL: the caller's thread alone */
    bool plain;                /* for tests and benchmarks: plain C, whatever the processor has. The same bytes */
} L1L2WarpConfig;

/* On error *out is NULL. */
L1L2StabResult l1l2_warp_create(L1L2Warp **out, const L1L2WarpConfig *cfg);
void l1l2_warp_free(L1L2Warp *w);

/* src and dst must not overlap. The same input gives the same bytes whatever the number of threads. */
void l1l2_warp_render(L1L2Warp *w, const L1L2WarpMap *map, const uint8_t *const src[4], const ptrdiff_t src_stride[4],
                      uint8_t *const dst[4], const ptrdiff_t dst_stride[4]);

/* The instruction set of the inner loops. */
const char *l1l2_warp_simd(void);

#endif
