/* SPDX-License-Identifier: MIT */
/*
 * The output's container, written by libavformat: the new picture, and everything else of the input.
 *
 * Packets of the other streams come long before the picture of the same time, because the stabilizer holds a window of
 * frames. They wait here, and are written when the picture has caught up.
 *
 * Two threads write: that which reads the input, and that which the encoder delivers to.
 */
#ifndef OUTPUT_H
#define OUTPUT_H

#include "encoder.h"
#include "input.h"
#include "options.h"

#include <gst/gst.h>

typedef struct Output Output;

/* Decides what becomes of each stream of the input, and opens the file. It is freed by output_free(). */
Output *output_new(const Options *options, const Input *input, const char *name, const Container *container,
                   GError **error);
void output_free(Output *output);

/* The picture has to be turned before it is encoded, because the container has no place for the display matrix. */
gboolean output_needs_upright_picture(const Output *output);

/* Takes a packet of another stream than the picture's, as it was read. It may move from it. */
void output_copy(Output *output, AVPacket *packet);
void output_copy_end(Output *output); /* the input has no more of them */

/* Takes an encoded picture. Times in nanoseconds from the start of the output. FALSE: output_fault() says why. */
gboolean output_picture(Output *output, GstBuffer *buffer, const GstCaps *encoded, const GstCaps *raw, gint64 pts,
                        gint64 dts);

/* Completes the file and gives it its name; partial: the name for an interrupted one. *written is the name. */
gboolean output_finish(Output *output, gboolean partial, char **written, GError **error);

/* The number of packets of other streams that are so damaged that the container refused them. */
int output_left_out(Output *output);

gint64 output_bytes(Output *output);

/* Sets *error to what went wrong so far. FALSE: nothing did. */
gboolean output_fault(Output *output, GError **error);

#endif
