/* SPDX-License-Identifier: MIT */
/* Plain C. Right shifts of negative numbers are taken to be arithmetic, as all compilers in use have it. */
#include "warp_u8.h"

#include <stdbool.h>

#include "warp_u8_impl.h"

static inline uint8_t clamp_u8(int value)
{
    return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

static inline int clamp_index(int index, int size)
{
    return index < 0 ? 0 : index < size ? index : size - 1;
}

/* w: weight of b. */
static inline int lerp(int a, int b, int w)
{
    return a + (((b - a) * w + (L1L2_WARP_ONE >> 1)) >> L1L2_WARP_WEIGHT_BITS);
}

/* Four bytes as warp_u8.h has it for two taps. */
static inline uint8_t lerp_u8(const uint8_t *const *row, ptrdiff_t left, ptrdiff_t right, int wx, int wy)
{
    const int one = 1 << L1L2_WARP_U8_LINEAR_BITS;
    const int upper = lerp(row[0][left] * one, row[0][right] * one, wx);
    const int lower = lerp(row[1][left] * one, row[1][right] * one, wx);
    return (uint8_t)((lerp(upper, lower, wy) + L1L2_WARP_U8_LINEAR_ROUND) >> L1L2_WARP_U8_LINEAR_BITS);
}

/* One sample. row[r]: row r of the taps; col[k]: bytes to tap k in it. */
SPECIALIZED void weigh(const uint8_t *const *row, const ptrdiff_t *col, const int16_t *wx, const int16_t *wy,
                       uint8_t *dst, const int taps, const int components)
{
    for (int c = 0; c < components; c++) {
        if (taps == 2) {
            dst[c] = lerp_u8(row, col[0] + c, col[1] + c, wx[1], wy[1]);
            continue;
        }
        int sum = L1L2_WARP_U8_ROUND;
        for (int r = 0; r < taps; r++) {
            int row_sum = 0;
            for (int k = 0; k < taps; k++)
                row_sum += row[r][col[k] + c] * wx[k];
            sum += (row_sum >> L1L2_WARP_U8_ROW_SHIFT) * wy[r];
        }
        dst[c] = clamp_u8(sum >> L1L2_WARP_U8_SHIFT);
    }
}

SPECIALIZED void sample_inside(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int32_t x, int32_t y,
                               uint8_t *dst, const int taps, const int components)
{
    const int stride = l1l2_warp_kernel_stride(taps), lead = taps / 2 - 1;
    const uint8_t *first = src->data + ((y >> L1L2_WARP_PHASE_BITS) - lead) * src->stride +
                           (ptrdiff_t)((x >> L1L2_WARP_PHASE_BITS) - lead) * components;
    const uint8_t *row[L1L2_WARP_MAX_TAPS];
    ptrdiff_t col[L1L2_WARP_MAX_TAPS];
    for (int k = 0; k < taps; k++) {
        row[k] = first + k * src->stride;
        col[k] = (ptrdiff_t)k * components;
    }
    weigh(row, col, kernel->weights + (x & (L1L2_WARP_PHASES - 1)) * stride,
          kernel->weights + (y & (L1L2_WARP_PHASES - 1)) * stride, dst, taps, components);
}

SPECIALIZED void sample_at_edge(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int32_t x, int32_t y,
                                uint8_t *dst, const int taps, const int components)
{
    const int stride = l1l2_warp_kernel_stride(taps), lead = taps / 2 - 1;
    const uint8_t *row[L1L2_WARP_MAX_TAPS];
    ptrdiff_t col[L1L2_WARP_MAX_TAPS];
    for (int k = 0; k < taps; k++) {
        row[k] = src->data + clamp_index((y >> L1L2_WARP_PHASE_BITS) - lead + k, src->height) * src->stride;
        col[k] = (ptrdiff_t)clamp_index((x >> L1L2_WARP_PHASE_BITS) - lead + k, src->width) * components;
    }
    weigh(row, col, kernel->weights + (x & (L1L2_WARP_PHASES - 1)) * stride,
          kernel->weights + (y & (L1L2_WARP_PHASES - 1)) * stride, dst, taps, components);
}

/* All taps of a position along an axis of `size` samples lie in it. */
SPECIALIZED bool is_inside(int32_t at, int size, const int taps)
{
    return size >= taps &&
           (uint32_t)(at >> L1L2_WARP_PHASE_BITS) - (uint32_t)(taps / 2 - 1) < (uint32_t)(size - taps + 1);
}

/* Run after run of samples that need no clamping, and of those that do. */
SPECIALIZED void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                     int count, uint8_t *dst, const int taps, const int components)
{
    int i = 0;
    while (i < count) {
        for (; i < count && is_inside(x[i], src->width, taps) && is_inside(y[i], src->height, taps); i++)
            sample_inside(src, kernel, x[i], y[i], dst + i * components, taps, components);
        for (; i < count && !(is_inside(x[i], src->width, taps) && is_inside(y[i], src->height, taps)); i++)
            sample_at_edge(src, kernel, x[i], y[i], dst + i * components, taps, components);
    }
}

DEFINE_RUNS(l1l2_warp_u8_run)
