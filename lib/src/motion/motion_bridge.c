/* SPDX-License-Identifier: MIT */
/*
 * The plane as complex numbers: a similarity takes w to z w + t. Its logarithm is (A, u) with A = ln z = zoom + i turn,
 * and integrating dw/ds = A w + u over s = 0 ... 1 gives
 *
 *     z = exp A,    t = (exp A - 1) / A * u.
 *
 * Sharing out. Let l_i be the logarithm of what was measured for frame i, with variance v_i = 1 / weight. The most
 * likely logarithms x_i with a given sum L minimize sum |x_i - l_i|^2 / v_i. Lagrange's multiplier m of the condition
 * gives x_i = l_i + m v_i, and the condition m = (L - sum l) / sum v: what is lacking is shared in proportion to the
 * variances. A frame without a measurement has l = 0 and a variance that is far larger than any measured one's, so
 * such frames take all that is lacking, in proportion to their durations.
 *
 * Logarithms of motions add up only to first order (Baker, Campbell, Hausdorff): what the product of the exponentials
 * still lacks of G, log(product^-1 G), is shared in the same way until nothing is left. Each round leaves about as much
 * as the rotation, in radians, times what was lacking.
 */
#include "motion/motion_bridge.h"

#include <complex.h>
#include <math.h>

static const double series_below = 0.01; /* of |A|: the quotient loses digits there */

/* (exp A - 1) / A */
static double complex flow(double complex A)
{
    if (cabs(A) >= series_below)
        return (cexp(A) - 1.0) / A;
    return 1.0 + A / 2.0 * (1.0 + A / 3.0 * (1.0 + A / 4.0 * (1.0 + A / 5.0 * (1.0 + A / 6.0))));
}

L1L2SimilarityLog l1l2_motion_log(const L1L2Mat *F)
{
    const double complex A = clog(F->m[0] + F->m[3] * I), u = (F->m[2] + F->m[5] * I) / flow(A);
    return (L1L2SimilarityLog){creal(A), cimag(A), creal(u), cimag(u)};
}

L1L2Mat l1l2_motion_exp(const L1L2SimilarityLog *log)
{
    const double complex A = log->zoom + log->turn * I, z = cexp(A), t = flow(A) * (log->x + log->y * I);
    return l1l2_mat_similarity(creal(z), cimag(z), creal(t), cimag(t));
}

static L1L2Mat product(const L1L2Mat *F, int frames)
{
    L1L2Mat P = l1l2_mat_identity();
    for (int i = 0; i < frames; i++)
        P = l1l2_mat_mul(P, F[i]);
    return P;
}

/* What the product of the motions lacks of G. */
static L1L2Mat lacking(const L1L2Mat *G, const L1L2Mat *F, int frames)
{
    L1L2Mat inverse;
    l1l2_mat_inverse(product(F, frames), &inverse);
    return l1l2_mat_mul(inverse, *G);
}

void l1l2_motion_share_out(const L1L2Mat *G, L1L2Mat *F, const double *weight, const double *duration, int frames)
{
    enum { MAX_ROUNDS = 30 };
    const double unmeasured = 1e9, exact = 1e-15;
    double largest = 0.0, sum = 0.0, share[L1L2_BRIDGE_MAX_FRAMES];
    L1L2SimilarityLog x[L1L2_BRIDGE_MAX_FRAMES] = {{0}};
    for (int i = 0; i < frames; i++)
        if (weight[i] > 0.0)
            largest = fmax(largest, 1.0 / weight[i]);
    for (int i = 0; i < frames; i++) {
        if (weight[i] > 0.0)
            x[i] = l1l2_motion_log(&F[i]);
        share[i] = weight[i] > 0.0 ? 1.0 / weight[i]
                                   : (largest > 0.0 ? unmeasured * largest : 1.0) * (duration ? duration[i] : 1.0);
        sum += share[i];
        F[i] = l1l2_motion_exp(&x[i]);
    }
    for (int round = 0; round < MAX_ROUNDS; round++) {
        const L1L2Mat rest = lacking(G, F, frames);
        const L1L2SimilarityLog e = l1l2_motion_log(&rest);
        for (int i = 0; i < frames; i++) {
            const double part = share[i] / sum;
            x[i].zoom += part * e.zoom, x[i].turn += part * e.turn;
            x[i].x += part * e.x, x[i].y += part * e.y;
            F[i] = l1l2_motion_exp(&x[i]);
        }
        if (fabs(e.zoom) + fabs(e.turn) + fabs(e.x) + fabs(e.y) < exact)
            break;
    }
    const L1L2Mat rest = lacking(G, F, frames); /* rounding */
    F[frames - 1] = l1l2_mat_mul(F[frames - 1], rest);
}
