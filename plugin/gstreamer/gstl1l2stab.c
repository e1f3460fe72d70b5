/* SPDX-License-Identifier: MIT */
/* The element: its class, its properties and states, and the methods that GstBaseTransform calls. Each method hands its
 * work to the file that is named after it; plugin.c documents the element for its users. */
#include "gstl1l2stab.h"

#include <gst/video/video.h>

#include "gstl1l2staballoc.h"
#include "gstl1l2stabarea.h"
#include "gstl1l2stabcaps.h"
#include "gstl1l2stabcopymeta.h"
#include "gstl1l2stabconvert.h"
#include "gstl1l2stabmeta.h"
#include "gstl1l2stabflow.h"
#include "gstl1l2stabreport.h"
#include "gstl1l2stabsettings.h"

GST_DEBUG_CATEGORY (gst_l1l2_stab_debug);
#define GST_CAT_DEFAULT gst_l1l2_stab_debug

struct _GstL1L2Stab
{
  GstBaseTransform parent;

  GstL1L2StabSettings settings; /* has its own lock */
  GstL1L2StabFlow flow;         /* the frames between the pads */
  GstL1L2StabArea area;         /* of the frames that is measured; open while the element is started */
};

G_DEFINE_TYPE (GstL1L2Stab, gst_l1l2_stab, GST_TYPE_BASE_TRANSFORM);
GST_ELEMENT_REGISTER_DEFINE (l1l2stab, "l1l2stab", GST_RANK_NONE,
    GST_TYPE_L1L2_STAB);

/* --- frames and events: gstl1l2stabflow.c has what happens to them --- */

static GstFlowReturn
gst_l1l2_stab_submit_input_buffer (GstBaseTransform * trans,
    gboolean is_discont, GstBuffer * input)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);
  GstFlowReturn ret;

  /* A dropped input frame would be a hole in the camera path, so QoS is switched off even if an application has
   * switched it on. */
  gst_base_transform_set_qos_enabled (trans, FALSE);
  /* The base class renegotiates if it has to, and leaves the frame in queued_buf. */
  ret = GST_BASE_TRANSFORM_CLASS (gst_l1l2_stab_parent_class)
      ->submit_input_buffer (trans, is_discont, input);
  if (ret != GST_FLOW_OK)
    return ret;
  return gst_l1l2_stab_flow_take_frame (&self->flow,
      g_steal_pointer (&trans->queued_buf));
}

/* Pushes the frames that are ready, and leaves the base class nothing to push. */
static GstFlowReturn
gst_l1l2_stab_generate_output (GstBaseTransform * trans, GstBuffer ** output)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);

  *output = NULL;
  /* Key frames alone show no motion: each one leaves by itself. */
  if (self->flow.in_segment.flags & GST_SEGMENT_FLAG_TRICKMODE_KEY_UNITS)
    return gst_l1l2_stab_flow_drain (&self->flow);
  return gst_l1l2_stab_flow_push_ready (&self->flow);
}

/* Never called, because generate_output() does not. The base class allocates output buffers only for an element that
 * has this method. */
static GstFlowReturn
gst_l1l2_stab_transform (GstBaseTransform * trans, GstBuffer * input,
    GstBuffer * output)
{
  g_return_val_if_reached (GST_FLOW_ERROR);
}

static gboolean
gst_l1l2_stab_sink_event (GstBaseTransform * trans, GstEvent * event)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);

  if (gst_l1l2_stab_flow_take_event (&self->flow, event))
    return TRUE;
  if (GST_EVENT_TYPE (event) == GST_EVENT_CAPS)
    gst_l1l2_stab_settings_adopt (&self->settings,
        GST_BASE_TRANSFORM_SINK_PAD (trans), event);
  return GST_BASE_TRANSFORM_CLASS (gst_l1l2_stab_parent_class)->sink_event
      (trans, event);
}

static gboolean
gst_l1l2_stab_src_event (GstBaseTransform * trans, GstEvent * event)
{
  if (GST_EVENT_TYPE (event) == GST_EVENT_NAVIGATION)
    event = gst_l1l2_stab_report_point_at_source (&GST_L1L2_STAB
        (trans)->flow.stream.report, event);
  return GST_BASE_TRANSFORM_CLASS (gst_l1l2_stab_parent_class)->src_event
      (trans, event);
}

static gboolean
gst_l1l2_stab_query (GstBaseTransform * trans, GstPadDirection direction,
    GstQuery * query)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);
  const GstQueryType type = GST_QUERY_TYPE (query);

  if (direction == GST_PAD_SRC && type == GST_QUERY_LATENCY)
    return gst_l1l2_stab_latency_query (&self->flow.latency,
        GST_BASE_TRANSFORM_SINK_PAD (trans), query);
  if (direction == GST_PAD_SRC && type == GST_QUERY_POSITION
      && gst_l1l2_stab_flow_query_position (&self->flow, query))
    return TRUE;
  /* Upstream wants its buffers back. The query is serialized with the frames. */
  if (direction == GST_PAD_SINK && type == GST_QUERY_DRAIN)
    gst_l1l2_stab_flow_drain (&self->flow);
  return GST_BASE_TRANSFORM_CLASS (gst_l1l2_stab_parent_class)->query (trans,
      direction, query);
}

