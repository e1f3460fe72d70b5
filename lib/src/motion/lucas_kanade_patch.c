/* SPDX-License-Identifier: MIT */
/* The inner loops in plain C, and the choice of an instruction set. */
#include "motion/lucas_kanade_patch.h"

#include <string.h>

#include "common/cpu.h"

static inline int sample_grey(const uint8_t *p, ptrdiff_t stride, const int16_t *w)
{
    return (p[0] * w[0] + p[1] * w[1] + p[stride] * w[2] + p[stride + 1] * w[3] + L1L2_LK_GREY_ROUND) >>
           L1L2_LK_GREY_SHIFT;
}

static inline int sample_slope(const int16_t *p, ptrdiff_t stride, const int16_t *w)
{
    return (p[0] * w[0] + p[2] * w[1] + p[stride] * w[2] + p[stride + 2] * w[3] + L1L2_LK_SLOPE_ROUND) >>
           L1L2_LK_WEIGHT_BITS;
}

static L1L2LkSums take(const L1L2LkLevel *level, const L1L2LkPlace *place, L1L2LkPatch *patch)
{
    L1L2LkSums sums = {{0}};
    memset(patch, 0, sizeof *patch);
    for (int y = 0; y < L1L2_LK_WINDOW; y++)
        for (int x = 0; x < L1L2_LK_WINDOW; x++) {
            const int column = place->x + x, row = place->y + y;
            const int16_t *slope = level->slope + level->slope_stride * row + 2 * column;
            const int grey =
                sample_grey(level->grey + level->stride * row + column, level->stride, place->weight);
            const int across = sample_slope(slope, level->slope_stride, place->weight);
            const int down = sample_slope(slope + 1, level->slope_stride, place->weight);
            patch->grey[y][x] = (int16_t)grey;
            patch->across[y][x] = (int16_t)across;
            patch->down[y][x] = (int16_t)down;
            sums.of[0] += across * across, sums.of[1] += across * down, sums.of[2] += down * down;
        }
    return sums;
}

static L1L2LkSums compare(const L1L2LkLevel *level, const L1L2LkPlace *place, const L1L2LkPatch *patch)
{
    L1L2LkSums sums = {{0}};
    for (int y = 0; y < L1L2_LK_WINDOW; y++)
        for (int x = 0; x < L1L2_LK_WINDOW; x++) {
            const uint8_t *at = level->grey + level->stride * (place->y + y) + place->x + x;
            const int more = sample_grey(at, level->stride, place->weight) - patch->grey[y][x];
            sums.of[0] += more * patch->across[y][x], sums.of[1] += more * patch->down[y][x];
        }
    return sums;
}

void l1l2_lk_functions_init(L1L2LkFunctions *functions, unsigned cpu)
{
    *functions = (L1L2LkFunctions){take, compare};
#ifdef L1L2_HAVE_SIMD
    if (cpu & (L1L2_CPU_SSE2 | L1L2_CPU_NEON))
        l1l2_lk_functions_init_sse2(functions);
#else
    (void)cpu;
#endif
}
