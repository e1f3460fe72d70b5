/* SPDX-License-Identifier: MIT */
#include "units.h"

#include <string.h>

void l1l2_units_export(const L1L2Mat *m, double diagonal_px, double px[9])
{
    const L1L2Mat scaled = l1l2_mat_rescale(*m, diagonal_px);
    memcpy(px, scaled.m, sizeof scaled.m);
}

L1L2Mat l1l2_units_import(const double px[9], double diagonal_px)
{
    L1L2Mat m;
    memcpy(m.m, px, sizeof m.m);
    return l1l2_mat_rescale(m, 1.0 / diagonal_px);
}
