/* SPDX-License-Identifier: MIT */
/*
 * What an update transform B_t may do (G2011, section 3.2; design: the paper takes both over unchanged).
 *
 *   Inclusion  the four corners of the crop window, mapped by B_t, stay in the source frame: 8 rows.
 *   Proximity  0.9 <= a <= 1.1, |b| <= 0.1 of B_t: 2 rows.
 *
 * Unit: the frame's diagonal. B_t = identity satisfies all of them with slack, and they are convex: on the way from any
 * B_t to the identity there is always a transform that satisfies them.
 */
#ifndef L1L2_CROP_H
#define L1L2_CROP_H

#include "geom.h"

#define L1L2_CROP_ROWS 10

typedef struct L1L2Crop {
    double half_w, half_h; /* of the frame, diagonals */
    double ratio;          /* kept part of each side, (0, 1) */
} L1L2Crop;

L1L2Crop l1l2_crop_make(int width_px, int height_px, double ratio);

/* The rows as lo <= G (a, b, x, y) <= hi on the similarity P = camera B, in the frame of reference of `camera`.
 * camera: a similarity C_t. */
void l1l2_crop_rows(const L1L2Crop *crop, const L1L2Mat *camera, double G[L1L2_CROP_ROWS][4],
                    double lo[L1L2_CROP_ROWS], double hi[L1L2_CROP_ROWS]);

/* How far B breaks its worst row: <= 0 where all hold. Diagonals for inclusion, plain numbers for proximity. */
double l1l2_crop_excess(const L1L2Crop *crop, const L1L2Mat *B);

/* The transform nearest to B on the straight way to the identity that satisfies every row. */
L1L2Mat l1l2_crop_admit(const L1L2Crop *crop, const L1L2Mat *B);

#endif