/* --- negotiation --- */

static GstCaps *
gst_l1l2_stab_transform_caps (GstBaseTransform * trans,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter)
{
  L1L2StabConfig settings;

  gst_l1l2_stab_settings_in_use (&GST_L1L2_STAB (trans)->settings, &settings);
  return gst_l1l2_stab_caps_transform (&settings, direction, caps, filter);
}

/* Called when the caps of either pad have changed, before the new caps go downstream. */
static gboolean
gst_l1l2_stab_set_caps (GstBaseTransform * trans, GstCaps * in_caps,
    GstCaps * out_caps)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);
  L1L2StabConfig settings;
  GstVideoInfo in_info, out_info;

  if (!gst_l1l2_stab_convert_caps (&in_info, in_caps)
      || !gst_l1l2_stab_convert_caps (&out_info, out_caps))
    return FALSE;

  gst_l1l2_stab_flow_drain (&self->flow);
  gst_l1l2_stab_settings_in_use (&self->settings, &settings);
  if (!gst_l1l2_stab_area_apply (&self->area, GST_ELEMENT_CAST (self), &in_info,
          &settings))
    return FALSE;
  if (!gst_l1l2_stab_stream_open (&self->flow.stream, &settings, &in_info,
          &out_info))
    return FALSE;
  gst_l1l2_stab_latency_set (&self->flow.latency, settings.window, in_caps);
  return TRUE;
}

static gboolean
gst_l1l2_stab_propose_allocation (GstBaseTransform * trans,
    GstQuery * decide_query, GstQuery * query)
{
  gst_l1l2_stab_alloc_propose (query);
  return TRUE;
}

static gboolean
gst_l1l2_stab_decide_allocation (GstBaseTransform * trans, GstQuery * query)
{
  gst_l1l2_stab_alloc_decide (query);
  return GST_BASE_TRANSFORM_CLASS (gst_l1l2_stab_parent_class)
      ->decide_allocation (trans, query);
}

static gboolean
gst_l1l2_stab_transform_meta (GstBaseTransform * trans, GstBuffer * output,
    GstMeta * meta, GstBuffer * input)
{
  return gst_l1l2_stab_copy_meta_keeps (meta);
}

/* --- object --- */

static GstStateChangeReturn
gst_l1l2_stab_change_state (GstElement * element, GstStateChange transition)
{
  GstL1L2Stab *self = GST_L1L2_STAB (element);

  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING
      || transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    gst_l1l2_stab_timer_set_playing (&self->flow.timer,
        transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING);
  return GST_ELEMENT_CLASS (gst_l1l2_stab_parent_class)->change_state (element,
      transition);
}

static gboolean
gst_l1l2_stab_open_area (GstL1L2Stab * self)
{
  gchar *region, *mask;
  gboolean ok;

  gst_l1l2_stab_settings_dup_area (&self->settings, &region, &mask);
  ok = gst_l1l2_stab_area_open (&self->area, GST_ELEMENT_CAST (self), region,
      mask);
  g_free (region);
  g_free (mask);
  return ok;
}

static gboolean
gst_l1l2_stab_open_files (GstL1L2Stab * self)
{
  gchar *motion_in, *motion_out;
  L1L2StabConfig settings;
  gboolean ok;

  gst_l1l2_stab_settings_dup_files (&self->settings, &motion_in, &motion_out);
  ok = gst_l1l2_stab_motion_files_open (&self->flow.stream.files,
      GST_ELEMENT_CAST (self), motion_in, motion_out);
  gst_l1l2_stab_settings_in_use (&self->settings, &settings);
  if (ok && motion_in
      && settings.rolling_shutter != L1L2STAB_ROLLING_SHUTTER_NONE)
    GST_ELEMENT_WARNING (self, LIBRARY, SETTINGS,
        ("The rolling shutter is not corrected, because a motion file holds the camera's motion alone. Leave motion-in "
            "out to have it corrected, or set rolling-shutter=none."), (NULL));
  g_free (motion_in);
  g_free (motion_out);
  return ok;
}

/* Settings that contradict each other are an error before the stream begins. They do not depend on the frames, so the
 * check assumes some. */
static gboolean
gst_l1l2_stab_start (GstBaseTransform * trans)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);
  L1L2StabConfig settings;
  int delay;

  gst_l1l2_stab_settings_in_use (&self->settings, &settings);
  settings.format = L1L2STAB_FORMAT_GRAY8;
  settings.width = settings.height = GST_L1L2_STAB_MIN_SIZE;
  gst_l1l2_stab_convert_logger (&settings.logger, &self->flow.stream.log);
  delay = l1l2stab_config_delay (&settings);
  if (delay < 0) {
    gst_l1l2_stab_convert_result (GST_ELEMENT_CAST (self), delay,
        &self->flow.stream.log);
    return FALSE;
  }

  gst_l1l2_stab_latency_set (&self->flow.latency, settings.window, NULL);
  gst_l1l2_stab_report_start (&self->flow.stream.report);
  /* Opening motion-out empties it, so it comes last. */
  return gst_l1l2_stab_open_area (self) && gst_l1l2_stab_open_files (self);
}

