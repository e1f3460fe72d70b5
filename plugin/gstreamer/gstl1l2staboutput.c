/* SPDX-License-Identifier: MIT */
#include "gstl1l2staboutput.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug

static void
set_position (GstL1L2StabOutput * output, GstClockTime position)
{
  GST_OBJECT_LOCK (output->trans);
  output->position = position;
  GST_OBJECT_UNLOCK (output->trans);
}

/* The running time at which the oldest frame has to leave though no other has come in. While a push was blocked, others
 * could not come: they have a moment to do so, after which what the sink waited for is still in time. */
static GstClockTime
due_time (GstL1L2StabOutput * output)
{
  GstClockTime limit, grace, due;

  limit = gst_l1l2_stab_latency_limit (&output->latency, &grace);
  due = gst_l1l2_stab_stream_due_time (&output->stream, limit);
  if (GST_CLOCK_TIME_IS_VALID (due) && GST_CLOCK_TIME_IS_VALID (output->ready))
    due = MAX (due, output->ready + grace);
  return due;
}

/* From the timer's task. The next frame that comes in takes a flow return that is not OK upstream. */
static void
expire (gpointer user_data)
{
  GstL1L2StabOutput *output = user_data;
  GstPad *sink_pad = GST_BASE_TRANSFORM_SINK_PAD (output->trans);
  GstClockTime now, due;

  GST_PAD_STREAM_LOCK (sink_pad);
  now = gst_l1l2_stab_timer_now (&output->timer);
  due = due_time (output);
  if (!GST_CLOCK_TIME_IS_VALID (now) || !GST_CLOCK_TIME_IS_VALID (due)
      || now < due) {
    gst_l1l2_stab_timer_set (&output->timer, due);
  } else {
    output->flow = gst_l1l2_stab_output_hurry (output, now,
        GST_CLOCK_TIME_NONE);
    if (output->flow == GST_FLOW_OK)
      output->flow = gst_l1l2_stab_output_push_ready (output);
  }
  GST_PAD_STREAM_UNLOCK (sink_pad);
}

GstFlowReturn
gst_l1l2_stab_output_take_flow (GstL1L2StabOutput * output)
{
  const GstFlowReturn flow = output->flow;

  output->flow = GST_FLOW_OK;
  return flow;
}

void
gst_l1l2_stab_output_init (GstL1L2StabOutput * output, GstBaseTransform * trans)
{
  GstElement *element = GST_ELEMENT_CAST (trans);

  output->trans = trans;
  gst_l1l2_stab_latency_init (&output->latency, element);
  gst_l1l2_stab_timer_init (&output->timer, element, expire, output);
  gst_l1l2_stab_stream_init (&output->stream, element);
  output->flow = GST_FLOW_OK;
  output->position = output->ready = GST_CLOCK_TIME_NONE;
}

void
gst_l1l2_stab_output_clear (GstL1L2StabOutput * output)
{
  gst_l1l2_stab_output_stop (output);
  gst_l1l2_stab_timer_clear (&output->timer);
}

void
gst_l1l2_stab_output_stop (GstL1L2StabOutput * output)
{
  gst_l1l2_stab_timer_stop (&output->timer);
  output->flow = GST_FLOW_OK;
  gst_l1l2_stab_stream_close (&output->stream);
  gst_l1l2_stab_motion_close (&output->stream.files);
  set_position (output, GST_CLOCK_TIME_NONE);
}

GstClockTime
gst_l1l2_stab_output_now (GstL1L2StabOutput * output)
{
  if (!gst_l1l2_stab_latency_is_live (&output->latency,
          GST_BASE_TRANSFORM_SINK_PAD (output->trans)))
    return GST_CLOCK_TIME_NONE;
  return gst_l1l2_stab_timer_now (&output->timer);
}

GstFlowReturn
gst_l1l2_stab_output_hurry (GstL1L2StabOutput * output, GstClockTime now,
    GstClockTime position)
{
  return gst_l1l2_stab_stream_hurry (&output->stream,
      gst_l1l2_stab_latency_limit (&output->latency, NULL), now, position);
}

static void
push_due_events (GstL1L2StabOutput * output)
{
  GstEvent *event;

  while ((event = gst_l1l2_stab_stream_due_event (&output->stream)) != NULL)
    gst_pad_push_event (GST_BASE_TRANSFORM_SRC_PAD (output->trans), event);
}

