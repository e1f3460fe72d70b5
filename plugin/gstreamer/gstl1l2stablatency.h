/* SPDX-License-Identifier: MIT */
/* How long frames are held back: the window, as a time. It is told to whoever asks and kept to. */
#ifndef GST_L1L2_STAB_LATENCY_H
#define GST_L1L2_STAB_LATENCY_H

#include <gst/gst.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* its object lock guards the rest; not owned */
  GstClockTime latency;         /* `window` frame durations */
  GstClockTime limit;           /* after which a frame has to leave: half a duration sooner, for the time it takes */
  gboolean has_upstream;        /* upstream has answered ... */
  gboolean is_live;             /* ... whether it is live */
} GstL1L2StabLatency;

void gst_l1l2_stab_latency_init (GstL1L2StabLatency * latency,
    GstElement * element);

/* A window of frames of these caps: when that changes the latency, a message is posted. NULL: a new stream, of which
 * nothing is known yet. */
void gst_l1l2_stab_latency_set (GstL1L2StabLatency * latency, gint window,
    const GstCaps * caps);

/* Answers the query of the source pad: upstream's latency and ours. */
gboolean gst_l1l2_stab_latency_query (GstL1L2StabLatency * latency,
    GstPad * sink_pad, GstQuery * query);

/* How long a frame may be held, so that it leaves within the latency; *grace, which may be NULL: what is left then. */
GstClockTime gst_l1l2_stab_latency_limit (GstL1L2StabLatency * latency,
    GstClockTime * grace);

/* Is the source live? Upstream is asked where it has not been. */
gboolean gst_l1l2_stab_latency_is_live (GstL1L2StabLatency * latency,
    GstPad * sink_pad);

G_END_DECLS

#endif
