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
} GstL1L2StabLatency;

void gst_l1l2_stab_latency_init (GstL1L2StabLatency * latency,
    GstElement * element);

/* A window of frames of these caps; NULL: not known yet. Posts a message when that changes the latency, which becomes
 * known to the pipeline only with the first caps. */
void gst_l1l2_stab_latency_set (GstL1L2StabLatency * latency, gint window,
    const GstCaps * caps);

/* Answers the query of the source pad: upstream's latency and ours. */
gboolean gst_l1l2_stab_latency_query (GstL1L2StabLatency * latency,
    GstPad * sink_pad, GstQuery * query);

G_END_DECLS

#endif
