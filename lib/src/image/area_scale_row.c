/* SPDX-License-Identifier: MIT */
/* The pass across in plain C, and the choice of an instruction set. */
#include "image/area_scale_row.h"

#include "common/cpu.h"

static void row(const int16_t *samples, const int32_t *first, const int16_t *weight, int taps, int count, int32_t *sum)
{
    enum { BLOCK = L1L2_AREA_SCALE_BLOCK };
    for (int x = 0; x < count; x += BLOCK) {
        int32_t s[BLOCK] = {0};
        for (int k = 0; k < taps; k += BLOCK)
            for (int i = 0; i < BLOCK; i++, weight += BLOCK)
                for (int j = 0; j < BLOCK; j++)
                    s[i] += samples[first[x + i] + k + j] * weight[j];
        for (int i = 0; i < BLOCK; i++)
            sum[x + i] = s[i];
    }
}

void l1l2_image_scale_functions_init(L1L2AreaScaleFunctions *functions, unsigned cpu)
{
    functions->row = row;
#ifdef L1L2_HAVE_SIMD
    if (cpu & (L1L2_CPU_SSE2 | L1L2_CPU_NEON))
        l1l2_image_scale_functions_init_sse2(functions);
#else
    (void)cpu;
#endif
}
