/* SPDX-License-Identifier: MIT */
#include "crop.h"

#include <math.h>

static const double min_a = 0.9, max_a = 1.1, max_b = 0.1;

L1L2Crop l1l2_crop_make(int width_px, int height_px, double ratio)
{
    const double diagonal_px = hypot(width_px, height_px);
    return (L1L2Crop){width_px / (2.0 * diagonal_px), height_px / (2.0 * diagonal_px), ratio};
}

/* A point of B as a linear form of (a, b, x, y): x row [ux -uy 1 0], y row [uy ux 0 1]. Corners come with both signs,
 * so rows are two-sided. */
static void update_rows(const L1L2Crop *crop, double G[L1L2_CROP_ROWS][4], double lo[L1L2_CROP_ROWS],
                        double hi[L1L2_CROP_ROWS])
{
    for (int k = 0; k < 4; k++) {
        const double ux = crop->ratio * (k & 1 ? crop->half_w : -crop->half_w);
        const double uy = crop->ratio * (k & 2 ? crop->half_h : -crop->half_h);
        double *gx = G[2 * k], *gy = G[2 * k + 1];
        gx[0] = ux, gx[1] = -uy, gx[2] = 1.0, gx[3] = 0.0;
        gy[0] = uy, gy[1] = ux, gy[2] = 0.0, gy[3] = 1.0;
        hi[2 * k] = crop->half_w, lo[2 * k] = -crop->half_w;
        hi[2 * k + 1] = crop->half_h, lo[2 * k + 1] = -crop->half_h;
    }
    G[8][0] = 1.0, G[8][1] = G[8][2] = G[8][3] = 0.0;
    G[9][1] = 1.0, G[9][0] = G[9][2] = G[9][3] = 0.0;
    lo[8] = min_a, hi[8] = max_a;
    lo[9] = -max_b, hi[9] = max_b;
}

void l1l2_crop_rows(const L1L2Crop *crop, const L1L2Mat *camera, double G[L1L2_CROP_ROWS][4],
                    double lo[L1L2_CROP_ROWS], double hi[L1L2_CROP_ROWS])
{
    update_rows(crop, G, lo, hi);
    /* B = C^-1 P. With C = (ca, cb, cx, cy) as complex numbers: a + ib and x + iy of B are those of P, less C's
     * translation, times conj(c)/|c|^2 =: u + iv. */
    const double ca = camera->m[0], cb = camera->m[3], cx = camera->m[2], cy = camera->m[5];
    const double norm = ca * ca + cb * cb;
    const double u = ca / norm, v = -cb / norm;
    for (int r = 0; r < L1L2_CROP_ROWS; r++) {
        const double ga = G[r][0], gb = G[r][1], gx = G[r][2], gy = G[r][3];
        G[r][0] = u * ga + v * gb, G[r][1] = -v * ga + u * gb;
        G[r][2] = u * gx + v * gy, G[r][3] = -v * gx + u * gy;
        const double shift = G[r][2] * cx + G[r][3] * cy;
        lo[r] += shift, hi[r] += shift;
    }
}

static double row_value(const double g[4], const L1L2Mat *B)
{
    return g[0] * B->m[0] + g[1] * B->m[3] + g[2] * B->m[2] + g[3] * B->m[5];
}

double l1l2_crop_excess(const L1L2Crop *crop, const L1L2Mat *B)
{
    double G[L1L2_CROP_ROWS][4], lo[L1L2_CROP_ROWS], hi[L1L2_CROP_ROWS], worst = -HUGE_VAL;
    update_rows(crop, G, lo, hi);
    for (int r = 0; r < L1L2_CROP_ROWS; r++) {
        const double value = row_value(G[r], B);
        worst = fmax(worst, fmax(value - hi[r], lo[r] - value));
    }
    return worst;
}

L1L2Mat l1l2_crop_admit(const L1L2Crop *crop, const L1L2Mat *B)
{
    const L1L2Mat identity = l1l2_mat_identity();
    if (!l1l2_mat_is_finite(B))
        return identity;
    double G[L1L2_CROP_ROWS][4], lo[L1L2_CROP_ROWS], hi[L1L2_CROP_ROWS], keep = 1.0;
    update_rows(crop, G, lo, hi);
    for (int r = 0; r < L1L2_CROP_ROWS; r++) {
        const double at_identity = row_value(G[r], &identity), value = row_value(G[r], B);
        if (value > hi[r])
            keep = fmin(keep, (hi[r] - at_identity) / (value - at_identity));
        if (value < lo[r])
            keep = fmin(keep, (at_identity - lo[r]) / (at_identity - value));
    }
    L1L2Mat admitted = *B;
    if (keep < 1.0)
        for (int i = 0; i < 9; i++)
            admitted.m[i] = identity.m[i] + keep * (B->m[i] - identity.m[i]);
    return admitted;
}
