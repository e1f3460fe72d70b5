/* SPDX-License-Identifier: MIT */
#include "path/coverage.h"

#include <math.h>
#include <stdbool.h>

enum {
    LATTICE = 160, /* points along each axis of the output */
    HALVINGS = 8   /* of the line from the identity to B */
};

static bool inside(const L1L2Coverage *coverage, L1L2Point p, double margin)
{
    return fabs(p.x) <= coverage->half_w - margin && fabs(p.y) <= coverage->half_h - margin;
}

static bool is_covered_by_neighbors(const L1L2Coverage *coverage, L1L2Point at)
{
    for (int k = 0; k < coverage->count; k++)
        if (inside(coverage, l1l2_mat_apply_affine(&coverage->neighbor[k].map, at), coverage->margin))
            return true;
    return false;
}

double l1l2_coverage_lack(const L1L2Coverage *coverage, const L1L2Mat *B)
{
    const double step_w = 2.0 * coverage->half_w / LATTICE, step_h = 2.0 * coverage->half_h / LATTICE;
    const L1L2Point step = {B->m[0] * step_w, B->m[3] * step_w};
    int lacking = 0;
    for (int row = 0; row < LATTICE; row++) {
        const L1L2Point out = {0.5 * step_w - coverage->half_w, (row + 0.5) * step_h - coverage->half_h};
        const L1L2Point start = l1l2_mat_apply_affine(B, out);
        for (int column = 0; column < LATTICE; column++) {
            const L1L2Point at = {start.x + column * step.x, start.y + column * step.y};
            lacking += !inside(coverage, at, 0.0) && !is_covered_by_neighbors(coverage, at);
        }
    }
    return (double)lacking / (LATTICE * LATTICE);
}

/* The largest crop ratio that admits B: B moves the center by (X, Y), and the corners to at most x and y beside it. */
static double admitting_ratio(const L1L2Coverage *coverage, const L1L2Mat *B)
{
    const double *m = B->m;
    const double x = fabs(m[0]) * coverage->half_w + fabs(m[1]) * coverage->half_h;
    const double y = fabs(m[3]) * coverage->half_w + fabs(m[4]) * coverage->half_h;
    return fmin((coverage->half_w - fabs(m[2])) / x, (coverage->half_h - fabs(m[5])) / y);
}

double l1l2_coverage_ratio(const L1L2Coverage *coverage, const L1L2Mat *B, double ratio, double limit, double most)
{
    const L1L2Mat identity = l1l2_mat_identity();
    double covered = 0.0, lacking = 1.0; /* parts of the way to B */
    if (l1l2_coverage_lack(coverage, B) <= limit)
        return ratio;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (covered + lacking);
        const L1L2Mat part = l1l2_mat_mix(&identity, B, middle);
        if (l1l2_coverage_lack(coverage, &part) <= limit)
            covered = middle;
        else
            lacking = middle;
    }
    const L1L2Mat part = l1l2_mat_mix(&identity, B, covered);
    return fmin(fmax(admitting_ratio(coverage, &part), ratio), fmax(most, ratio));
}
