/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabinput.h"

static GstFlowReturn
apply_live_settings (GstL1L2StabOutput * output,
    GstL1L2StabSettings * settings, GstClockTime time)
{
  gdouble lambda, crop_ratio;

  gst_l1l2_stab_settings_sample (settings, time, &lambda, &crop_ratio);
  return gst_l1l2_stab_stream_set_live (&output->stream, lambda, crop_ratio);
}

GstFlowReturn
gst_l1l2_stab_input_frame (GstL1L2StabOutput * output,
    GstL1L2StabSettings * settings, GstBuffer * frame)
{
  const GstClockTime now = gst_l1l2_stab_output_now (output);
  const GstClockTime pts = GST_BUFFER_PTS (frame);
  const GstClockTime time =
      gst_l1l2_stab_glue_stream_time (&output->trans->segment, frame);
  /* In reverse a decoder marks each group of pictures, though none is missing. */
  const gboolean is_torn = GST_BUFFER_IS_DISCONT (frame)
      && output->trans->segment.rate > 0;
  GstFlowReturn ret = gst_l1l2_stab_output_take_flow (output);

  /* A frame that could not be pushed before, for want of a buffer, goes first in any case. */
  if (ret == GST_FLOW_OK && is_torn)
    ret = gst_l1l2_stab_output_drain (output);
  else if (ret == GST_FLOW_OK)
    ret = gst_l1l2_stab_output_push_ready (output);
  if (ret == GST_FLOW_OK)
    ret = apply_live_settings (output, settings, time);
  if (ret != GST_FLOW_OK) {
    gst_buffer_unref (frame);
    return ret;
  }
  ret = gst_l1l2_stab_stream_push (&output->stream, frame, now, time);
  if (ret == GST_FLOW_OK)
    ret = gst_l1l2_stab_output_hurry (output, GST_CLOCK_TIME_NONE, pts);
  return ret;
}

/* Time goes on without a frame. The event keeps its place behind the frames that came before it. FALSE: it can go now.
 * One without a duration, as when a file's picture ends before its sound, does not say when a frame comes: the sinks
 * wait for those that are held. */
static gboolean
add_gap (GstL1L2StabOutput * output, GstEvent * gap)
{
  GstClockTime position, duration;

  gst_event_parse_gap (gap, &position, &duration);
  if (!GST_CLOCK_TIME_IS_VALID (duration)) {
    gst_l1l2_stab_output_drain (output);
    return FALSE;
  }
  if (output->trans->segment.rate > 0)
    position += duration;
  gst_l1l2_stab_stream_add_event (&output->stream, gap);
  if (gst_l1l2_stab_output_hurry (output, GST_CLOCK_TIME_NONE,
          position) == GST_FLOW_OK)
    gst_l1l2_stab_output_push_ready (output);
  return TRUE;
}

gboolean
gst_l1l2_stab_input_event (GstL1L2StabOutput * output, GstEvent * event)
{
  const gboolean is_empty = gst_l1l2_stab_stream_is_empty (&output->stream);

  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_STREAM_START:
    case GST_EVENT_STREAM_GROUP_DONE:
    case GST_EVENT_SEGMENT_DONE:
    case GST_EVENT_EOS:
      gst_l1l2_stab_output_drain (output);
      return FALSE;
    case GST_EVENT_SEGMENT:
      gst_l1l2_stab_output_end_segment (output);
      return FALSE;
    case GST_EVENT_CAPS:
      /* They drain when they are adopted, if they are not the same as before. */
      return FALSE;
    case GST_EVENT_FLUSH_STOP:
      gst_l1l2_stab_output_flush (output);
      return FALSE;
    case GST_EVENT_GAP:
      return !is_empty && add_gap (output, event);
    default:
      if (is_empty || !GST_EVENT_IS_SERIALIZED (event))
        return FALSE;
      gst_l1l2_stab_stream_add_event (&output->stream, event);
      return TRUE;
  }
}