static gboolean
gst_l1l2_stab_stop (GstBaseTransform * trans)
{
  GstL1L2Stab *self = GST_L1L2_STAB (trans);

  gst_l1l2_stab_flow_stop (&self->flow);
  gst_l1l2_stab_area_close (&self->area);
  gst_l1l2_stab_settings_release (&self->settings);
  return TRUE;
}

static GstStructure *
gst_l1l2_stab_get_stats (GstL1L2Stab * self)
{
  L1L2StabConfig settings;
  GstClockTime latency;

  gst_l1l2_stab_settings_in_use (&self->settings, &settings);
  GST_OBJECT_LOCK (self);
  latency = self->flow.latency.latency;
  GST_OBJECT_UNLOCK (self);
  return gst_l1l2_stab_report_stats (&self->flow.stream.report,
      settings.window, latency);
}

static void
gst_l1l2_stab_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  if (!gst_l1l2_stab_settings_set (&GST_L1L2_STAB (object)->settings, id,
          value))
    G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
}

static void
gst_l1l2_stab_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstL1L2Stab *self = GST_L1L2_STAB (object);

  if (id == GST_L1L2_STAB_PROP_STATS)
    g_value_take_boxed (value, gst_l1l2_stab_get_stats (self));
  else if (!gst_l1l2_stab_settings_get (&self->settings, id, value))
    G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
}

static void
gst_l1l2_stab_finalize (GObject * object)
{
  GstL1L2Stab *self = GST_L1L2_STAB (object);

  gst_l1l2_stab_flow_clear (&self->flow);
  gst_l1l2_stab_area_close (&self->area);
  gst_l1l2_stab_settings_clear (&self->settings);
  G_OBJECT_CLASS (gst_l1l2_stab_parent_class)->finalize (object);
}

static void
gst_l1l2_stab_class_init (GstL1L2StabClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (gst_l1l2_stab_debug, "l1l2stab", 0,
      "video stabilizer");

  object_class->set_property = gst_l1l2_stab_set_property;
  object_class->get_property = gst_l1l2_stab_get_property;
  object_class->finalize = gst_l1l2_stab_finalize;
  gst_l1l2_stab_settings_install (object_class);
  gst_l1l2_stab_meta_register ();

  gst_l1l2_stab_caps_add_templates (element_class);
  gst_element_class_set_static_metadata (element_class, "Video stabilizer",
      "Filter/Effect/Video", "Stabilizes shaky video, with a delay of one window of frames",
      "The l1l2stab authors");

  element_class->change_state = GST_DEBUG_FUNCPTR (gst_l1l2_stab_change_state);

  trans_class->start = GST_DEBUG_FUNCPTR (gst_l1l2_stab_start);
  trans_class->stop = GST_DEBUG_FUNCPTR (gst_l1l2_stab_stop);
  trans_class->transform_caps =
      GST_DEBUG_FUNCPTR (gst_l1l2_stab_transform_caps);
  trans_class->set_caps = GST_DEBUG_FUNCPTR (gst_l1l2_stab_set_caps);
  trans_class->sink_event = GST_DEBUG_FUNCPTR (gst_l1l2_stab_sink_event);
  trans_class->src_event = GST_DEBUG_FUNCPTR (gst_l1l2_stab_src_event);
  trans_class->query = GST_DEBUG_FUNCPTR (gst_l1l2_stab_query);
  trans_class->propose_allocation =
      GST_DEBUG_FUNCPTR (gst_l1l2_stab_propose_allocation);
  trans_class->decide_allocation =
      GST_DEBUG_FUNCPTR (gst_l1l2_stab_decide_allocation);
  trans_class->transform_meta =
      GST_DEBUG_FUNCPTR (gst_l1l2_stab_transform_meta);
  trans_class->submit_input_buffer =
      GST_DEBUG_FUNCPTR (gst_l1l2_stab_submit_input_buffer);
  trans_class->generate_output =
      GST_DEBUG_FUNCPTR (gst_l1l2_stab_generate_output);
  trans_class->transform = GST_DEBUG_FUNCPTR (gst_l1l2_stab_transform);
}

static void
gst_l1l2_stab_init (GstL1L2Stab * self)
{
  GstBaseTransform *trans = GST_BASE_TRANSFORM_CAST (self);

  gst_l1l2_stab_settings_init (&self->settings, GST_OBJECT_CAST (self));
  gst_l1l2_stab_flow_init (&self->flow, trans, &self->settings);

  gst_base_transform_set_passthrough (trans, FALSE);
  gst_base_transform_set_in_place (trans, FALSE);
  gst_base_transform_set_qos_enabled (trans, FALSE);
  /* The flag GAP of a frame is kept. */
  gst_base_transform_set_gap_aware (trans, TRUE);
  /* With output-size=crop, the size that downstream prefers is not the size to ask upstream for. */
  gst_base_transform_set_prefer_passthrough (trans, FALSE);
}
