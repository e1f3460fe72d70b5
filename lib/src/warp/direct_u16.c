/* SPDX-License-Identifier: MIT */
/* Samples of 9 to 16 bits in plain C. */
#include "warp/direct_u16.h"

#include <string.h>

#include "warp/direct_u16_impl.h"

static inline int load(const uint8_t *component)
{
    uint16_t value;
    memcpy(&value, component, 2);
    return value;
}

static inline int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

/* The sum of one row's taps. Samples are cut to 16 bits as in AVX2, which matters only for components with bits set
 * above their depth. */
L1L2_INLINE int weigh_row(const uint8_t *row, const ptrdiff_t *col, const int16_t *wx, int shift, const int bias,
                          const int taps)
{
    int sum = 0;
    for (int k = 0; k < taps; k++)
        sum += (int16_t)((load(row + col[k]) >> shift) - bias) * wx[k];
    return sum;
}

/* One component of a sample. row[r]: row r of the taps; col[k]: bytes from there to tap k. */
L1L2_INLINE int weigh_narrow(const L1L2WarpPlane *src, const uint8_t *const *row, const ptrdiff_t *col,
                             const int16_t *wx, const int16_t *wy, const int taps)
{
    int sum = l1l2_warp_direct_u16_narrow_round(src->depth);
    for (int r = 0; r < taps; r++)
        sum += (int16_t)(weigh_row(row[r], col, wx, src->shift, 0, taps) >> src->depth) * wy[r];
    return sum >> l1l2_warp_direct_u16_narrow_shift(src->depth);
}

L1L2_INLINE int weigh_wide(const L1L2WarpPlane *src, const uint8_t *const *row, const ptrdiff_t *col,
                           const int16_t *wx, const int16_t *wy, const int taps)
{
    int upper = L1L2_WARP_DIRECT_U16_ROUND, lower = 0;
    for (int r = 0; r < taps; r++) {
        const int cut =
            weigh_row(row[r], col, wx, src->shift, L1L2_WARP_DIRECT_U16_BIAS, taps) >> L1L2_WARP_DIRECT_U16_ROW_SHIFT;
        upper += (cut >> L1L2_WARP_DIRECT_U16_PART_BITS) * wy[r];
        lower += (cut & ((1 << L1L2_WARP_DIRECT_U16_PART_BITS) - 1)) * wy[r];
    }
    return ((upper + (lower >> L1L2_WARP_DIRECT_U16_PART_BITS)) >> L1L2_WARP_DIRECT_U16_SHIFT) +
           L1L2_WARP_DIRECT_U16_BIAS;
}

L1L2_INLINE void sample(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int32_t x, int32_t y, uint8_t *dst,
                        const Shape shape)
{
    const int taps = shape.taps, components = shape.components;
    const int stride = l1l2_warp_kernel_stride(taps), lead = taps / 2 - 1;
    const int16_t *wx = kernel->weights + (x & (L1L2_WARP_PHASES - 1)) * stride;
    const int16_t *wy = kernel->weights + (y & (L1L2_WARP_PHASES - 1)) * stride;
    const uint8_t *row[L1L2_WARP_MAX_TAPS];
    ptrdiff_t col[L1L2_WARP_MAX_TAPS];
    for (int k = 0; k < taps; k++) {
        row[k] = src->data + clamp((y >> L1L2_WARP_PHASE_BITS) - lead + k, 0, src->height - 1) * src->stride;
        col[k] = 2 * components * (ptrdiff_t)clamp((x >> L1L2_WARP_PHASE_BITS) - lead + k, 0, src->width - 1);
    }
    for (int c = 0; c < components; c++) {
        const int value = (shape.wide ? weigh_wide : weigh_narrow)(src, row, col, wx, wy, taps);
        const uint16_t out = (uint16_t)(clamp(value, 0, (1 << src->depth) - 1) << src->shift);
        memcpy(dst + 2 * c, &out, 2);
        for (int k = 0; k < taps; k++)
            col[k] += 2;
    }
}

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                     int count, uint8_t *dst, const Shape shape)
{
    for (int i = 0; i < count; i++)
        sample(src, kernel, x[i], y[i], dst + 2 * shape.components * i, shape);
}

DEFINE_RUNS(, l1l2_warp_direct_u16_plain)

void l1l2_warp_direct_u16_init(L1L2WarpFunctions *functions)
{
    functions->direct_u16 = l1l2_warp_direct_u16_plain;
}
