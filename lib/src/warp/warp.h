/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 5: renders a frame through its update transform B_t and crops it.
 *
 * The warp is coordinate generator x kernel x sample type. A generator (coords.h) turns a map into source positions for
 * a run of output samples, or into the scanline that the run follows through the source. A kernel (kernel.h) has the
 * weights of the taps around a position. A sample type (functions.h) reads, weighs and writes samples.
 *
 * All planes follow one map, chroma in its own coordinates with its site. A sample position is inside the source if it
 * lies in the frame's rectangle; taps beyond the edge repeat the edge pixel. Levels end at the ends of the depth, not
 * of the limited range, as in other scalers: overshoot and the super-white of a camera use the headroom.
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

/* Output pixel -> source pixel, both with the origin at their frame's center. */
typedef struct L1L2WarpMap {
    L1L2Mat affine;           /* finite, last row 0 0 1; not used if there is a mesh */
    const L1L2WarpMesh *mesh; /* of the output's size; or NULL */
} L1L2WarpMap;

typedef struct L1L2WarpConfig {
    const L1L2FormatInfo *format;
    int in_width, in_height;   /* pixels */
    int out_width, out_height; /* pixels */
    L1L2StabChromaSite chroma_site;
    L1L2StabInterpolation interpolation;
    L1L2Pool *pool;            /* its threads do the work; must outlive the object. NULL: the caller's thread alone */
    bool plain;                /* for tests and benchmarks: plain C on any processor. The bytes are the same */
} L1L2WarpConfig;

/* On error *out is NULL: L1L2STAB_ERR_ARGUMENT without a format or with a size below 1, L1L2STAB_ERR_NOMEM. */
L1L2StabResult l1l2_warp_create(L1L2Warp **out, const L1L2WarpConfig *cfg);
void l1l2_warp_free(L1L2Warp *w);

/* Planes may have any alignment, strides (bytes) any sign and parity. src and dst must not overlap. The bytes do not
 * depend on the number of threads. */
void l1l2_warp_render(L1L2Warp *w, const L1L2WarpMap *map, const uint8_t *const src[4], const ptrdiff_t src_stride[4],
                      uint8_t *const dst[4], const ptrdiff_t dst_stride[4]);

/* A part of a frame: columns left .. right - 1 and rows top .. bottom - 1. */
typedef struct L1L2WarpRect {
    int left, top, right, bottom;
} L1L2WarpRect;

/* The samples of a plane that cover these pixels. */
L1L2WarpRect l1l2_warp_rect_samples(const L1L2WarpRect *pixels, int log2_sub_x, int log2_sub_y);

/* Parts of the output, in pixels within it, which do not overlap. */
enum { L1L2_WARP_MAX_PARTS = 4 };
typedef struct L1L2WarpParts {
    int count;
    L1L2WarpRect rect[L1L2_WARP_MAX_PARTS]; /* some may be empty */
} L1L2WarpParts;

/* The same for parts of the output. dst is the whole frame; what lies outside the parts is left as it is, but for
 * packed 4:2:2, where it is undefined. */
void l1l2_warp_render_parts(L1L2Warp *w, const L1L2WarpMap *map, const L1L2WarpParts *parts,
                            const uint8_t *const src[4], const ptrdiff_t src_stride[4], uint8_t *const dst[4],
                            const ptrdiff_t dst_stride[4]);

/* The instruction set of the inner loops on this processor: "avx2", or "none" for plain C. */
const char *l1l2_warp_simd(void);

#endif
