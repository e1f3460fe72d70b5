/* SPDX-License-Identifier: MIT */
/* For the implementations of scanline_u8.h: the two passes in plain C, which SIMD code uses at the edges of a plane;
 * and the macro that compiles one body for every number of taps and components. */
#ifndef L1L2_WARP_SCANLINE_U8_IMPL_H
#define L1L2_WARP_SCANLINE_U8_IMPL_H

#include "warp/functions.h"

enum { SCANLINE_VALUES = 4 * L1L2_WARP_SCANLINE_COLUMNS + 16 /* room for a last vector */ };

/* What differs between the compiled runs. It is a constant in each of them, so loops over it unroll. */
typedef struct Shape {
    int taps, components;
} Shape;

/* Entries from .. to - 1 of a piece: columns of the pass down, samples of the pass along. */
typedef struct Entries {
    const L1L2WarpPiece *piece;
    int from, to;
} Entries;

/* The pass down. */
L1L2_INLINE void down_plain(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int first_column, Entries columns,
                            int16_t *values, const Shape shape)
{
    const int taps = shape.taps, components = shape.components;
    for (int i = columns.from; i < columns.to; i++) {
        const int32_t y = l1l2_warp_piece_position(columns.piece, i);
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

/* The pass along. */
L1L2_INLINE void along_plain(const L1L2WarpKernel *kernel, Entries samples, const int16_t *values, uint8_t *dst,
                             const Shape shape)
{
    const int taps = shape.taps, components = shape.components;
    for (int i = samples.from; i < samples.to; i++) {
        const int32_t x = l1l2_warp_piece_position(samples.piece, i);
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

/* The entry at which the k-th piece ends. end: where the last one does. */
static inline int end_of(const L1L2WarpPiece *piece, int k, int pieces, int end)
{
    return k + 1 < pieces ? piece[k + 1].from : end;
}

#define DEFINE_RUN(taps, components)                                                                                  \
    static void run_##taps##_##components(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel,                     \
                                          const L1L2WarpScanline *scanline, uint8_t *dst)                             \
    {                                                                                                                 \
        run(src, kernel, scanline, dst, (Shape){taps, components});                                                   \
    }
#define DEFINE_RUNS_OF(taps) DEFINE_RUN(taps, 1) DEFINE_RUN(taps, 2) DEFINE_RUN(taps, 3) DEFINE_RUN(taps, 4)
#define SET_RUNS(runs, taps)                                                                                          \
    runs[taps / 2 - 2][0] = run_##taps##_1, runs[taps / 2 - 2][1] = run_##taps##_2,                                   \
                       runs[taps / 2 - 2][2] = run_##taps##_3, runs[taps / 2 - 2][3] = run_##taps##_4

/* Compiles run(src, kernel, scanline, dst, shape) for each shape, and defines the function init() that puts these eight
 * into the table. */
#define DEFINE_RUNS(init)                                                                                             \
    DEFINE_RUNS_OF(4)                                                                                                 \
    DEFINE_RUNS_OF(6)                                                                                                 \
    void init(L1L2WarpFunctions *functions)                                                                           \
    {                                                                                                                 \
        SET_RUNS(functions->scanline_u8, 4);                                                                          \
        SET_RUNS(functions->scanline_u8, 6);                                                                          \
    }

#endif
