/* SPDX-License-Identifier: MIT */
#include "path/constraints.h"

#include <math.h>
#include <string.h>

/* G2011, section 3.2. */
static const double min_zoom = 0.9, max_zoom = 1.1, max_turn = 0.1, max_skew = 0.05, max_stretch = 0.1;

typedef struct Rows {
    double G[L1L2_PATH_CONSTRAINTS][L1L2_DIM], lo[L1L2_PATH_CONSTRAINTS], hi[L1L2_PATH_CONSTRAINTS];
} Rows;

L1L2PathCropWindow l1l2_path_crop_window(double width, double height, double ratio, int dim)
{
    const double diagonal = hypot(width, height);
    return (L1L2PathCropWindow){width / (2.0 * diagonal), height / (2.0 * diagonal), ratio, dim};
}

int l1l2_path_constraint_count(int dim)
{
    return dim == 2 ? 2 : dim == 4 ? 10 : 14;
}

static void put(Rows *rows, int r, const double g[L1L2_DIM], double lo, double hi)
{
    memcpy(rows->G[r], g, sizeof rows->G[r]);
    rows->lo[r] = lo, rows->hi[r] = hi;
}

/*
 * The rows on the parameters of B itself. With B = [A+E  F-B'  X; B'+F  A-E  Y] and q = (X, Y, A/2, B'/2, E/2, F/2), a
 * point (x, y) goes to
 *     ((A + E) x + (F - B') y + X,  (B' + F) x + (A - E) y + Y)
 *   = (q0 + 2x q2 - 2y q3 + 2x q4 + 2y q5,  q1 + 2y q2 + 2x q3 - 2y q4 + 2x q5).
 * With (u, v) = (2x, 2y) these are the two inclusion rows of a corner. Where a left corner is beyond the right side of
 * the frame, a right corner is too. So one side of each row never decides; both sides are kept because they are the
 * definition.
 */
static void update_rows(const L1L2PathCropWindow *crop, Rows *rows)
{
    if (crop->dim == 2) {
        const double room = 1.0 - crop->ratio;
        put(rows, 0, (double[L1L2_DIM]){1.0}, -room * crop->half_w, room * crop->half_w);
        put(rows, 1, (double[L1L2_DIM]){0.0, 1.0}, -room * crop->half_h, room * crop->half_h);
        return;
    }
    for (int k = 0; k < 4; k++) {
        const double u = 2.0 * crop->ratio * (k & 1 ? crop->half_w : -crop->half_w);
        const double v = 2.0 * crop->ratio * (k & 2 ? crop->half_h : -crop->half_h);
        put(rows, 2 * k, (double[L1L2_DIM]){1.0, 0.0, u, -v, u, v}, -crop->half_w, crop->half_w);
        put(rows, 2 * k + 1, (double[L1L2_DIM]){0.0, 1.0, v, u, -v, u}, -crop->half_h, crop->half_h);
    }
    if (crop->dim == 4) {
        put(rows, 8, (double[L1L2_DIM]){0.0, 0.0, 2.0, 0.0}, min_zoom, max_zoom);
        put(rows, 9, (double[L1L2_DIM]){0.0, 0.0, 0.0, 2.0}, -max_turn, max_turn);
        return;
    }
    put(rows, 8, (double[L1L2_DIM]){0.0, 0.0, 2.0, 0.0, 2.0, 0.0}, min_zoom, max_zoom);
    put(rows, 9, (double[L1L2_DIM]){0.0, 0.0, 2.0, 0.0, -2.0, 0.0}, min_zoom, max_zoom);
    put(rows, 10, (double[L1L2_DIM]){0.0, 0.0, 0.0, 2.0, 0.0, 2.0}, -max_turn, max_turn);
    put(rows, 11, (double[L1L2_DIM]){0.0, 0.0, 0.0, -2.0, 0.0, 2.0}, -max_turn, max_turn);
    put(rows, 12, (double[L1L2_DIM]){0.0, 0.0, 0.0, 0.0, 4.0, 0.0}, -max_stretch, max_stretch);
    put(rows, 13, (double[L1L2_DIM]){0.0, 0.0, 0.0, 0.0, 0.0, 4.0}, -max_skew, max_skew);
}

