/* SPDX-License-Identifier: MIT */
/* For the implementations of warp_line.h: the passes in plain C; one body for every number of taps and components. */
#ifndef L1L2_WARP_SCANLINE_U8_IMPL_H
#define L1L2_WARP_SCANLINE_U8_IMPL_H

#include "warp/scanline_u8.h"

enum { LINE_VALUES = 4 * L1L2_WARP_SCANLINE_COLUMNS + 16 /* what is written together may overrun them */ };

/* Columns from .. to - 1 of a line, all of this piece. */
SPECIALIZED void down_plain(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int first_column,
                            const L1L2WarpPiece *piece, int from, int to, int16_t *values, const int taps,
                            const int components)
{
    for (int i = from; i < to; i++) {
        const int32_t y = l1l2_warp_piece_position(piece, i);
        const int16_t *weight = kernel->weights + (y & (L1L2_WARP_PHASES - 1)) * l1l2_warp_kernel_stride(taps);
        const int first = (y >> L1L2_WARP_PHASE_BITS) - (taps / 2 - 1);
        const uint8_t *column = src->data + (ptrdiff_t)l1l2_warp_clamp(first_column + i, src->width) * components;
        int sum[4] = {0};
        for (int r = 0; r < taps; r++) {
            const uint8_t *sample = column + l1l2_warp_clamp(first + r, src->height) * src->stride;
            for (int c = 0; c < components; c++)
                sum[c] += l1l2_warp_product((sample[c] - 128) * 256, weight[r]);
        }
        for (int c = 0; c < components; c++)
            values[i * components + c] = (int16_t)sum[c];
    }
}

/* Samples from .. to - 1 of a run, all of this piece. */
SPECIALIZED void along_plain(const L1L2WarpKernel *kernel, const L1L2WarpPiece *piece, int from, int to,
                             const int16_t *values, uint8_t *dst, const int taps, const int components)
{
    for (int i = from; i < to; i++) {
        const int32_t x = l1l2_warp_piece_position(piece, i);
        const int16_t *weight = kernel->weights + (x & (L1L2_WARP_PHASES - 1)) * l1l2_warp_kernel_stride(taps);
        const int16_t *first = values + ((x >> L1L2_WARP_PHASE_BITS) - (taps / 2 - 1)) * components;
        for (int c = 0; c < components; c++) {
            int sum = L1L2_WARP_SCANLINE_ROUND;
            for (int k = 0; k < taps; k++)
                sum += first[k * components + c] * weight[k];
            sum >>= L1L2_WARP_SCANLINE_SHIFT;
            dst[i * components + c] = (uint8_t)(sum < 0 ? 0 : sum > 255 ? 255 : sum);
        }
    }
}

/* Where the k-th of some pieces ends. */
static inline int end_of(const L1L2WarpPiece *piece, int k, int pieces, int end)
{
    return k + 1 < pieces ? piece[k + 1].from : end;
}

#define DEFINE_RUN(taps, components)                                                                                   \
    static void run_##taps##_##components(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel,                      \
                                          const L1L2WarpScanline *line, uint8_t *dst)                                  \
    {                                                                                                                  \
        run(src, kernel, line, dst, taps, components);                                                                 \
    }
#define DEFINE_RUNS_OF(taps) DEFINE_RUN(taps, 1) DEFINE_RUN(taps, 2) DEFINE_RUN(taps, 3) DEFINE_RUN(taps, 4)
#define RUNS_OF(taps) {run_##taps##_1, run_##taps##_2, run_##taps##_3, run_##taps##_4}

/* From run(src, kernel, line, dst, taps, components) and what two taps have of their own, the function that looks its
 * twelve versions up. */
#define DEFINE_RUNS(name, linear)                                                                                      \
    DEFINE_RUNS_OF(4)                                                                                                  \
    DEFINE_RUNS_OF(6)                                                                                                  \
    L1L2WarpScanlineRun *name(int taps, int components)                                                                \
    {                                                                                                                  \
        static L1L2WarpScanlineRun *const runs[2][4] = {RUNS_OF(4), RUNS_OF(6)};                                       \
        return taps == 2 ? linear(components) : runs[taps / 2 - 2][components - 1];                                    \
    }

#endif
