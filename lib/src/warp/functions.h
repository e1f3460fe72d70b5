/* SPDX-License-Identifier: MIT */
/*
 * The warp's table of inner loops for one instruction set (common/cpu.h has the pattern).
 *
 * The warp is coordinate generator x kernel x sample type. A generator writes source positions (coords.h). A sample
 * type weighs the taps around them, for a number of taps and of interleaved components:
 *
 *   8 bits, along scanlines     scanline_u8.h for 4 and 6 taps, bilinear_u8.h for 2
 *   8 bits, any positions       direct_u8.h
 *   9 to 16 bits                direct_u16.h
 */
#ifndef L1L2_WARP_FUNCTIONS_H
#define L1L2_WARP_FUNCTIONS_H

#include "warp/coords.h"
#include "warp/direct_u16.h"
#include "warp/sample.h"
#include "warp/scanline_u8.h"

typedef struct L1L2WarpFunctions {
    L1L2WarpGenerators generators;
    L1L2WarpScanlineRun *bilinear_u8[4];         /* [components - 1] */
    L1L2WarpScanlineRun *scanline_u8[2][4];      /* [taps / 2 - 2][components - 1] */
    L1L2WarpDirectRun *direct_u8[4];             /* [components - 1] */
    L1L2WarpDirectU16Runs direct_u16;
} L1L2WarpFunctions;

/* cpu: the instruction sets to use, flags of common/cpu.h. All tables give the same bytes. */
void l1l2_warp_functions_init(L1L2WarpFunctions *functions, unsigned cpu);

/* The function for a kernel of 2, 4 or 6 taps and 1..4 components of 8 bits, or of 1, 2 or 4 of `depth` 9..16. */
static inline L1L2WarpScanlineRun *l1l2_warp_scanline_run(const L1L2WarpFunctions *functions, int taps, int components)
{
    return taps == 2 ? functions->bilinear_u8[components - 1] : functions->scanline_u8[taps / 2 - 2][components - 1];
}

static inline L1L2WarpDirectRun *l1l2_warp_direct_run(const L1L2WarpFunctions *functions, int taps, int components,
                                                      int depth)
{
    return depth == 8 ? functions->direct_u8[components - 1]
                      : functions->direct_u16.run[depth > L1L2_WARP_DIRECT_U16_NARROW][taps / 2 - 1][components / 2];
}

/* Each module's part of the table, in plain C. l1l2_warp_functions_init() calls them. */
void l1l2_warp_coords_init(L1L2WarpFunctions *functions);
void l1l2_warp_bilinear_u8_init(L1L2WarpFunctions *functions);
void l1l2_warp_scanline_u8_init(L1L2WarpFunctions *functions);
void l1l2_warp_direct_u8_init(L1L2WarpFunctions *functions);
void l1l2_warp_direct_u16_init(L1L2WarpFunctions *functions);

/* The same for processors with AVX2 or NEON. direct_u8 has none: stabilization does not need it. */
void l1l2_warp_coords_init_avx2(L1L2WarpFunctions *functions);
void l1l2_warp_bilinear_u8_init_avx2(L1L2WarpFunctions *functions);
void l1l2_warp_scanline_u8_init_avx2(L1L2WarpFunctions *functions);
void l1l2_warp_direct_u16_init_avx2(L1L2WarpFunctions *functions);

#endif
