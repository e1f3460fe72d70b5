/* SPDX-License-Identifier: MIT */
/* The frames that are held between the pads, the events among them, and the instance of the library. Frames go in by
 * push(), become ready, and come out by peek() and render(). The stream knows no pads and no base class. The stream
 * lock of the sink pad guards all of it. */
#ifndef GST_L1L2_STAB_STREAM_H
#define GST_L1L2_STAB_STREAM_H

#include <gst/gst.h>
#include <gst/video/video.h>

#include "gstl1l2stabconvert.h"
#include "gstl1l2stabmotionfiles.h"
#include "gstl1l2stabreport.h"

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* posts the errors; not owned */
  GstL1L2StabReport report;     /* has its own lock */
  GstL1L2StabMotionFiles files; /* the owner opens and closes them */
  GstL1L2StabLog log;
  L1L2Stab *stab;               /* NULL: closed */
  GstVideoInfo in_info;
  GstVideoInfo out_info;
  guint most_held;              /* frames: the window, and those that are kept to fill borders */
  GstBufferPool *own_pool;      /* for copies of the frames; NULL: upstream has enough buffers so far */
  guint64 n_in;                 /* number of frames that came in ... */
  guint64 n_out;                /* ... and of those among them that went out or were dropped */
  GQueue held;                  /* of HeldFrame: the frames that have to go out, oldest first */
  GQueue events;                /* of WaitingEvent: the events after held frames, oldest first */
} GstL1L2StabStream;

void gst_l1l2_stab_stream_init (GstL1L2StabStream * stream,
    GstElement * element);

/* Opens, or opens again, for frames of these caps. Frames that are still held are dropped, so drain before. FALSE: an
 * error was posted. */
gboolean gst_l1l2_stab_stream_open (GstL1L2StabStream * stream,
    const L1L2StabConfig * settings, const GstVideoInfo * in_info,
    const GstVideoInfo * out_info);

/* Drops everything. A closed stream may be closed again. */
void gst_l1l2_stab_stream_close (GstL1L2StabStream * stream);

/* True if neither a frame nor an event is held. */
gboolean gst_l1l2_stab_stream_is_empty (const GstL1L2StabStream * stream);

/* Sets lambda and crop ratio of the frames that are pushed from now on. */
GstFlowReturn gst_l1l2_stab_stream_set_live (GstL1L2StabStream * stream,
    gdouble lambda, gdouble crop_ratio);

/* Holds `buffer`, which is taken, and pushes its frame to the library. `arrival`: the running time at which it came in.
 * `stream_time`: the stream time of its timestamp. NONE: not known. */
GstFlowReturn gst_l1l2_stab_stream_push (GstL1L2StabStream * stream,
    GstBuffer * buffer, GstClockTime arrival, GstClockTime stream_time);

/* Makes the frames ready that have been held for `limit`, with the look-ahead that they have. A frame has been held
 * from its arrival to the running time `now`, and from its timestamp to the timestamp `position` that the input has
 * come to. Either may be NONE. */
GstFlowReturn gst_l1l2_stab_stream_hurry (GstL1L2StabStream * stream,
    GstClockTime limit, GstClockTime now, GstClockTime position);

/* The running time at which the oldest frame will have been held for `limit` since its arrival; NONE: never. */
GstClockTime gst_l1l2_stab_stream_due_time (const GstL1L2StabStream * stream,
    GstClockTime limit);

/* The next frame that is ready. *next: the held buffer with its timestamps, flags and metas; the stream owns it until
 * render() or reset(). NULL: no frame is ready. *stream_time: the stream time that push() was given. */
GstFlowReturn gst_l1l2_stab_stream_peek (GstL1L2StabStream * stream,
    GstBuffer ** next, GstClockTime * stream_time);

/* Sets the bypass of the frames that are rendered from now on. */
void gst_l1l2_stab_stream_set_bypass (GstL1L2StabStream * stream,
    gboolean bypass);

/* Renders the frame that peek() shows into `output` and releases the held one. *info: what was done to the frame. */
GstFlowReturn gst_l1l2_stab_stream_render (GstL1L2StabStream * stream,
    GstBuffer * output, L1L2StabInfo * info);

/* Who gave each pixel of the frame that was rendered last: a new buffer of one byte a pixel, row by row. NULL: with
 * border=crop there is nothing to tell. */
GstBuffer *gst_l1l2_stab_stream_border_map (const GstL1L2StabStream * stream);

/* Ends the path: all frames that are held become ready. Only after reset() can frames be pushed again. */
GstFlowReturn gst_l1l2_stab_stream_finish (GstL1L2StabStream * stream);

/* Drops the frames that are held and begins a new path. The events that waited for those frames are due. */
void gst_l1l2_stab_stream_reset (GstL1L2StabStream * stream);

/* Takes `event`, which becomes due when the frames that are held now have gone out. */
void gst_l1l2_stab_stream_add_event (GstL1L2StabStream * stream,
    GstEvent * event);

/* The next event that is due, or NULL. The caller owns it. */
GstEvent *gst_l1l2_stab_stream_due_event (GstL1L2StabStream * stream);

G_END_DECLS

#endif
