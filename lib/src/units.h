/* SPDX-License-Identifier: MIT */
/*
 * The border between the library's unit, the frame's diagonal, and the caller's, the pixel. Maps cross it here alone.
 *
 * Whoever gives a reported motion back must get the same path, bit for bit, and what is given must be reported as it
 * was given. A number in diagonals cannot do this alone: both conversions round, and several pixel values may share one
 * value in diagonals. So a motion's record keeps the pixel value that the caller sees, and the library uses the motion
 * that import makes of it: also for a measured motion, which is exported first.
 */
#ifndef L1L2_UNITS_H
#define L1L2_UNITS_H

#include "common/geom.h"

/* A map in diagonals as the caller's, in pixels; rounded. */
void l1l2_units_export(const L1L2Mat *m, double diagonal_px, double px[9]);

/* A map in pixels as the library's; rounded. */
L1L2Mat l1l2_units_import(const double px[9], double diagonal_px);

#endif
