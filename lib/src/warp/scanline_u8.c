/* SPDX-License-Identifier: MIT */
/* Scanlines in plain C. */
#include "warp/scanline_u8.h"

#include "warp/scanline_u8_impl.h"

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *scanline,
                     uint8_t *dst, const Shape shape)
{
    int16_t values[SCANLINE_VALUES];
    for (int k = 0; k < scanline->down_pieces; k++) {
        const Entries columns = {&scanline->down[k], scanline->down[k].from,
                                 end_of(scanline->down, k, scanline->down_pieces, scanline->columns)};
        down_plain(src, kernel, scanline->first, columns, values, shape);
    }
    for (int k = 0; k < scanline->along_pieces; k++) {
        const Entries samples = {&scanline->along[k], scanline->along[k].from,
                                 end_of(scanline->along, k, scanline->along_pieces, scanline->count)};
        along_plain(kernel, samples, values, dst, shape);
    }
}

DEFINE_RUNS(l1l2_warp_scanline_u8_init)
