/* SPDX-License-Identifier: MIT */
#include "gstl1l2stablatency.h"

/* Where the caps do not say: too long a latency does less harm than none. */
#define ASSUMED_FPS_N 25
#define ASSUMED_FPS_D 1

void
gst_l1l2_stab_latency_init (GstL1L2StabLatency * latency, GstElement * element)
{
  memset (latency, 0, sizeof (*latency));
  latency->element = element;
}

/* The rate; of a variable one the highest, which the caps may know. */
static gboolean
get_rate (const GstStructure * structure, gint * fps_n, gint * fps_d)
{
  return (gst_structure_get_fraction (structure, "framerate", fps_n, fps_d)
      && *fps_n > 0 && *fps_d > 0)
      || (gst_structure_get_fraction (structure, "max-framerate", fps_n, fps_d)
      && *fps_n > 0 && *fps_d > 0);
}

void
gst_l1l2_stab_latency_set (GstL1L2StabLatency * latency, gint window,
    const GstCaps * caps)
{
  gint fps_n, fps_d;
  GstClockTime time;
  gboolean changed;

  if (!caps || !get_rate (gst_caps_get_structure (caps, 0), &fps_n, &fps_d)) {
    fps_n = ASSUMED_FPS_N;
    fps_d = ASSUMED_FPS_D;
  }
  time = gst_util_uint64_scale (window * GST_SECOND, fps_d, fps_n);

  GST_OBJECT_LOCK (latency->element);
  changed = latency->latency != time;
  latency->latency = time;
  GST_OBJECT_UNLOCK (latency->element);
  if (caps && changed)
    gst_element_post_message (latency->element,
        gst_message_new_latency (GST_OBJECT_CAST (latency->element)));
}

gboolean
gst_l1l2_stab_latency_query (GstL1L2StabLatency * latency, GstPad * sink_pad,
    GstQuery * query)
{
  GstClockTime least, most;
  gboolean live;

  if (!gst_pad_peer_query (sink_pad, query))
    return FALSE;

  gst_query_parse_latency (query, &live, &least, &most);
  GST_OBJECT_LOCK (latency->element);
  least += latency->latency;
  if (GST_CLOCK_TIME_IS_VALID (most))
    most += latency->latency;
  GST_OBJECT_UNLOCK (latency->element);
  gst_query_set_latency (query, live, least, most);
  return TRUE;
}
