/* SPDX-License-Identifier: MIT */
/* Frames with texture that can be tracked: cells of noise that pan and jump. The library itself processes the same
 * frames as the reference for the element. */
#ifndef STAB_NOISE_H
#define STAB_NOISE_H

#include <l1l2stab/l1l2stab.h>

#include "stabharness.h"

G_BEGIN_DECLS

#define NOISE_WIDTH 160
#define NOISE_HEIGHT 120
#define NOISE_CAPS \
  "video/x-raw, format=GRAY8, width=160, height=120, framerate=25/1"

void stab_noise_fill (guint8 * pixels, guint index);

/* Frame `index` as a buffer, at index * FRAME_DURATION. */
GstBuffer *stab_noise_new (guint index);

/* A config of the library for such frames, with this window and the defaults. */
void stab_noise_config (L1L2StabConfig * config, gint window);

/* What the library reports of the first n frames. */
void stab_noise_infos (gint window, guint n, L1L2StabInfo * infos);

/* A harness around the element with this window, playing, with the caps of such frames. */
GstHarness *stab_noise_harness_new (gint window);
void stab_noise_push (GstHarness * h, guint start, guint n);

/* The matrix in a field: nine doubles. */
void stab_get_matrix (const GstStructure * structure, const gchar * field,
    gdouble matrix[9]);

G_END_DECLS

#endif
