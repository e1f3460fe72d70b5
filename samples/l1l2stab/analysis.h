/* SPDX-License-Identifier: MIT */
/*
 * The measured motion of a video, and what the path optimization would make of it with other settings. The path is
 * solved again from the motion; nothing is decoded or rendered for that.
 */
#ifndef ANALYSIS_H
#define ANALYSIS_H

#include "input.h"
#include "options.h"

#include <gst/gst.h>
#include <l1l2stab/l1l2stab.h>

#define POOR_QUALITY 0.3 /* below it there is little to track */

/* A frame's measured motion. */
typedef struct Motion {
    double F[9];
    gint64 time_ns;
    gboolean path_start, lost;
    double quality;
} Motion;

typedef struct Analysis {
    Input *input;            /* the caller's */
    GArray *motions;         /* of Motion */
    int cuts, lost, poor;
    double quality, readout; /* sum, after analysis_end() the mean; and the last one */
    L1L2StabConfig config;   /* of the runs without pictures */
    double shake;            /* as below; set by analysis_end() */
} Analysis;

/* Prepares it for an input with the settings of the path that the user gave. */
void analysis_begin(Analysis *analysis, const Options *options, Input *input);
void analysis_clear(Analysis *analysis);

/* Takes the motion from an element message; other messages are left alone. */
void analysis_add(Analysis *analysis, const GstStructure *message);

/* After the last frame: the shake as filmed. */
void analysis_end(Analysis *analysis);

/*
 * The share of the shake that is left in the first `frames` frames with these settings.
 *
 * The shake is the root mean square of the second difference of the frame's corners, in pixels of a picture that is
 * SHAKE_WIDTH wide: the distance of a corner from the place that its motion in the two frames before predicts. A steady
 * pan has none. Nothing is measured across a cut.
 */
#define SHAKE_WIDTH 640.0
#define ALL_FRAMES G_MAXUINT
double analysis_share_left(const Analysis *analysis, double crop, double lambda, guint frames);

/* A matrix of nine numbers in a message. It stays as it is if the message has none of this name. */
void analysis_read_matrix(const GstStructure *message, const char *name, double matrix[9]);

#endif
