/* SPDX-License-Identifier: MIT */
#include "warp/bilinear_u8.h"

#include "warp/bilinear_u8_impl.h"

SPECIALIZED void run(const L1L2WarpPlane *src, const L1L2WarpScanline *line, uint8_t *dst, const int components)
{
    for (int k = 0; k < line->along_pieces; k++)
        linear_plain(src, line, k, line->along[k].from, end_of_samples(line, k), dst, components);
}

DEFINE_LINEAR_RUNS(l1l2_warp_bilinear_run_plain)
