/* SPDX-License-Identifier: MIT */
#include "common/geom.h"

#include <math.h>

L1L2Mat l1l2_mat_identity(void)
{
    return l1l2_mat_diagonal(1.0, 1.0);
}

L1L2Mat l1l2_mat_similarity(double a, double b, double x, double y)
{
    return (L1L2Mat){{a, -b, x, b, a, y, 0.0, 0.0, 1.0}};
}

L1L2Mat l1l2_mat_translation(double x, double y)
{
    return l1l2_mat_similarity(1.0, 0.0, x, y);
}

L1L2Mat l1l2_mat_diagonal(double x, double y)
{
    return (L1L2Mat){{x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, 1.0}};
}

int l1l2_mat_dim(L1L2StabMotionModel model)
{
    return model == L1L2STAB_MOTION_MODEL_TRANSLATION ? 2 : model == L1L2STAB_MOTION_MODEL_SIMILARITY ? 4 : 6;
}

L1L2Mat l1l2_mat_from_q(const double q[L1L2_DIM], int dim)
{
    const double a = dim > 2 ? 2.0 * q[2] : 1.0, b = dim > 2 ? 2.0 * q[3] : 0.0;
    const double e = dim > 4 ? 2.0 * q[4] : 0.0, f = dim > 4 ? 2.0 * q[5] : 0.0;
    return (L1L2Mat){{a + e, f - b, q[0], b + f, a - e, q[1], 0.0, 0.0, 1.0}};
}

void l1l2_mat_to_q(const L1L2Mat *m, double q[L1L2_DIM])
{
    q[0] = m->m[2], q[1] = m->m[5];
    q[2] = 0.25 * (m->m[0] + m->m[4]), q[3] = 0.25 * (m->m[3] - m->m[1]);
    q[4] = 0.25 * (m->m[0] - m->m[4]), q[5] = 0.25 * (m->m[3] + m->m[1]);
}

L1L2Mat l1l2_mat_reduce(const L1L2Mat *m, int dim)
{
    if (dim == L1L2_DIM)
        return (L1L2Mat){{m->m[0], m->m[1], m->m[2], m->m[3], m->m[4], m->m[5], 0.0, 0.0, 1.0}};
    double q[L1L2_DIM];
    l1l2_mat_to_q(m, q);
    return l1l2_mat_from_q(q, dim);
}

L1L2Mat l1l2_mat_mul(L1L2Mat a, L1L2Mat b)
{
    L1L2Mat r;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.m[3 * i + j] =
                a.m[3 * i] * b.m[j] + a.m[3 * i + 1] * b.m[3 + j] + a.m[3 * i + 2] * b.m[6 + j];
    return r;
}

bool l1l2_mat_inverse(L1L2Mat m, L1L2Mat *out)
{
    const double *v = m.m;
    const double c0 = v[4] * v[8] - v[5] * v[7];
    const double c1 = v[5] * v[6] - v[3] * v[8];
    const double c2 = v[3] * v[7] - v[4] * v[6];
    const double s = 1.0 / (v[0] * c0 + v[1] * c1 + v[2] * c2);
    *out = (L1L2Mat){{c0 * s, (v[2] * v[7] - v[1] * v[8]) * s, (v[1] * v[5] - v[2] * v[4]) * s,
                      c1 * s, (v[0] * v[8] - v[2] * v[6]) * s, (v[2] * v[3] - v[0] * v[5]) * s,
                      c2 * s, (v[1] * v[6] - v[0] * v[7]) * s, (v[0] * v[4] - v[1] * v[3]) * s}};
    if (l1l2_mat_is_finite(out))
        return true;
    *out = l1l2_mat_identity();
    return false;
}

L1L2Point l1l2_mat_apply(const L1L2Mat *m, L1L2Point p)
{
    const double *v = m->m;
    const double w = v[6] * p.x + v[7] * p.y + v[8];
    return (L1L2Point){(v[0] * p.x + v[1] * p.y + v[2]) / w, (v[3] * p.x + v[4] * p.y + v[5]) / w};
}

bool l1l2_mat_is_affine(const L1L2Mat *m)
{
    return m->m[6] == 0.0 && m->m[7] == 0.0 && m->m[8] == 1.0;
}

bool l1l2_mat_is_finite(const L1L2Mat *m)
{
    for (int i = 0; i < 9; i++)
        if (!isfinite(m->m[i]))
            return false;
    return true;
}

bool l1l2_mat_is_identity(const L1L2Mat *m)
{
    for (int i = 0; i < 9; i++)
        if (m->m[i] != (i % 4 == 0 ? 1.0 : 0.0))
            return false;
    return true;
}

L1L2Mat l1l2_mat_rescale(L1L2Mat m, double factor)
{
    m.m[2] *= factor;
    m.m[5] *= factor;
    m.m[6] /= factor;
    m.m[7] /= factor;
    return m;
}

L1L2Mat l1l2_mat_to_samples(L1L2Mat m, double aspect)
{
    m.m[1] /= aspect;
    m.m[2] /= aspect;
    m.m[3] *= aspect;
    m.m[6] *= aspect;
    return m;
}

L1L2Mat l1l2_mat_mix(const L1L2Mat *a, const L1L2Mat *b, double weight)
{
    L1L2Mat out;
    for (int i = 0; i < 9; i++)
        out.m[i] = (1.0 - weight) * a->m[i] + weight * b->m[i];
    return out;
}

/* [a b; c d] is the sum of a similarity, which stretches by |(a+d, c-b)| / 2, and of a mirrored one, which stretches by
 * |(a-d, c+b)| / 2. In one direction the two add up, and across it they subtract. */
void l1l2_mat_stretch(const L1L2Mat *m, double *most, double *least)
{
    const double *v = m->m;
    const double similarity = hypot(v[0] + v[4], v[3] - v[1]) / 2.0, mirrored = hypot(v[0] - v[4], v[3] + v[1]) / 2.0;
    *most = similarity + mirrored;
    *least = similarity - mirrored;
}

static int along(double at, double half, int cells)
{
    const double cell = floor((at / half + 1.0) * 0.5 * cells);
    return (int)fmin(fmax(cell, 0.0), cells - 1.0);
}

int l1l2_cell_of(L1L2Point p, double half_w, double half_h, int columns, int rows)
{
    return along(p.y, half_h, rows) * columns + along(p.x, half_w, columns);
}

double l1l2_mat_corner_distance(const L1L2Mat *a, const L1L2Mat *b, double half_w, double half_h)
{
    double worst = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {k & 1 ? half_w : -half_w, k & 2 ? half_h : -half_h};
        const L1L2Point p = l1l2_mat_apply(a, u);
        const L1L2Point q = l1l2_mat_apply(b, u);
        worst = fmax(worst, hypot(p.x - q.x, p.y - q.y));
    }
    return worst;
}
