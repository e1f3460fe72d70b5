/* SPDX-License-Identifier: MIT */
/*
 * The rolling-shutter residual: what a similarity leaves of a motion. It is a field of small displacements over the
 * frame, linear in a few parameters.
 *
 * The same type serves twice:
 *   - between two frames (fit.c): a point p of frame t lies at F_t p + r(p) in frame t-1;
 *   - for one frame (filter.c): what the source shows at p belongs at p + e(p), where a camera that takes all rows at
 *     once would show it.
 * To first order in the residuals, and with F_t near the identity, r = e_t - e_{t-1}.
 *
 * Convention: unit the frame's diagonal, origin the frame's center, x right, y down. A "row" is a vertical position
 * relative to the frame: -1/2 is the first row of pixels, 1/2 the last.
 *
 * Two models:
 *   homography  8 parameters: a homography near the identity, to first order. Source: G2011, section 5 (Grundmann,
 *               Kwatra, Essa, "Auto-directed video stabilization with robust L1 optimal camera paths", CVPR 2011).
 *   mixture     A mixture of homographies over bands of rows. Each band has its own translation, with Gaussian weights
 *               between bands. Roll and zoom are linear in the row. One perspective term holds for the whole frame.
 *               Source: Grundmann, Kwatra, Castro, Essa, "Calibration-free rolling shutter removal", ICCP 2012.
 */
#ifndef L1L2_ROLLING_SHUTTER_MODEL_H
#define L1L2_ROLLING_SHUTTER_MODEL_H

#include <stdbool.h>

#include <l1l2stab/l1l2stab.h>

#include "common/geom.h"
#include "rolling_shutter/parameters.h"

enum {
    L1L2_SHUTTER_BANDS = 10, /* as in the ICCP 2012 paper */
    /* Where a mixture's parameters lie: the bands' translations first, then the others. */
    L1L2_SHUTTER_X = 0,
    L1L2_SHUTTER_Y = L1L2_SHUTTER_BANDS,
    L1L2_SHUTTER_ROLL = 2 * L1L2_SHUTTER_BANDS, /* radians, mean over the rows */
    L1L2_SHUTTER_ROLL_BY_ROW,                   /* change from the first row to the last */
    L1L2_SHUTTER_ZOOM,                          /* relative, mean over the rows */
    L1L2_SHUTTER_ZOOM_BY_ROW,                   /* change from the first row to the last */
    L1L2_SHUTTER_PERSPECTIVE,                   /* zoom per diagonal to the right */
    L1L2_SHUTTER_SIZE
};

/* The parameters of one residual. A homography uses the first 8; the rest are 0. */
typedef struct L1L2ShutterResidual {
    double p[L1L2_SHUTTER_SIZE];
} L1L2ShutterResidual;

/* The validation tests of a residual. The first three split the tracks into parts and predict each part from a fit to
 * the others (fit.c). The last predicts the residual from the camera's motions (camera_gate.c). */
enum {
    L1L2_SPLIT_HALVES,  /* two parts: every second track */
    L1L2_SPLIT_THIRDS,  /* three parts: left, middle and right third of each row */
    L1L2_SPLIT_COLUMNS, /* two parts: inner and outer half of each row */
    L1L2_SPLITS,
    L1L2_VALIDATION_CAMERA = L1L2_SPLITS,
    L1L2_VALIDATIONS
};

/* The residual between a frame and the one before it, and its validation. Each test compares displacements with a
 * prediction that was made without them: all is the weighted sum of their squares, explained is how much of it the
 * prediction removes. Noise explains nothing; a prediction that makes it worse counts as negative. Both are 0 where a
 * test was not made. */
typedef struct L1L2ShutterMeasurement {
    L1L2ShutterResidual r;
    double explained[L1L2_VALIDATIONS], all[L1L2_VALIDATIONS]; /* diagonals squared */
} L1L2ShutterMeasurement;

typedef struct L1L2ShutterModel {
    L1L2StabRollingShutter kind;  /* HOMOGRAPHY or MIXTURE */
    double half_w, half_h;        /* half of the frame's sides, > 0 */
    const L1L2ShutterParameters *parameters; /* NULL: the defaults. Not owned */
} L1L2ShutterModel;

/* How many parameters the model uses. */
int l1l2_shutter_model_size(const L1L2ShutterModel *model);

/* The row of a band's middle, in (-1/2, 1/2). band: 0 to L1L2_SHUTTER_BANDS - 1, from the top. */
double l1l2_shutter_band_row(int band);

/* Writes the basis at p: the displacement there is the sum of x[i] and y[i] times parameter i. */
void l1l2_shutter_model_basis(const L1L2ShutterModel *model, L1L2Point p, double x[L1L2_SHUTTER_SIZE],
                              double y[L1L2_SHUTTER_SIZE]);

/* The displacement at p. */
L1L2Point l1l2_shutter_residual_at(const L1L2ShutterModel *model, const L1L2ShutterResidual *r, L1L2Point p);

/* Subtracts the nearest similarity from r, in the least squares sense over the frame. Returns it as a matrix that is to
 * be added, element by element, to the map that r belongs to. */
L1L2Mat l1l2_shutter_residual_extract_similarity(const L1L2ShutterModel *model, L1L2ShutterResidual *r);

/* How much longer the frame becomes in one direction than across it, by the nearest affine map: a part of its length.
 * 0 for a similarity; the tangent of the angle for a shear. */
double l1l2_shutter_residual_stretch(const L1L2ShutterModel *model, const L1L2ShutterResidual *r);

/* The longest displacement at the frame's corners, the middles of its sides and its center. */
double l1l2_shutter_residual_reach(const L1L2ShutterModel *model, const L1L2ShutterResidual *r);

/* True if all parameters are finite. */
bool l1l2_shutter_residual_is_finite(const L1L2ShutterResidual *r);

#endif
