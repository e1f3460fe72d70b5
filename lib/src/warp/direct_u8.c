/* SPDX-License-Identifier: MIT */
/* One loop for all numbers of taps; the number of components is a constant in each instance. */
#include "warp/direct_u8.h"

#include "warp/functions.h"

static inline uint8_t clamp_u8(int value)
{
    return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                     int count, uint8_t *dst, const int components)
{
    const int taps = kernel->taps, lead = taps / 2 - 1;
    for (int i = 0; i < count; i++) {
        const int16_t *wx = kernel->weights + (x[i] & (L1L2_WARP_PHASES - 1)) * kernel->stride;
        const int16_t *wy = kernel->weights + (y[i] & (L1L2_WARP_PHASES - 1)) * kernel->stride;
        const int column = (x[i] >> L1L2_WARP_PHASE_BITS) - lead, row = (y[i] >> L1L2_WARP_PHASE_BITS) - lead;
        int sum[4] = {L1L2_WARP_DIRECT_U8_ROUND, L1L2_WARP_DIRECT_U8_ROUND, L1L2_WARP_DIRECT_U8_ROUND,
                      L1L2_WARP_DIRECT_U8_ROUND};
        for (int r = 0; r < taps; r++) {
            const uint8_t *samples = src->data + l1l2_warp_clamp(row + r, src->height) * src->stride;
            int row_sum[4] = {0};
            for (int k = 0; k < taps; k++) {
                const uint8_t *sample = samples + (ptrdiff_t)l1l2_warp_clamp(column + k, src->width) * components;
                for (int c = 0; c < components; c++)
                    row_sum[c] += sample[c] * wx[k];
            }
            for (int c = 0; c < components; c++)
                sum[c] += (row_sum[c] >> L1L2_WARP_DIRECT_U8_ROW_SHIFT) * wy[r];
        }
        for (int c = 0; c < components; c++)
            dst[i * components + c] = clamp_u8(sum[c] >> L1L2_WARP_DIRECT_U8_SHIFT);
    }
}

#define DEFINE_RUN(components)                                                                                        \
    static void run_##components(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x,            \
                                 const int32_t *y, int count, uint8_t *dst)                                           \
    {                                                                                                                 \
        run(src, kernel, x, y, count, dst, components);                                                               \
    }
DEFINE_RUN(1)
DEFINE_RUN(2)
DEFINE_RUN(3)
DEFINE_RUN(4)

void l1l2_warp_direct_u8_init(L1L2WarpFunctions *functions)
{
    functions->direct_u8[0] = run_1, functions->direct_u8[1] = run_2;
    functions->direct_u8[2] = run_3, functions->direct_u8[3] = run_4;
}
