/* SPDX-License-Identifier: MIT */
/* 3x3 matrices of doubles, row-major, that act on points (x, y, 1). */
#ifndef GST_L1L2_STAB_MATRIX_H
#define GST_L1L2_STAB_MATRIX_H

#include <glib.h>

G_BEGIN_DECLS

/* out = a b. `out` may be `a` or `b`. */
void gst_l1l2_stab_matrix_multiply (const gdouble a[9], const gdouble b[9],
    gdouble out[9]);

/* The inverse, scaled so that its last element is 1. Neither the determinant of `m` nor the last element of its inverse
 * may be 0. `out` must not be `m`. */
void gst_l1l2_stab_matrix_invert (const gdouble m[9], gdouble out[9]);

/* Maps a point. FALSE: the image of the point is at infinity or behind the camera, and x and y are unchanged. */
gboolean gst_l1l2_stab_matrix_map_point (const gdouble m[9], gdouble * x,
    gdouble * y);

G_END_DECLS

#endif
