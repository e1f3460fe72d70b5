/* SPDX-License-Identifier: MIT */
#include "units.h"

#include <math.h>
#include <string.h>

void l1l2_units_export(const L1L2Mat *m, double diagonal_px, double px[9])
{
    const L1L2Mat scaled = l1l2_mat_rescale(*m, diagonal_px);
    memcpy(px, scaled.m, sizeof scaled.m);
}

L1L2Mat l1l2_units_import_motion(const double px[9], double diagonal_px)
{
    L1L2Mat F;
    memcpy(F.m, px, sizeof F.m);
    return l1l2_mat_rescale(F, 1.0 / diagonal_px);
}

L1L2Mat l1l2_units_exact_motion(const L1L2Mat *F, double diagonal_px)
{
    double px[9];
    l1l2_units_export(F, diagonal_px, px);
    return l1l2_units_import_motion(px, diagonal_px);
}

/* The pixel value of a length that has one. Import rounds the inverse of the diagonal and a product, and the guess here
 * rounds another product: three relative errors of 2^-53 at most, which are 3 units in the last place. */
static double exact_px(double length, double diagonal_px)
{
    const double back = 1.0 / diagonal_px, guess = length * diagonal_px;
    double above = guess, below = guess;
    for (int steps = 0; steps <= 4; steps++) {
        if (above * back == length)
            return above;
        if (below * back == length)
            return below;
        above = nextafter(above, HUGE_VAL);
        below = nextafter(below, -HUGE_VAL);
    }
    return guess;
}

void l1l2_units_export_motion(const L1L2Mat *F, double diagonal_px, double px[9])
{
    l1l2_units_export(F, diagonal_px, px);
    px[2] = exact_px(F->m[2], diagonal_px);
    px[5] = exact_px(F->m[5], diagonal_px);
}
