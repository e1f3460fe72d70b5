/* SPDX-License-Identifier: MIT */
/* For the implementations of bilinear_u8.h: samples in plain C, which SIMD code uses at the edges of a plane; and the
 * macro that compiles one body for every number of components. */
#ifndef L1L2_WARP_BILINEAR_U8_IMPL_H
#define L1L2_WARP_BILINEAR_U8_IMPL_H

#include "warp/bilinear_u8.h"
#include "warp/functions.h"

/* Samples from .. to - 1 of a run, all of the scanline's k-th pieces. */
typedef struct Samples {
    const L1L2WarpScanline *scanline;
    int k, from, to;
} Samples;

L1L2_INLINE void bilinear_plain(const L1L2WarpPlane *src, const Samples *samples, uint8_t *dst, const int components)
{
    const L1L2WarpScanline *scanline = samples->scanline;
    const L1L2WarpPiece *along = &scanline->along[samples->k], *down = &scanline->down[samples->k];
    enum { TO_SHARE = 15 - L1L2_WARP_PHASE_BITS, ONE = 1 << L1L2_WARP_BILINEAR_BITS };
    for (int i = samples->from; i < samples->to; i++) {
        const int32_t x = l1l2_warp_piece_position(along, i);
        const int32_t y = l1l2_warp_piece_position(down, i);
        const int share_x = (x & (L1L2_WARP_PHASES - 1)) << TO_SHARE;
        const int share_y = (y & (L1L2_WARP_PHASES - 1)) << TO_SHARE;
        const int column = (x >> L1L2_WARP_PHASE_BITS) + scanline->first, row = y >> L1L2_WARP_PHASE_BITS;
        const ptrdiff_t left = (ptrdiff_t)l1l2_warp_clamp(column, src->width) * components;
        const ptrdiff_t right = (ptrdiff_t)l1l2_warp_clamp(column + 1, src->width) * components;
        for (int c = 0; c < components; c++) {
            int rows[2];
            for (int r = 0; r < 2; r++) {
                const uint8_t *at = src->data + l1l2_warp_clamp(row + r, src->height) * src->stride + c;
                rows[r] = at[left] * ONE + l1l2_warp_product((at[right] - at[left]) * ONE, share_x);
            }
            const int value = rows[0] + l1l2_warp_product(rows[1] - rows[0], share_y);
            dst[i * components + c] = (uint8_t)((value + L1L2_WARP_BILINEAR_ROUND) >> L1L2_WARP_BILINEAR_BITS);
        }
    }
}

/* The sample at which the k-th piece ends. */
static inline int end_of_samples(const L1L2WarpScanline *scanline, int k)
{
    return k + 1 < scanline->along_pieces ? scanline->along[k + 1].from : scanline->count;
}

#define DEFINE_BILINEAR_RUN(components)                                                                               \
    static void run_##components(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel,                              \
                                 const L1L2WarpScanline *scanline, uint8_t *dst)                                      \
    {                                                                                                                 \
        (void)kernel;                                                                                                 \
        run(src, scanline, dst, components);                                                                          \
    }

/* Compiles run(src, scanline, dst, components) for each number of components, and defines the function init() that puts
 * these four into the table. */
#define DEFINE_BILINEAR_RUNS(init)                                                                                    \
    DEFINE_BILINEAR_RUN(1)                                                                                            \
    DEFINE_BILINEAR_RUN(2)                                                                                            \
    DEFINE_BILINEAR_RUN(3)                                                                                            \
    DEFINE_BILINEAR_RUN(4)                                                                                            \
    void init(L1L2WarpFunctions *functions)                                                                           \
    {                                                                                                                 \
        functions->bilinear_u8[0] = run_1, functions->bilinear_u8[1] = run_2;                                         \
        functions->bilinear_u8[2] = run_3, functions->bilinear_u8[3] = run_4;                                         \
    }

#endif
