/* SPDX-License-Identifier: MIT */
#include "fit/point_pairs.h"

enum { CELLS_X = L1L2_FIT_CELLS_X, CELLS_Y = L1L2_FIT_CELLS_Y, CELLS = L1L2_FIT_CELLS };

double l1l2_fit_coverage(double half_w, double half_h, const L1L2Pair *pairs, const bool *inlier, int count)
{
    bool covered[CELLS] = {false};
    int cells = 0;
    for (int i = 0; i < count; i++)
        if (inlier[i])
            covered[l1l2_cell_of(pairs[i].from, half_w, half_h, CELLS_X, CELLS_Y)] = true;
    for (int cell = 0; cell < CELLS; cell++)
        cells += covered[cell];
    return (double)cells / CELLS;
}
