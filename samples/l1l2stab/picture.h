/* SPDX-License-Identifier: MIT */
/*
 * The picture's way through GStreamer: decoded, stabilized, encoded.
 *
 *     appsrc ! decodebin ! deinterlace ! videoconvert ! l1l2stab !
 *         videoflip ! videoscale ! videocrop ! ENCODER ! appsink
 *
 * Elements that have nothing to do pass frames through. Each frame keeps its timestamp, so a variable frame rate stays.
 */
#ifndef PICTURE_H
#define PICTURE_H

#include "encoder.h"
#include "input.h"
#include "options.h"

#include <gst/gst.h>

typedef struct Picture Picture;

/* Who gets the encoded picture. It runs in a streaming thread. Times in nanoseconds from the start of the output. FALSE
 * ends the pipeline with an error. */
typedef struct PictureSink {
    gboolean (*encoded)(void *cookie, GstBuffer *buffer, const GstCaps *encoded, const GstCaps *raw, gint64 pts,
                        gint64 dts);
    void *cookie;
} PictureSink;

/* What happens at the end of the pipeline. */
typedef enum PictureEnd {
    PICTURE_ENCODE,   /* to the sink */
    PICTURE_SHOW,     /* in a window, at normal speed */
    PICTURE_ANALYZE   /* nothing: only the messages of the element are of interest */
} PictureEnd;

/* encoder is for PICTURE_ENCODE. It is freed by picture_free(). */
Picture *picture_new(const Options *options, const Input *input, const Encoder *encoder, PictureEnd end,
                     gboolean upright, PictureSink sink, GError **error);
void picture_free(Picture *picture);

/* The element that stabilizes; the picture owns it. And the bus, which is to be unreferenced. */
GstElement *picture_stabilizer(Picture *picture);
GstBus *picture_bus(Picture *picture);

/* How videoflip turns the picture of an input upright, such as "90r". NULL: it is upright. */
const char *picture_flip_method(const Input *input);

gboolean picture_start(Picture *picture);
void picture_stop(Picture *picture);

/* Gives a packet of the picture's stream to the decoder. It waits while the decoder has enough. FALSE: the pipeline
 * does not take any more. */
gboolean picture_push(Picture *picture, const AVPacket *packet);
void picture_push_end(Picture *picture);

/* Lets no further frame in. What is in the stabilizer comes out. Any thread may call it. */
void picture_cut(Picture *picture);

/* Sets *error from an error message of the pipeline: whose fault it is depends on the element. */
void picture_explain(Picture *picture, GstMessage *message, GError **error);

/* Remembers which plugin is missing. Call it for each element message. */
void picture_note_missing(Picture *picture, GstMessage *message);

/* Numbers of frames that were decoded and that were encoded, and the time of the last one from the start,
    in seconds. */
void picture_progress(Picture *picture, gint64 *decoded, gint64 *encoded, double *seconds);

#endif