/* The next frame that is ready, rendered; NULL: none. */
static GstFlowReturn
render_next (GstL1L2StabOutput * output, GstBuffer ** buffer)
{
  GstBaseTransformClass *klass = GST_BASE_TRANSFORM_GET_CLASS (output->trans);
  GstBuffer *input;
  GstFlowReturn ret;

  *buffer = NULL;
  ret = gst_l1l2_stab_stream_peek (&output->stream, &input);
  if (ret != GST_FLOW_OK || !input)
    return ret;

  /* Timestamps, flags and metas are copied from the held buffer. */
  ret = klass->prepare_output_buffer (output->trans, input, buffer);
  if (ret == GST_FLOW_OK)
    ret = klass->transform (output->trans, input, *buffer);
  if (ret != GST_FLOW_OK)
    gst_clear_buffer (buffer);
  return ret;
}

/* Where playback is when this frame has been shown. */
static void
note_position (GstL1L2StabOutput * output, GstBuffer * buffer)
{
  GstClockTime position = GST_BUFFER_PTS (buffer);

  if (!GST_CLOCK_TIME_IS_VALID (position))
    return;
  if (output->trans->segment.rate > 0 && GST_BUFFER_DURATION_IS_VALID (buffer))
    position += GST_BUFFER_DURATION (buffer);
  set_position (output, position);
}

GstFlowReturn
gst_l1l2_stab_output_push_ready (GstL1L2StabOutput * output)
{
  GstClockTime due = GST_CLOCK_TIME_NONE;
  GstBuffer *buffer;
  GstFlowReturn ret;

  do {
    push_due_events (output);
    ret = render_next (output, &buffer);
    if (buffer) {
      note_position (output, buffer);
      ret = gst_pad_push (GST_BASE_TRANSFORM_SRC_PAD (output->trans), buffer);
    }
  } while (ret == GST_FLOW_OK && buffer);

  output->ready = gst_l1l2_stab_timer_now (&output->timer);
  if (ret == GST_FLOW_OK)
    due = due_time (output);
  gst_l1l2_stab_timer_set (&output->timer, due);
  return ret;
}

GstFlowReturn
gst_l1l2_stab_output_drain (GstL1L2StabOutput * output)
{
  GstL1L2StabStream *stream = &output->stream;
  GstFlowReturn ret = GST_FLOW_OK;

  if (!gst_l1l2_stab_stream_is_empty (stream)) {
    GST_DEBUG_OBJECT (output->trans, "draining");
    ret = gst_l1l2_stab_stream_finish (stream);
    if (ret == GST_FLOW_OK)
      ret = gst_l1l2_stab_output_push_ready (output);
    gst_l1l2_stab_stream_reset (stream);
  }
  push_due_events (output);
  return ret;
}

void
gst_l1l2_stab_output_flush (GstL1L2StabOutput * output)
{
  GstEvent *event;

  output->flow = GST_FLOW_OK;
  gst_l1l2_stab_stream_reset (&output->stream);
  gst_l1l2_stab_motion_flush (&output->stream.files);
  set_position (output, GST_CLOCK_TIME_NONE);
  while ((event = gst_l1l2_stab_stream_due_event (&output->stream)) != NULL) {
    if (GST_EVENT_IS_STICKY (event))
      gst_pad_store_sticky_event (GST_BASE_TRANSFORM_SRC_PAD (output->trans),
          event);
    gst_event_unref (event);
  }
}

void
gst_l1l2_stab_output_end_segment (GstL1L2StabOutput * output)
{
  gst_l1l2_stab_output_drain (output);
  set_position (output, GST_CLOCK_TIME_NONE);
}

gboolean
gst_l1l2_stab_output_query_position (GstL1L2StabOutput * output,
    GstQuery * query)
{
  const GstSegment *segment = &output->trans->segment;
  GstClockTime position;
  GstFormat format;

  gst_query_parse_position (query, &format, NULL);
  if (format != GST_FORMAT_TIME || segment->format != GST_FORMAT_TIME)
    return FALSE;
  GST_OBJECT_LOCK (output->trans);
  position = output->position;
  GST_OBJECT_UNLOCK (output->trans);
  if (!GST_CLOCK_TIME_IS_VALID (position))
    return FALSE;
  gst_query_set_position (query, format,
      gst_segment_to_stream_time (segment, GST_FORMAT_TIME, position));
  return TRUE;
}
