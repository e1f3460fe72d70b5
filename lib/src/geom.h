/* SPDX-License-Identifier: MIT */
/*
 * Plane geometry: 3x3 maps on doubles. The conventions of the whole library live here.
 *
 *   Origin     the frame's centre; x right, y down.
 *   Unit       inside the library: the frame's diagonal, so that lambda means the same at every resolution.
 *              At the public header: pixels. l1l2_mat_rescale() converts.
 *   Pixels     centres at half-integers: the frame is exactly [-W/2, W/2] x [-H/2, H/2] px.
 *   Direction  F_t maps points of frame t to frame t-1; C_t = F_1 ... F_t (eq. 1); P_t = C_t B_t (eq. 2);
 *              B_t maps the crop window to the source frame.
 *   Similarity p = (a, b, x, y):  [a -b x]
 *                                 [b  a y]
 *                                 [0  0 1]
 */
#ifndef L1L2_GEOM_H
#define L1L2_GEOM_H

#include <stdbool.h>

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

/* The map that applies b first: (a b) u = a (b u). */
L1L2Mat l1l2_mat_mul(L1L2Mat a, L1L2Mat b);

/* False, and *out the identity, where m is singular or not finite. */
bool l1l2_mat_inverse(L1L2Mat m, L1L2Mat *out);

L1L2Point l1l2_mat_apply(const L1L2Mat *m, L1L2Point p);
bool l1l2_mat_is_finite(const L1L2Mat *m);
bool l1l2_mat_is_identity(const L1L2Mat *m);

/* The same map in a unit in which lengths read `factor` times as large: diagonals to pixels is factor = diagonal_px. */
L1L2Mat l1l2_mat_rescale(L1L2Mat m, double factor);

/* (1 - weight) a + weight b, element by element; exact at 0 and 1. Where a and b take a point into a convex set, so
 * does this: affine maps, and projective ones with m[8] = 1 and a positive denominator there. */
L1L2Mat l1l2_mat_mix(const L1L2Mat *a, const L1L2Mat *b, double weight);

/* The largest distance between the images of the four corners (+-half_w, +-half_h) under a and b. */
double l1l2_mat_corner_distance(const L1L2Mat *a, const L1L2Mat *b, double half_w, double half_h);

#endif