void l1l2_path_constraint_rows(const L1L2PathCropWindow *crop, const L1L2Mat *camera,
                               double G[L1L2_PATH_CONSTRAINTS][L1L2_DIM], double lo[L1L2_PATH_CONSTRAINTS],
                               double hi[L1L2_PATH_CONSTRAINTS])
{
    Rows rows;
    L1L2Mat inverse;
    double c[L1L2_DIM];
    update_rows(crop, &rows);
    /*
     * Change of variable from B to P, where B = C^-1 P. Write M for the linear part of C^-1, and L and T for the linear
     * part and the translation of P. Then B has the linear part M L and the translation M (T - T_C).
     *
     * Linear part. A map [A+E  F-B; B+F  A-E] is the sum of four basis matrices with the coefficients A, B, E and F:
     *     I = [1 0; 0 1],  J = [0 -1; 1 0],  K = [1 0; 0 -1],  S = [0 1; 1 0].
     * With M = aI + bJ + eK + fS and L = AI + BJ + EK + FS, the product is bilinear in the two sets of coefficients.
     * With J J = -I, K K = S S = I, J K = S, K J = -S, J S = -K, S J = K, K S = -J and S K = J its coefficients are
     *     A' = aA - bB + eE + fF        B' = bA + aB + fE - eF
     *     E' = eA + fB + aE - bF        F' = fA - eB + bE + aF.
     * M is known, so each is linear in L. Insert them into a row with the coefficients g[2] to g[5], and sort by A, B,
     * E and F: the result is a row on P with the coefficients moved[2] to moved[5].
     *
     * Translation. M (T - T_C) is linear in T with the matrix M = [a+e  f-b; b+f  a-e], transposed in moved[0] and
     * moved[1]. The constant M T_C goes to the bounds: `shift`.
     */
    if (!l1l2_mat_inverse(*camera, &inverse))
        inverse.m[0] = inverse.m[4] = NAN; /* rows that no solver can meet, rather than wrong ones */
    l1l2_mat_to_q(&inverse, c);
    const double a = 2.0 * c[2], b = 2.0 * c[3], e = 2.0 * c[4], f = 2.0 * c[5];
    for (int r = 0; r < l1l2_path_constraint_count(crop->dim); r++) {
        const double *g = rows.G[r];
        const double moved[L1L2_DIM] = {
            (a + e) * g[0] + (b + f) * g[1],
            (f - b) * g[0] + (a - e) * g[1],
            a * g[2] + b * g[3] + e * g[4] + f * g[5],
            a * g[3] - b * g[2] + f * g[4] - e * g[5],
            a * g[4] + b * g[5] + e * g[2] + f * g[3],
            a * g[5] - b * g[4] + f * g[2] - e * g[3],
        };
        const double shift = moved[0] * camera->m[2] + moved[1] * camera->m[5];
        memcpy(G[r], moved, (size_t)crop->dim * sizeof *moved);
        lo[r] = rows.lo[r] + shift;
        hi[r] = rows.hi[r] + shift;
    }
}

static double row_value(const L1L2PathCropWindow *crop, const double g[L1L2_DIM], const L1L2Mat *B)
{
    double q[L1L2_DIM], value = 0.0;
    l1l2_mat_to_q(B, q);
    for (int j = 0; j < crop->dim; j++)
        value += g[j] * q[j];
    return value;
}

double l1l2_path_constraint_excess(const L1L2PathCropWindow *crop, const L1L2Mat *B)
{
    Rows rows;
    double worst = -HUGE_VAL;
    update_rows(crop, &rows);
    for (int r = 0; r < l1l2_path_constraint_count(crop->dim); r++) {
        const double value = row_value(crop, rows.G[r], B);
        worst = fmax(worst, fmax(value - rows.hi[r], rows.lo[r] - value));
    }
    return worst;
}

L1L2Mat l1l2_path_constraint_shrink(const L1L2PathCropWindow *crop, const L1L2Mat *B)
{
    const L1L2Mat identity = l1l2_mat_identity();
    if (!l1l2_mat_is_finite(B))
        return identity;
    Rows rows;
    double keep = 1.0;
    update_rows(crop, &rows);
    for (int r = 0; r < l1l2_path_constraint_count(crop->dim); r++) {
        const double at_identity = row_value(crop, rows.G[r], &identity), value = row_value(crop, rows.G[r], B);
        if (value > rows.hi[r])
            keep = fmin(keep, (rows.hi[r] - at_identity) / (value - at_identity));
        if (value < rows.lo[r])
            keep = fmin(keep, (at_identity - rows.lo[r]) / (at_identity - value));
    }
    L1L2Mat admitted = *B;
    if (keep < 1.0)
        for (int i = 0; i < 9; i++)
            admitted.m[i] = identity.m[i] + keep * (B->m[i] - identity.m[i]);
    return admitted;
}
