/* SPDX-License-Identifier: MIT */
/* Bilinear scanlines in plain C. */
#include "warp/bilinear_u8_impl.h"

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpScanline *scanline, uint8_t *dst, const int components)
{
    for (int k = 0; k < scanline->along_pieces; k++)
        bilinear_plain(src, &(Samples){scanline, k, scanline->along[k].from, end_of_samples(scanline, k)}, dst,
                       components);
}

DEFINE_BILINEAR_RUNS(l1l2_warp_bilinear_u8_init)
