/* SPDX-License-Identifier: MIT */
#include "gstl1l2staboutput.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug

static void
push_due_events (GstBaseTransform * trans, GstL1L2StabStream * stream)
{
  GstEvent *event;

  while ((event = gst_l1l2_stab_stream_due_event (stream)) != NULL)
    gst_pad_push_event (GST_BASE_TRANSFORM_SRC_PAD (trans), event);
}

/* The next frame that is ready, rendered; NULL: none. */
static GstFlowReturn
render_next (GstBaseTransform * trans, GstL1L2StabStream * stream,
    GstBuffer ** output)
{
  GstBaseTransformClass *klass = GST_BASE_TRANSFORM_GET_CLASS (trans);
  GstBuffer *input;
  GstFlowReturn ret;

  *output = NULL;
  ret = gst_l1l2_stab_stream_peek (stream, &input);
  if (ret != GST_FLOW_OK || !input)
    return ret;

  /* Timestamps, flags and metas are copied from the held buffer. */
  ret = klass->prepare_output_buffer (trans, input, output);
  if (ret == GST_FLOW_OK)
    ret = klass->transform (trans, input, *output);
  if (ret != GST_FLOW_OK)
    gst_clear_buffer (output);
  return ret;
}

/* Where playback is when this frame has been shown. */
static void
note_position (GstBaseTransform * trans, GstL1L2StabStream * stream,
    GstBuffer * output)
{
  GstClockTime position = GST_BUFFER_PTS (output);

  if (!GST_CLOCK_TIME_IS_VALID (position))
    return;
  if (trans->segment.rate > 0 && GST_BUFFER_DURATION_IS_VALID (output))
    position += GST_BUFFER_DURATION (output);
  GST_OBJECT_LOCK (trans);
  stream->position = position;
  GST_OBJECT_UNLOCK (trans);
}

GstFlowReturn
gst_l1l2_stab_output_push_ready (GstBaseTransform * trans,
    GstL1L2StabStream * stream)
{
  GstBuffer *output;
  GstFlowReturn ret;

  do {
    push_due_events (trans, stream);
    ret = render_next (trans, stream, &output);
    if (output) {
      note_position (trans, stream, output);
      ret = gst_pad_push (GST_BASE_TRANSFORM_SRC_PAD (trans), output);
    }
  } while (ret == GST_FLOW_OK && output);
  return ret;
}

GstFlowReturn
gst_l1l2_stab_output_drain (GstBaseTransform * trans,
    GstL1L2StabStream * stream)
{
  GstFlowReturn ret = GST_FLOW_OK;

  if (!gst_l1l2_stab_stream_is_empty (stream)) {
    GST_DEBUG_OBJECT (trans, "draining");
    ret = gst_l1l2_stab_stream_finish (stream);
    if (ret == GST_FLOW_OK)
      ret = gst_l1l2_stab_output_push_ready (trans, stream);
    gst_l1l2_stab_stream_reset (stream);
  }
  push_due_events (trans, stream);
  return ret;
}

void
gst_l1l2_stab_output_new_segment (GstBaseTransform * trans,
    GstL1L2StabStream * stream)
{
  GST_OBJECT_LOCK (trans);
  stream->position = GST_CLOCK_TIME_NONE;
  GST_OBJECT_UNLOCK (trans);
}

void
gst_l1l2_stab_output_flush (GstBaseTransform * trans,
    GstL1L2StabStream * stream)
{
  GstEvent *event;

  gst_l1l2_stab_stream_reset (stream);
  gst_l1l2_stab_output_new_segment (trans, stream);
  while ((event = gst_l1l2_stab_stream_due_event (stream)) != NULL) {
    if (GST_EVENT_IS_STICKY (event))
      gst_pad_store_sticky_event (GST_BASE_TRANSFORM_SRC_PAD (trans), event);
    gst_event_unref (event);
  }
}

gboolean
gst_l1l2_stab_output_query_position (GstBaseTransform * trans,
    GstL1L2StabStream * stream, GstQuery * query)
{
  GstClockTime position;
  GstFormat format;

  gst_query_parse_position (query, &format, NULL);
  if (format != GST_FORMAT_TIME || trans->segment.format != GST_FORMAT_TIME)
    return FALSE;
  GST_OBJECT_LOCK (trans);
  position = stream->position;
  GST_OBJECT_UNLOCK (trans);
  if (!GST_CLOCK_TIME_IS_VALID (position))
    return FALSE;
  gst_query_set_position (query, format,
      gst_segment_to_stream_time (&trans->segment, GST_FORMAT_TIME, position));
  return TRUE;
}
