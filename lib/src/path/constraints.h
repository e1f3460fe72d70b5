/* SPDX-License-Identifier: MIT */
/*
 * What an update transform B_t may do (G2011, section 3.2; design: the paper takes both over unchanged).
 *
 *   Inclusion  the four corners of the crop window, mapped by B_t, stay in the source frame: 8 rows. Of a translation
 *              2 say it all.
 *   Proximity  of B_t = [p r x; s u y]: 0.9 <= p, u <= 1.1, |r|, |s| <= 0.1, |r + s| <= 0.05, |p - u| <= 0.1: 6 rows.
 *              Of a similarity, where p = u and r = -s, 2 rows are left; of a translation none.
 *
 * Unit: the frame's diagonal. B_t = identity satisfies all of them with slack, and they are convex: on the way from any
 * B_t to the identity there is always a transform that satisfies them.
 */
#ifndef L1L2_PATH_CONSTRAINTS_H
#define L1L2_PATH_CONSTRAINTS_H

#include "common/geom.h"

#define L1L2_PATH_CONSTRAINTS 14 /* at most */

typedef struct L1L2PathCropWindow {
    double half_w, half_h; /* of the frame, diagonals */
    double ratio;          /* kept part of each side, (0, 1) */
    int dim;               /* of the motion model: 2, 4 or 6 parameters, see geom.h */
} L1L2PathCropWindow;

L1L2PathCropWindow l1l2_path_crop_window(int width_px, int height_px, double ratio, int dim);

/* Rows for a motion model of `dim` parameters. */
int l1l2_path_constraint_count(int dim);

/* The rows as lo <= G q <= hi on the parameters q of P = camera B, in the frame of reference of `camera`.
 * camera: a C_t of the motion model. What is beyond its row count and parameters is not written to. */
void l1l2_path_constraint_rows(const L1L2PathCropWindow *crop, const L1L2Mat *camera,
                               double G[L1L2_PATH_CONSTRAINTS][L1L2_DIM], double lo[L1L2_PATH_CONSTRAINTS],
                               double hi[L1L2_PATH_CONSTRAINTS]);

/* How far B, of the motion model, breaks its worst row: <= 0 where all hold. Diagonals for inclusion, plain numbers
 * for proximity. */
double l1l2_path_constraint_excess(const L1L2PathCropWindow *crop, const L1L2Mat *B);

/* The transform nearest to B on the straight way to the identity that satisfies every row. */
L1L2Mat l1l2_path_constraint_shrink(const L1L2PathCropWindow *crop, const L1L2Mat *B);

#endif
