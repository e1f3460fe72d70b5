/* SPDX-License-Identifier: MIT */
/* For the implementations of warp_linear.h: samples in plain C, and one body for every number of components. */
#ifndef L1L2_WARP_BILINEAR_U8_IMPL_H
#define L1L2_WARP_BILINEAR_U8_IMPL_H

#include "warp/bilinear_u8.h"

/* Samples from .. to - 1 of a run, all of the k-th pieces. */
SPECIALIZED void linear_plain(const L1L2WarpPlane *src, const L1L2WarpScanline *line, int k, int from, int to,
                              uint8_t *dst, const int components)
{
    enum { TO_SHARE = 15 - L1L2_WARP_PHASE_BITS, ONE = 1 << L1L2_WARP_BILINEAR_BITS };
    for (int i = from; i < to; i++) {
        const int32_t x = l1l2_warp_piece_position(&line->along[k], i);
        const int32_t y = l1l2_warp_piece_position(&line->down[k], i);
        const int share_x = (x & (L1L2_WARP_PHASES - 1)) << TO_SHARE;
        const int share_y = (y & (L1L2_WARP_PHASES - 1)) << TO_SHARE;
        const int column = (x >> L1L2_WARP_PHASE_BITS) + line->first, row = y >> L1L2_WARP_PHASE_BITS;
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

/* Where the k-th piece of samples ends. */
static inline int end_of_samples(const L1L2WarpScanline *line, int k)
{
    return k + 1 < line->along_pieces ? line->along[k + 1].from : line->count;
}

#define DEFINE_LINEAR_RUN(components)                                                                                  \
    static void run_##components(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *line, \
                                 uint8_t *dst)                                                                         \
    {                                                                                                                  \
        run(src, line, dst, components);                                                                               \
    }

/* From run(src, line, dst, components) the function that looks its versions up. */
#define DEFINE_LINEAR_RUNS(name)                                                                                       \
    DEFINE_LINEAR_RUN(1)                                                                                               \
    DEFINE_LINEAR_RUN(2) DEFINE_LINEAR_RUN(3) DEFINE_LINEAR_RUN(4) L1L2WarpScanlineRun *name(int components)           \
    {                                                                                                                  \
        static L1L2WarpScanlineRun *const runs[] = {run_1, run_2, run_3, run_4};                                       \
        return runs[components - 1];                                                                                   \
    }

#endif
