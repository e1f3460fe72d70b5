/* SPDX-License-Identifier: MIT */
/*
 * Plane geometry: 3x3 maps on doubles. The conventions of the whole library live here.
 *
 *   Origin     the frame's center; x right, y down.
 *   Unit       inside the library: the diagonal of the frame as it is shown, so that lambda means the same at every
 *              resolution. At the public header: pixels. l1l2_mat_rescale() converts.
 *   Aspect     where pixels are not square, x is that of the shown picture: the sample's, times a pixel's width by
 *              its height. Only the warp is in samples.
 *   Pixels     centers at half-integers: the frame is exactly [-W/2, W/2] x [-H/2, H/2] px.
 *   Direction  F_t maps points of frame t to frame t-1; C_t = F_1 ... F_t (eq. 1); P_t = C_t B_t (eq. 2);
 *              B_t maps the crop window to the source frame.
 *   Parameters q = (x, y, a/2, b/2, e/2, f/2):   [a + e  f - b  x]     a zoom, b turn, e stretch, f skew
 *                                                [b + f  a - e  y]
 *                                                [0      0      1]
 *              A motion model has the first `dim` of them: translation 2, similarity 4, affine 6; the rest is the
 *              identity's. The linear ones are halved because a change of a, b, e or f by d moves each corner of the
 *              frame by d/2 diagonals: a change of any parameter by 1 moves the corners by 1.
 */
#ifndef L1L2_COMMON_GEOM_H
#define L1L2_COMMON_GEOM_H

#include <stdbool.h>

#include <l1l2stab/l1l2stab.h>

#define L1L2_DIM 6 /* parameters of a map, at most */

typedef struct L1L2Point {
    double x, y;
} L1L2Point;

/* Row-major; acts on (x, y, 1). Affine maps have the last row 0 0 1. */
typedef struct L1L2Mat {
    double m[9];
} L1L2Mat;

L1L2Mat l1l2_mat_identity(void);
L1L2Mat l1l2_mat_similarity(double a, double b, double x, double y);
L1L2Mat l1l2_mat_translation(double x, double y);
/* diag(x, y, 1) */
L1L2Mat l1l2_mat_diagonal(double x, double y);

/* The number of parameters of a motion model. */
int l1l2_mat_dim(L1L2StabMotionModel model);

/* The affine map with the first `dim` of these parameters; and the reverse, all parameters of a map. */
L1L2Mat l1l2_mat_from_q(const double q[L1L2_DIM], int dim);
void l1l2_mat_to_q(const L1L2Mat *m, double q[L1L2_DIM]);

/* m with only the first `dim` parameters; the others become the identity's. A map of that model is unchanged. */
L1L2Mat l1l2_mat_reduce(const L1L2Mat *m, int dim);

/* The map that applies b first: (a b) u = a (b u). */
L1L2Mat l1l2_mat_mul(L1L2Mat a, L1L2Mat b);

/* False, and *out the identity, where m is singular or not finite. */
bool l1l2_mat_inverse(L1L2Mat m, L1L2Mat *out);

L1L2Point l1l2_mat_apply(const L1L2Mat *m, L1L2Point p);

/* The same for affine maps, without the division. */
static inline L1L2Point l1l2_mat_apply_affine(const L1L2Mat *m, L1L2Point p)
{
    return (L1L2Point){m->m[0] * p.x + m->m[1] * p.y + m->m[2], m->m[3] * p.x + m->m[4] * p.y + m->m[5]};
}
bool l1l2_mat_is_affine(const L1L2Mat *m);
bool l1l2_mat_is_finite(const L1L2Mat *m);
bool l1l2_mat_is_identity(const L1L2Mat *m);

/* The same map in a unit in which lengths are `factor` times as large: diagonal_px converts diagonals to pixels. */
L1L2Mat l1l2_mat_rescale(L1L2Mat m, double factor);

/* A map of the picture as it is shown, in square pixels, as the map of its samples: D^-1 m D with D = diag(aspect, 1),
 * where aspect is a pixel's width by its height. Unchanged for aspect 1. */
L1L2Mat l1l2_mat_to_samples(L1L2Mat m, double aspect);

/* (1 - weight) a + weight b, element by element; exact at 0 and 1. Where a and b take a point into a convex set, so
 * does this: affine maps, and projective ones with m[8] = 1 and a positive denominator there. */
L1L2Mat l1l2_mat_mix(const L1L2Mat *a, const L1L2Mat *b, double weight);

/* The singular values of m's linear part: by how much it stretches the direction that it stretches most, and least.
 * *least is negative where m mirrors. */
void l1l2_mat_stretch(const L1L2Mat *m, double *most, double *least);

/* Which of columns x rows cells of the frame p lies in, row by row; points outside count to the nearest. */
int l1l2_cell_of(L1L2Point p, double half_w, double half_h, int columns, int rows);

/* The largest distance between the images of the four corners (+-half_w, +-half_h) under a and b. */
double l1l2_mat_corner_distance(const L1L2Mat *a, const L1L2Mat *b, double half_w, double half_h);

#endif
