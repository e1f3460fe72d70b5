/* SPDX-License-Identifier: MIT */
#include "warp_linear.h"

#include "warp_linear_impl.h"

SPECIALIZED void run(const L1L2WarpPlane *src, const L1L2WarpLine *line, uint8_t *dst, const int components)
{
    for (int k = 0; k < line->along_pieces; k++)
        linear_plain(src, line, k, line->along[k].from, end_of_samples(line, k), dst, components);
}

DEFINE_LINEAR_RUNS(l1l2_warp_linear_run_plain)
