/* SPDX-License-Identifier: MIT */
/*
 * What a similarity leaves of a motion: small displacements over the frame, linear in a few parameters.
 *
 * From frame t to frame t-1 (fitted by motion_residual.c) a point p moves to F_t p + r(p); of one frame (wobble.c) the
 * source position that belongs at p lies at p - r(p). Unit: the frame's diagonal; origin: the frame's centre.
 *
 *   homography  8 parameters: a homography near the identity, to first order.
 *   mixture     a mixture of homographies over row bands (Grundmann, Kwatra, Castro, Essa, "Calibration-free rolling
 *               shutter removal", ICCP 2012): each band moves by a translation of its own, with Gaussian weights
 *               between them; roll and zoom are linear in the row, one term of perspective is the frame's.
 */
#ifndef L1L2_ROLLING_SHUTTER_MODEL_H
#define L1L2_ROLLING_SHUTTER_MODEL_H

#include <stdbool.h>

#include <l1l2stab/l1l2stab.h>

#include "common/geom.h"

enum {
    L1L2_SHUTTER_BANDS = 10,
    /* Of a mixture's parameters: a band's translations, then these. */
    L1L2_SHUTTER_X = 0,
    L1L2_SHUTTER_Y = L1L2_SHUTTER_BANDS,
    L1L2_SHUTTER_ROLL = 2 * L1L2_SHUTTER_BANDS, /* mean over the rows */
    L1L2_SHUTTER_ROLL_BY_ROW,           /* from the first row to the last */
    L1L2_SHUTTER_ZOOM,
    L1L2_SHUTTER_ZOOM_BY_ROW,
    L1L2_SHUTTER_PERSPECTIVE,
    L1L2_SHUTTER_SIZE
};

typedef struct L1L2ShutterResidual {
    double p[L1L2_SHUTTER_SIZE]; /* of a homography the first 8; the rest 0 */
} L1L2ShutterResidual;

/* What tells how much of a residual is true: of the points, parts each of which is told by a fit to the others; and the
 * camera, whose motions foretell it (residual_cause.c). */
enum {
    L1L2_SPLIT_HALVES, /* every second point */
    L1L2_SPLIT_THIRDS, /* of every row: left, middle, right */
    L1L2_SPLIT_COLUMNS,   /* of every row: the inner half and the outer */
    L1L2_SPLITS,
    L1L2_VALIDATION_CAMERA = L1L2_SPLITS,
    L1L2_VALIDATIONS
};

/* From one frame to the next, and how much of the displacements each witness explains, of all: tested on points or a
 * frame left out of the fit, so that noise explains nothing. Sums of squares, weighted. */
typedef struct L1L2ShutterMeasurement {
    L1L2ShutterResidual r;
    double explained[L1L2_VALIDATIONS], all[L1L2_VALIDATIONS];
} L1L2ShutterMeasurement;

typedef struct L1L2ShutterModel {
    L1L2StabRollingShutter kind;  /* HOMOGRAPHY or MIXTURE */
    double half_w, half_h;        /* of the frame */
} L1L2ShutterModel;

/* Parameters in use. */
int l1l2_shutter_model_size(const L1L2ShutterModel *shape);

/* The middle of a band as a row: -1/2 is the first, 1/2 the last. */
double l1l2_shutter_band_row(int band);

/* The displacement at p is the sum of these by the parameters. */
void l1l2_shutter_model_basis(const L1L2ShutterModel *shape, L1L2Point p, double x[L1L2_SHUTTER_SIZE],
                         double y[L1L2_SHUTTER_SIZE]);

L1L2Point l1l2_shutter_residual_at(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r, L1L2Point p);

/* Takes the nearest similarity out of r and returns it, as what is to be added to a map. */
L1L2Mat l1l2_shutter_residual_extract_similarity(const L1L2ShutterModel *shape, L1L2ShutterResidual *r);

/* How much longer the frame becomes in one direction than across it, by the nearest affinity: a part of its length. */
double l1l2_shutter_residual_stretch(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r);

/* The longest displacement at the frame's corners and the middles of its sides. */
double l1l2_shutter_residual_reach(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r);

#endif
