/* SPDX-License-Identifier: MIT */
#include "gstl1l2stablatency.h"

#include "gstl1l2stabcaps.h"
#include "gstl1l2stabconvert.h"

/* The frame rate that is assumed if the caps have none: a latency that is too long does less harm than none. */
#define ASSUMED_FPS_N 25
#define ASSUMED_FPS_D 1

void
gst_l1l2_stab_latency_init (GstL1L2StabLatency * latency, GstElement * element)
{
  memset (latency, 0, sizeof (*latency));
  latency->element = element;
}

static gboolean
get_field (const GstStructure * structure, const gchar * field, gint * fps_n,
    gint * fps_d)
{
  return gst_structure_get_fraction (structure, field, fps_n, fps_d)
      && *fps_n > 0 && *fps_d > 0
      && gst_util_fraction_compare (*fps_n, *fps_d,
      GST_L1L2_STAB_MAX_FRAME_RATE, 1) <= 0;
}

/* The frame rate. If it is variable: the highest one, if the caps say it. */
static gboolean
get_rate (const GstStructure * structure, gint * fps_n, gint * fps_d)
{
  return get_field (structure, "framerate", fps_n, fps_d)
      || get_field (structure, "max-framerate", fps_n, fps_d);
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
  time = MIN (gst_util_uint64_scale (window * GST_SECOND, fps_d, fps_n),
      GST_CLOCK_TIME_NONE - 1);

  GST_OBJECT_LOCK (latency->element);
  changed = latency->latency != time;
  latency->latency = time;
  latency->limit = time - time / window / 2;
  if (!caps)
    latency->has_upstream = FALSE;
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
  latency->has_upstream = TRUE;
  latency->is_live = live;
  least = gst_l1l2_stab_convert_add_times (least, latency->latency);
  if (GST_CLOCK_TIME_IS_VALID (most))
    most = gst_l1l2_stab_convert_add_times (most, latency->latency);
  GST_OBJECT_UNLOCK (latency->element);
  gst_query_set_latency (query, live, least, most);
  return TRUE;
}

GstClockTime
gst_l1l2_stab_latency_limit (GstL1L2StabLatency * latency, GstClockTime * grace)
{
  GstClockTime limit;

  GST_OBJECT_LOCK (latency->element);
  limit = latency->limit;
  if (grace)
    *grace = latency->latency - latency->limit;
  GST_OBJECT_UNLOCK (latency->element);
  return limit;
}

gboolean
gst_l1l2_stab_latency_is_live (GstL1L2StabLatency * latency, GstPad * sink_pad)
{
  gboolean has_upstream, is_live;

  GST_OBJECT_LOCK (latency->element);
  has_upstream = latency->has_upstream;
  is_live = latency->is_live;
  GST_OBJECT_UNLOCK (latency->element);
  if (!has_upstream) {
    GstQuery *query = gst_query_new_latency ();

    is_live = FALSE;
    if (gst_l1l2_stab_latency_query (latency, sink_pad, query))
      gst_query_parse_latency (query, &is_live, NULL, NULL);
    gst_query_unref (query);
  }
  return is_live;
}
