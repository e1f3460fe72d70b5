/* SPDX-License-Identifier: MIT */
/*
 * The constraints on an update transform B_t: inclusion and proximity.
 *
 * Source: the paper, section 4.3, takes both from Grundmann, Kwatra & Essa, CVPR 2011 (G2011), section 3.2.
 *
 *   Inclusion  The four corners of the crop window, mapped by B_t, stay in the source frame: 8 rows. For a translation
 *              2 rows suffice.
 *   Proximity  For B_t = [p r x; s u y]: 0.9 <= p, u <= 1.1, |r|, |s| <= 0.1, |r + s| <= 0.05, |p - u| <= 0.1: 6 rows.
 *              For a similarity, where p = u and r = -s, 2 rows are left. For a translation there are none.
 *
 * A row is two-sided, lo <= g q <= hi, in the parameters q of geom.h. Unit: the frame's diagonal. B_t = identity
 * satisfies every row with room to spare, and the set is convex. So between any B_t and the identity there is a
 * transform that satisfies all rows.
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

L1L2PathCropWindow l1l2_path_crop_window(double width, double height, double ratio, int dim);

/* Rows for a motion model of `dim` parameters. */
int l1l2_path_constraint_count(int dim);

/* The rows as lo <= G q <= hi on the parameters q of P = camera B, in the reference frame of `camera`.
 * camera: a C_t of the motion model. Rows and parameters that the model does not have are not written. */
void l1l2_path_constraint_rows(const L1L2PathCropWindow *crop, const L1L2Mat *camera,
                               double G[L1L2_PATH_CONSTRAINTS][L1L2_DIM], double lo[L1L2_PATH_CONSTRAINTS],
                               double hi[L1L2_PATH_CONSTRAINTS]);

/* By how much B, of the motion model, violates its worst row: <= 0 where all rows hold. Diagonals for inclusion, plain
 * numbers for proximity. */
double l1l2_path_constraint_excess(const L1L2PathCropWindow *crop, const L1L2Mat *B);

/* The transform nearest to B, on the straight line from B to the identity, that satisfies every row. The identity where
 * B is not finite. */
L1L2Mat l1l2_path_constraint_shrink(const L1L2PathCropWindow *crop, const L1L2Mat *B);

#endif
