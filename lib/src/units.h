/* SPDX-License-Identifier: MIT */
/*
 * The border between the library's unit, the frame's diagonal, and the caller's, the pixel. Maps cross it here alone.
 *
 * Whoever gives a reported motion back must get the same path, bit for bit. A product with the diagonal and one with
 * its inverse both round, so they do not undo each other by themselves. Therefore the library uses only motions that
 * have an exact pixel value, one that import takes to them; and export finds that value.
 */
#ifndef L1L2_UNITS_H
#define L1L2_UNITS_H

#include "common/geom.h"

/* A map in diagonals as the caller's, in pixels; rounded. */
void l1l2_units_export(const L1L2Mat *m, double diagonal_px, double px[9]);

/* A caller's motion, in pixels, as the library's. It has an exact pixel value. */
L1L2Mat l1l2_units_import_motion(const double px[9], double diagonal_px);

/* The motion next to F that has an exact pixel value: it differs from F by rounding only. */
L1L2Mat l1l2_units_exact_motion(const L1L2Mat *F, double diagonal_px);

/* The exact pixel value of a motion that has one: import gives F again, bit for bit. Of several values it takes the one
 * nearest to the rounded product, so that exporting what was imported from it gives the same value. */
void l1l2_units_export_motion(const L1L2Mat *F, double diagonal_px, double px[9]);

#endif
