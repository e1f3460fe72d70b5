/* SPDX-License-Identifier: MIT */
/* Fills the table: plain C first, then what an instruction set does faster. */
#include "warp/functions.h"

#include "common/cpu.h"

void l1l2_warp_functions_init(L1L2WarpFunctions *functions, unsigned cpu)
{
    l1l2_warp_coords_init(functions);
    l1l2_warp_bilinear_u8_init(functions);
    l1l2_warp_scanline_u8_init(functions);
    l1l2_warp_direct_u8_init(functions);
    l1l2_warp_direct_u16_init(functions);
#ifdef L1L2_HAVE_SIMD
    if (cpu & (L1L2_CPU_AVX2 | L1L2_CPU_NEON)) {
        l1l2_warp_coords_init_avx2(functions);
        l1l2_warp_bilinear_u8_init_avx2(functions);
        l1l2_warp_scanline_u8_init_avx2(functions);
        l1l2_warp_direct_u16_init_avx2(functions);
    }
#else
    (void)cpu;
#endif
}
