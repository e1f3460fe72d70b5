/* SPDX-License-Identifier: MIT */
/* What is between the pads: the library's instance, the frames that it holds, and the events that came in among them.
 * No pads here and no base class. The sink pad's stream lock guards it all. */
#ifndef GST_L1L2_STAB_STREAM_H
#define GST_L1L2_STAB_STREAM_H

#include <gst/gst.h>
#include <gst/video/video.h>

#include "gstl1l2stabglue.h"
#include "gstl1l2stabmotion.h"
#include "gstl1l2stabreport.h"

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* posts the errors; not owned */
  GstL1L2StabReport report;     /* locks by itself */
  GstL1L2StabMotionFiles files; /* opened and closed by the owner */
  GstL1L2StabLog log;
  L1L2Stab *stab;               /* NULL: closed */
  GstVideoInfo in_info;
  GstVideoInfo out_info;
  guint window;                 /* frames */
  GstBufferPool *own_pool;      /* made when upstream's buffers are scarce */
  guint64 n_in;                 /* frames that came in ... */
  guint64 n_out;                /* ... and of these, went out or were dropped */
  GQueue held;                  /* the frames that the library holds, oldest first */
  GQueue events;                /* that wait for frames, oldest first */
} GstL1L2StabStream;

void gst_l1l2_stab_stream_init (GstL1L2StabStream * stream,
    GstElement * element);

/* (Re)opens for frames of these caps. Frames that are held are dropped: drain first. FALSE: an error was posted. */
gboolean gst_l1l2_stab_stream_open (GstL1L2StabStream * stream,
    const L1L2StabConfig * settings, const GstVideoInfo * in_info,
    const GstVideoInfo * out_info);

/* Drops everything; fine on a closed stream. */
void gst_l1l2_stab_stream_close (GstL1L2StabStream * stream);

/* No frame and no event is held. */
gboolean gst_l1l2_stab_stream_is_empty (const GstL1L2StabStream * stream);

/* For the frames that are pushed from now on. */
GstFlowReturn gst_l1l2_stab_stream_set_live (GstL1L2StabStream * stream,
    gdouble lambda, gdouble crop_ratio);

/* Takes `buffer`, which came in at `arrival`, a running time; `time` is its stream time. NONE: not known. */
GstFlowReturn gst_l1l2_stab_stream_push (GstL1L2StabStream * stream,
    GstBuffer * buffer, GstClockTime arrival, GstClockTime time);

/* Makes the frames ready that have been held for `limit`, and those before them, whatever look-ahead they have. Time is
 * counted from their arrival to `now`, a running time, and from their timestamp to `position`, which the input has come
 * to; either may be NONE. */
GstFlowReturn gst_l1l2_stab_stream_hurry (GstL1L2StabStream * stream,
    GstClockTime limit, GstClockTime now, GstClockTime position);

/* The running time at which a frame will have been held for `limit` since its arrival; NONE: never. */
GstClockTime gst_l1l2_stab_stream_due_time (const GstL1L2StabStream * stream,
    GstClockTime limit);

/* *next: the buffer whose timestamps, flags and metas belong to the next frame out; owned by the stream until
 * render() or reset(). NULL: none is ready. */
GstFlowReturn gst_l1l2_stab_stream_peek (GstL1L2StabStream * stream,
    GstBuffer ** next);

/* For the frames that are rendered from now on. */
void gst_l1l2_stab_stream_set_bypass (GstL1L2StabStream * stream,
    gboolean bypass);

/* Renders the frame that peek() shows into `output`, and lets go of it. *info: what was done to it. */
GstFlowReturn gst_l1l2_stab_stream_render (GstL1L2StabStream * stream,
    GstBuffer * output, L1L2StabInfo * info);

/* From now on peek() shows all that is held. Only reset() allows to push again. */
GstFlowReturn gst_l1l2_stab_stream_finish (GstL1L2StabStream * stream);

/* Drops the frames and forgets the path. The events that waited for them are due. */
void gst_l1l2_stab_stream_reset (GstL1L2StabStream * stream);

/* Takes `event`, to be given back when the frames that are held now are out. */
void gst_l1l2_stab_stream_add_event (GstL1L2StabStream * stream,
    GstEvent * event);

/* The next event whose turn it is, or NULL. */
GstEvent *gst_l1l2_stab_stream_due_event (GstL1L2StabStream * stream);

G_END_DECLS

#endif
