/* SPDX-License-Identifier: MIT */
/* The latency of the element: the duration of a window of frames. It answers latency queries, and gives the time after
 * which a frame has to leave so that the answer is true. */
#ifndef GST_L1L2_STAB_LATENCY_H
#define GST_L1L2_STAB_LATENCY_H

#include <gst/gst.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* its object lock guards the rest; not owned */
  GstClockTime latency;         /* `window` frame durations */
  GstClockTime limit;           /* for which a frame may be held: half a duration less, for rendering */
  gboolean has_upstream;        /* upstream has answered a latency query ... */
  gboolean is_live;             /* ... and this is its answer */
} GstL1L2StabLatency;

void gst_l1l2_stab_latency_init (GstL1L2StabLatency * latency,
    GstElement * element);

/* Sets the latency to a window of frames of these caps, and posts a latency message if it changed. NULL: a new stream,
 * whose caps are not known yet. */
void gst_l1l2_stab_latency_set (GstL1L2StabLatency * latency, gint window,
    const GstCaps * caps);

/* Answers a latency query of the source pad: the latency of upstream plus that of the element. Sums that would overflow
 * are the largest valid time. FALSE: upstream did not answer. */
gboolean gst_l1l2_stab_latency_query (GstL1L2StabLatency * latency,
    GstPad * sink_pad, GstQuery * query);

/* The time for which a frame may be held, so that it leaves within the latency. *grace, which may be NULL: the rest of
 * the latency. */
GstClockTime gst_l1l2_stab_latency_limit (GstL1L2StabLatency * latency,
    GstClockTime * grace);

/* True if upstream is live. Upstream is asked the first time. */
gboolean gst_l1l2_stab_latency_is_live (GstL1L2StabLatency * latency,
    GstPad * sink_pad);

G_END_DECLS

#endif
