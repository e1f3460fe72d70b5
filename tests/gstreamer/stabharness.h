/* SPDX-License-Identifier: MIT */
/* What the element's tests share: a harness around it, frames that can be told apart, and a record of what comes out
 * in which order. */
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

/* Whether GStreamer has the elements of this NULL-terminated list. Prints that tests are skipped for want of them. */
gboolean stab_have_elements (const gchar * const *names);

/* The element with these properties (name, value, ..., NULL), playing, with a bus. `caps` may be NULL. */
GstHarness *stab_harness_new (const gchar * caps, const gchar * property, ...)
    G_GNUC_NULL_TERMINATED;

/* Also takes the bus down. */
void stab_harness_free (GstHarness * h);

/* The next message of this type, or NULL; does not wait. */
GstMessage *stab_harness_message (GstHarness * h, GstMessageType type);

/* Frame `index` of the harness's caps: every component is frame_level (index), of 8 bits, and it is at index *
 * FRAME_DURATION. */
GstBuffer *stab_frame_new (GstHarness * h, guint index);
guint8 stab_frame_level (guint index);

/* Frame 0, at another time. */
GstBuffer *stab_frame_new_at (GstHarness * h, GstClockTime pts,
    GstClockTime duration);

/* Where component `c` of pixel (x, y), counted in that component's samples, is: one or two bytes. */
guint8 *stab_frame_component (const GstVideoFrame * frame, guint c, gint x,
    gint y);

/* Fails unless every pixel of `buffer`, of these caps, has that level. */
void stab_frame_assert_level (GstBuffer * buffer, GstCaps * caps, guint8 level);

/* Frames `start` to `start + n - 1`; each must be taken with GST_FLOW_OK. */
void stab_push_frames (GstHarness * h, guint start, guint n);

/* Pulls n frames, without waiting, that must be `start` and following, and nothing more be there. */
void stab_pull_frames (GstHarness * h, guint start, guint n);

/* The stream's position as the element tells it downstream. */
GstClockTime stab_position (GstHarness * h);

/* What has come out since `stab_record_new`, in order: "f3 " for frame 3, the type's name for an event. */
GString *stab_record_new (GstHarness * h);

G_END_DECLS

#endif
