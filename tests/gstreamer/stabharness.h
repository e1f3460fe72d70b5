/* SPDX-License-Identifier: MIT */
/* What the tests of the element share: a harness around it, frames that differ from each other, and a record of the
 * order in which frames and events come out. */
#ifndef STAB_HARNESS_H
#define STAB_HARNESS_H

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

/* 64x48 at 25 frames/s; one frame is 40 ms. */
#define SMALL_CAPS \
  "video/x-raw, format=I420, width=64, height=48, framerate=25/1"
#define FRAME_DURATION (40 * GST_MSECOND)

/* True if GStreamer has all elements of this NULL-terminated list. Otherwise prints which ones are missing. */
gboolean stab_have_elements (const gchar * const *names);

/* A harness around the element with these properties (name, value, ..., NULL), playing, with a bus. `caps` may be
 * NULL. */
GstHarness *stab_harness_new (const gchar * caps, const gchar * property, ...)
    G_GNUC_NULL_TERMINATED;

/* Frees the harness and the bus. */
void stab_harness_free (GstHarness * h);

/* Plays a pipeline to the end of its stream, within 40 seconds, and leaves it in the state PLAYING. `what` is printed
 * if that fails. */
void stab_play_to_end (GstElement * pipeline, const gchar * what);

/* The next message of this type, or NULL; does not wait. */
GstMessage *stab_harness_message (GstHarness * h, GstMessageType type);

/* Frame `index` of the harness's caps: every component is frame_level (index), of 8 bits, and it is at index *
 * FRAME_DURATION. */
GstBuffer *stab_frame_new (GstHarness * h, guint index);
guint8 stab_frame_level (guint index);

/* Frame 0, at another time. */
GstBuffer *stab_frame_new_at (GstHarness * h, GstClockTime pts,
    GstClockTime duration);

/* The address of sample (x, y) of component `c`, which has one or two bytes. */
guint8 *stab_frame_component (const GstVideoFrame * frame, guint c, gint x,
    gint y);

/* Fails unless every component of every pixel of `buffer` has this level. */
void stab_frame_assert_level (GstBuffer * buffer, GstCaps * caps, guint8 level);

/* Pushes frames `start` to `start + n - 1`. Each push must return GST_FLOW_OK. */
void stab_push_frames (GstHarness * h, guint start, guint n);

/* Pulls n frames without waiting. They must be frame `start` and those after it, and no other frame may be there. */
void stab_pull_frames (GstHarness * h, guint start, guint n);

/* The position that the element answers to a query from downstream. */
GstClockTime stab_position (GstHarness * h);

/* Records what comes out from now on, in order: "f3 " for frame 3, and for an event the name of its type. */
GString *stab_record_new (GstHarness * h);

G_END_DECLS

#endif
