/* SPDX-License-Identifier: MIT */
/*
 * Conversion between the library's unit, the frame's diagonal, and the caller's unit, the pixel. No other file converts
 * maps. Both units are of the frame as it is shown: where pixels are not square, x is the sample's times the pixel
 * aspect, and diagonal_px is the shown picture's.
 *
 * A reported motion that is given in another run must make the same path, bit for bit. A given motion must be reported
 * as it was given. Both conversions round, and several pixel values can share one value in diagonals. So a frame's
 * record keeps the motion in pixels, as the caller sees it, and the library uses l1l2_units_import() of that. A
 * measured motion is first converted to pixels and then back.
 */
#ifndef L1L2_UNITS_H
#define L1L2_UNITS_H

#include "common/geom.h"

/* Converts a map from diagonals to pixels; rounds. */
void l1l2_units_export(const L1L2Mat *m, double diagonal_px, double px[9]);

/* Converts a map from pixels to diagonals; rounds. */
L1L2Mat l1l2_units_import(const double px[9], double diagonal_px);

#endif
