/* SPDX-License-Identifier: MIT */
#include "fit/least_squares.h"

#include <math.h>

/* Weighted sums about the means of both sides: u = from - mean, v = to - mean. */
typedef struct Moments {
    double weight, from_x, from_y, to_x, to_y; /* sum and means */
    double uu[3];                              /* sums of ux ux, ux uy, uy uy */
    double vu[2][2];                           /* sums of vx ux, vx uy; vy ux, vy uy */
} Moments;

/* Pairs of weight 0 are skipped, because they need not be finite. */
static Moments moments(const L1L2Pair *pairs, const double *weights, int count)
{
    Moments m = {0};
    for (int i = 0; i < count; i++) {
        const double w = l1l2_fit_weight(weights, i);
        if (w == 0.0)
            continue;
        m.weight += w;
        m.from_x += w * pairs[i].from.x, m.from_y += w * pairs[i].from.y;
        m.to_x += w * pairs[i].to.x, m.to_y += w * pairs[i].to.y;
    }
    if (!(m.weight > 0.0))
        return m;
    m.from_x /= m.weight, m.from_y /= m.weight;
    m.to_x /= m.weight, m.to_y /= m.weight;
    for (int i = 0; i < count; i++) {
        const double w = l1l2_fit_weight(weights, i);
        if (w == 0.0)
            continue;
        const double ux = pairs[i].from.x - m.from_x, uy = pairs[i].from.y - m.from_y;
        const double vx = pairs[i].to.x - m.to_x, vy = pairs[i].to.y - m.to_y;
        m.uu[0] += w * ux * ux, m.uu[1] += w * ux * uy, m.uu[2] += w * uy * uy;
        m.vu[0][0] += w * vx * ux, m.vu[0][1] += w * vx * uy;
        m.vu[1][0] += w * vy * ux, m.vu[1][1] += w * vy * uy;
    }
    return m;
}

/* With points as complex numbers the similarity is v = (a + ib) u. The sum of w |v - (a + ib) u|^2 is least for
 * a + ib = sum w conj(u) v / sum w |u|^2. */
static bool fit_similarity(const Moments *m, double linear[4])
{
    const double spread = m->uu[0] + m->uu[2];
    const double a = (m->vu[0][0] + m->vu[1][1]) / spread, b = (m->vu[1][0] - m->vu[0][1]) / spread;
    linear[0] = linear[3] = a;
    linear[1] = -b, linear[2] = b;
    return spread > 0.0 && hypot(a, b) > 0.0;
}

/* The normal equations of each row of the linear part: [a b] = [sum vx ux, sum vx uy] (sum u u')^-1. */
static bool fit_affine(const Moments *m, double linear[4])
{
    const double determinant = m->uu[0] * m->uu[2] - m->uu[1] * m->uu[1], spread = m->uu[0] + m->uu[2];
    for (int row = 0; row < 2; row++) {
        linear[2 * row] = (m->vu[row][0] * m->uu[2] - m->vu[row][1] * m->uu[1]) / determinant;
        linear[2 * row + 1] = (m->vu[row][1] * m->uu[0] - m->vu[row][0] * m->uu[1]) / determinant;
    }
    return determinant > 1e-12 * spread * spread && linear[0] * linear[3] - linear[1] * linear[2] != 0.0;
}

int l1l2_fit_size(L1L2StabMotionModel model)
{
    return model == L1L2STAB_MOTION_MODEL_TRANSLATION ? 1 : model == L1L2STAB_MOTION_MODEL_SIMILARITY ? 2 : 3;
}

static double distance(L1L2Point a, L1L2Point b)
{
    return hypot(a.x - b.x, a.y - b.y);
}

double l1l2_fit_extent(L1L2StabMotionModel model, const L1L2Pair *set)
{
    const L1L2Point p = set[0].from;
    if (model == L1L2STAB_MOTION_MODEL_TRANSLATION)
        return INFINITY;
    const L1L2Point q = set[1].from;
    if (model == L1L2STAB_MOTION_MODEL_SIMILARITY)
        return distance(p, q);
    const L1L2Point r = set[2].from;
    const double area = fabs((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
    const double longest = fmax(distance(p, q), fmax(distance(q, r), distance(r, p)));
    return longest > 0.0 ? area / longest : 0.0;
}

bool l1l2_fit(L1L2StabMotionModel model, const L1L2Pair *pairs, const double *weights, int count, L1L2Mat *fit)
{
    const Moments m = moments(pairs, weights, count);
    double a[4] = {1.0, 0.0, 0.0, 1.0};
    bool found = m.weight > 0.0;
    if (found && model == L1L2STAB_MOTION_MODEL_SIMILARITY)
        found = fit_similarity(&m, a);
    else if (found && model == L1L2STAB_MOTION_MODEL_AFFINE)
        found = fit_affine(&m, a);
    if (!found)
        return false;
    *fit = (L1L2Mat){{a[0], a[1], m.to_x - a[0] * m.from_x - a[1] * m.from_y,
                      a[2], a[3], m.to_y - a[2] * m.from_x - a[3] * m.from_y, 0.0, 0.0, 1.0}};
    return l1l2_mat_is_finite(fit);
}
