/* SPDX-License-Identifier: MIT */
/* Plain C. Right shifts of negative numbers are taken to be arithmetic, as all compilers in use have it. */
#include "warp/scanline_u8.h"

#include "warp/bilinear_u8.h"
#include "warp/scanline_u8_impl.h"

SPECIALIZED void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *line, uint8_t *dst,
                     const int taps, const int components)
{
    int16_t values[LINE_VALUES];
    for (int k = 0; k < line->down_pieces; k++)
        down_plain(src, kernel, line->first, &line->down[k], line->down[k].from,
                   end_of(line->down, k, line->down_pieces, line->columns), values, taps, components);
    for (int k = 0; k < line->along_pieces; k++)
        along_plain(kernel, &line->along[k], line->along[k].from,
                    end_of(line->along, k, line->along_pieces, line->count), values, dst, taps, components);
}

DEFINE_RUNS(l1l2_warp_scanline_run_plain, l1l2_warp_bilinear_run_plain)

L1L2WarpScanlineRun *l1l2_warp_scanline_run(int taps, int components)
{
#ifdef L1L2_WARP_AVX2
    if (__builtin_cpu_supports("avx2"))
        return l1l2_warp_scanline_run_avx2(taps, components);
#endif
    return l1l2_warp_scanline_run_plain(taps, components);
}
