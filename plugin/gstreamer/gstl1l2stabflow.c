/* SPDX-License-Identifier: MIT */
/* The path of a frame, from top to bottom:
 *
 *   gst_l1l2_stab_flow_take_frame   a buffer comes in; its property values are sampled; the stream holds the buffer and
 *                                   pushes it to the library
 *   release_overdue                 frames that have been held for the latency are made ready
 *   gst_l1l2_stab_flow_push_ready   for each frame that is ready:
 *     push_due_events                 the events that came in before the frame
 *     allocate_output                 an output buffer with the metadata of the held one
 *     render                          the stream renders the frame into it; its metas and its message are made
 *     gst_pad_push                    it goes downstream
 *
 * Then come the events, draining and flushing, the timer, and the position. */
#include "gstl1l2stabflow.h"

#include "gstl1l2stabmeta.h"

#include "gstl1l2stabcopymeta.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug

static GstFlowReturn release_overdue (GstL1L2StabFlow * flow, GstClockTime now,
    GstClockTime position);
static void push_due_events (GstL1L2StabFlow * flow);
static GstFlowReturn allocate_output (GstL1L2StabFlow * flow,
    GstBuffer * input, GstBuffer ** output);
static GstFlowReturn render (GstL1L2StabFlow * flow, GstClockTime stream_time,
    GstBuffer * output);
static void advance_position (GstL1L2StabFlow * flow, GstBuffer * output);
static GstClockTime arrival_time (GstL1L2StabFlow * flow);
static GstClockTime due_time (GstL1L2StabFlow * flow);

/* --- frames --- */

static GstFlowReturn
apply_live_settings (GstL1L2StabFlow * flow, GstClockTime stream_time)
{
  gdouble lambda, crop_ratio;

  gst_l1l2_stab_settings_sample (flow->settings, stream_time, &lambda,
      &crop_ratio);
  return gst_l1l2_stab_stream_set_live (&flow->stream, lambda, crop_ratio);
}

GstFlowReturn
gst_l1l2_stab_flow_take_frame (GstL1L2StabFlow * flow, GstBuffer * frame)
{
  const GstClockTime now = arrival_time (flow);
  const GstClockTime pts = GST_BUFFER_PTS (frame);
  const GstClockTime stream_time =
      gst_l1l2_stab_convert_stream_time (&flow->in_segment, pts);
  /* In reverse playback a decoder marks every group of pictures, although no frame is missing. */
  const gboolean ends_path = GST_BUFFER_IS_DISCONT (frame)
      && flow->in_segment.rate > 0;
  GstFlowReturn ret = flow->timer_flow;

  flow->timer_flow = GST_FLOW_OK;
  /* An earlier push can have failed for lack of a buffer. Then its frame is still held, and goes first. */
  if (ret == GST_FLOW_OK)
    ret = ends_path ? gst_l1l2_stab_flow_drain (flow)
        : gst_l1l2_stab_flow_push_ready (flow);
  if (ret == GST_FLOW_OK)
    ret = apply_live_settings (flow, stream_time);
  if (ret != GST_FLOW_OK) {
    gst_buffer_unref (frame);
    return ret;
  }
  ret = gst_l1l2_stab_stream_push (&flow->stream, frame, now, stream_time);
  if (ret != GST_FLOW_OK)
    return ret;
  return release_overdue (flow, GST_CLOCK_TIME_NONE, pts);
}

/* Makes the frames ready that have been held for the latency, at the running time `now` or because the input has come
 * to the timestamp `position`. Either may be NONE. */
static GstFlowReturn
release_overdue (GstL1L2StabFlow * flow, GstClockTime now,
    GstClockTime position)
{
  return gst_l1l2_stab_stream_hurry (&flow->stream,
      gst_l1l2_stab_latency_limit (&flow->latency, NULL), now, position);
}

GstFlowReturn
gst_l1l2_stab_flow_push_ready (GstL1L2StabFlow * flow)
{
  GstPad *src_pad = GST_BASE_TRANSFORM_SRC_PAD (flow->trans);
  GstClockTime stream_time;
  GstBuffer *input, *output;
  GstFlowReturn ret;

  do {
    push_due_events (flow);
    ret = gst_l1l2_stab_stream_peek (&flow->stream, &input, &stream_time);
    if (ret != GST_FLOW_OK || !input)
      break;
    output = NULL;
    ret = allocate_output (flow, input, &output);
    if (ret == GST_FLOW_OK)
      ret = render (flow, stream_time, output);
    if (ret != GST_FLOW_OK) {
      gst_clear_buffer (&output);
      break;
    }
    advance_position (flow, output);
    ret = gst_pad_push (src_pad, output);
  } while (ret == GST_FLOW_OK);

  flow->last_push_end = gst_l1l2_stab_timer_now (&flow->timer);
  gst_l1l2_stab_timer_set (&flow->timer,
      ret == GST_FLOW_OK ? due_time (flow) : GST_CLOCK_TIME_NONE);
  return ret;
}

static void
push_due_events (GstL1L2StabFlow * flow)
{
  GstEvent *event;

  while ((event = gst_l1l2_stab_stream_due_event (&flow->stream)) != NULL) {
    if (GST_EVENT_TYPE (event) == GST_EVENT_SEGMENT) {
      GST_OBJECT_LOCK (flow->trans);
      gst_event_copy_segment (event, &flow->trans->segment);
      GST_OBJECT_UNLOCK (flow->trans);
    }
    gst_pad_push_event (GST_BASE_TRANSFORM_SRC_PAD (flow->trans), event);
  }
}

/* The base class takes a buffer from the negotiated pool and copies timestamps, flags and metas from `input`. If there
 * is none, it posts no error. Events that drain return no result, so the frames would be lost unseen. */
static GstFlowReturn
allocate_output (GstL1L2StabFlow * flow, GstBuffer * input, GstBuffer ** output)
{
  GstBaseTransformClass *base = g_type_class_peek (GST_TYPE_BASE_TRANSFORM);
  const GstFlowReturn ret =
      base->prepare_output_buffer (flow->trans, input, output);

  if (ret == GST_FLOW_ERROR)
    GST_ELEMENT_ERROR (flow->trans, RESOURCE, NO_SPACE_LEFT,
        ("There is no memory for an output frame."),
        ("the negotiated buffer pool gave no buffer"));
  return ret;
}

static void
add_border_map (const GstL1L2StabStream * stream, GstBuffer * output)
{
  GstBuffer *border_map = gst_l1l2_stab_stream_border_map (stream);

  if (border_map)
    gst_l1l2_stab_meta_set_border_map (output, border_map);
  gst_clear_buffer (&border_map);
}

static GstFlowReturn
render (GstL1L2StabFlow * flow, GstClockTime stream_time, GstBuffer * output)
{
  GstL1L2StabStream *stream = &flow->stream;
  L1L2StabInfo info;
  GstL1L2StabMap map;
  GstFlowReturn ret;

  gst_l1l2_stab_stream_set_bypass (stream,
      gst_l1l2_stab_settings_sample_bypass (flow->settings, stream_time));
  ret = gst_l1l2_stab_stream_render (stream, output, &info);
  if (ret != GST_FLOW_OK)
    return ret;

  gst_l1l2_stab_map_init (&map, &info, &stream->in_info, &stream->out_info);
  gst_l1l2_stab_copy_meta_map_regions (output, &map, &stream->out_info);
  gst_l1l2_stab_report_out (&stream->report, output, &info, &map,
      &stream->in_info, &stream->out_info);
  if (gst_l1l2_stab_settings_flag (flow->settings,
          &flow->settings->border_map))
    add_border_map (stream, output);
  if (gst_l1l2_stab_settings_flag (flow->settings,
          &flow->settings->post_messages))
    gst_element_post_message (GST_ELEMENT_CAST (flow->trans),
        gst_l1l2_stab_report_message (&stream->report, output, &info,
            &flow->trans->segment));
  return GST_FLOW_OK;
}

/* --- events --- */

/* True if `next` gives every frame the same stream time and running time as `now` does: then the segment continues, and
 * only its end or its position has changed. Running time counts back from the stop in reverse playback, so there the
 * stop must be the same too. */
static gboolean
is_segment_update (const GstSegment * now, const GstSegment * next)
{
  GstSegment expected = *next;

  expected.position = now->position;
  expected.duration = now->duration;
  if (now->rate > 0)
    expected.stop = now->stop;
  return now->format != GST_FORMAT_UNDEFINED
      && gst_segment_is_equal (now, &expected);
}

static void
set_position (GstL1L2StabFlow * flow, GstClockTime position)
{
  GST_OBJECT_LOCK (flow->trans);
  flow->position = position;
  GST_OBJECT_UNLOCK (flow->trans);
}

/* A new segment ends the path, because its frames can be anywhere in the stream. An update of the same segment waits
 * for the frames that came in before it. */
static gboolean
take_segment (GstL1L2StabFlow * flow, GstEvent * event)
{
  const GstSegment *segment;
  gboolean is_update;

  gst_event_parse_segment (event, &segment);
  is_update = is_segment_update (&flow->in_segment, segment);
  if (!is_update) {
    gst_l1l2_stab_flow_drain (flow);
    set_position (flow, GST_CLOCK_TIME_NONE);
  }
  flow->in_segment = *segment;
  if (!is_update || gst_l1l2_stab_stream_is_empty (&flow->stream))
    return FALSE;
  gst_l1l2_stab_stream_add_event (&flow->stream, event);
  return TRUE;
}

/* A gap: time passes without a frame. A gap without a duration does not say when the next frame comes, for example when
 * the video of a file ends before its audio. The sinks then wait for the frames that are held, so these are pushed. */
static gboolean
take_gap (GstL1L2StabFlow * flow, GstEvent * event)
{
  GstClockTime position, duration;

  gst_event_parse_gap (event, &position, &duration);
  if (!GST_CLOCK_TIME_IS_VALID (duration)) {
    gst_l1l2_stab_flow_drain (flow);
    return FALSE;
  }
  if (flow->in_segment.rate > 0)
    position = gst_l1l2_stab_convert_add_times (position, duration);
  gst_l1l2_stab_stream_add_event (&flow->stream, event);
  if (release_overdue (flow, GST_CLOCK_TIME_NONE, position) == GST_FLOW_OK)
    gst_l1l2_stab_flow_push_ready (flow);
  return TRUE;
}

/* Drops all frames. A flush does not delete sticky events, so those that were held are stored on the source pad; a
 * segment is the exception. */
static void
flush (GstL1L2StabFlow * flow)
{
  GstPad *src_pad = GST_BASE_TRANSFORM_SRC_PAD (flow->trans);
  GstEvent *event;

  flow->timer_flow = GST_FLOW_OK;
  gst_segment_init (&flow->in_segment, GST_FORMAT_UNDEFINED);
  gst_l1l2_stab_stream_reset (&flow->stream);
  gst_l1l2_stab_motion_files_flush (&flow->stream.files);
  set_position (flow, GST_CLOCK_TIME_NONE);
  while ((event = gst_l1l2_stab_stream_due_event (&flow->stream)) != NULL) {
    if (GST_EVENT_IS_STICKY (event)
        && GST_EVENT_TYPE (event) != GST_EVENT_SEGMENT)
      gst_pad_store_sticky_event (src_pad, event);
    gst_event_unref (event);
  }
}

gboolean
gst_l1l2_stab_flow_take_event (GstL1L2StabFlow * flow, GstEvent * event)
{
  /* FLUSH_START and out-of-band events come from other threads, without the stream lock, while the streaming thread
   * works on the stream. So no field of the stream may be read here. */
  if (!GST_EVENT_IS_SERIALIZED (event))
    return FALSE;

  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_STREAM_START:
    case GST_EVENT_STREAM_GROUP_DONE:
    case GST_EVENT_SEGMENT_DONE:
    case GST_EVENT_EOS:
      gst_l1l2_stab_flow_drain (flow);
      return FALSE;
    case GST_EVENT_SEGMENT:
      return take_segment (flow, event);
    case GST_EVENT_CAPS:
      /* set_caps() drains if the caps differ from those before. */
      return FALSE;
    case GST_EVENT_FLUSH_STOP:
      flush (flow);
      return FALSE;
    default:
      break;
  }
  if (gst_l1l2_stab_stream_is_empty (&flow->stream))
    return FALSE;
  if (GST_EVENT_TYPE (event) == GST_EVENT_GAP)
    return take_gap (flow, event);
  gst_l1l2_stab_stream_add_event (&flow->stream, event);
  return TRUE;
}

/* --- drain, stop --- */

GstFlowReturn
gst_l1l2_stab_flow_drain (GstL1L2StabFlow * flow)
{
  GstL1L2StabStream *stream = &flow->stream;
  GstFlowReturn ret = GST_FLOW_OK;

  if (!gst_l1l2_stab_stream_is_empty (stream)) {
    GST_DEBUG_OBJECT (flow->trans, "draining");
    ret = gst_l1l2_stab_stream_finish (stream);
    if (ret == GST_FLOW_OK)
      ret = gst_l1l2_stab_flow_push_ready (flow);
    gst_l1l2_stab_stream_reset (stream);
  }
  push_due_events (flow);
  return ret;
}

void
gst_l1l2_stab_flow_stop (GstL1L2StabFlow * flow)
{
  gst_l1l2_stab_timer_stop (&flow->timer);
  flow->timer_flow = GST_FLOW_OK;
  gst_segment_init (&flow->in_segment, GST_FORMAT_UNDEFINED);
  gst_l1l2_stab_stream_close (&flow->stream);
  gst_l1l2_stab_motion_files_close (&flow->stream.files);
  set_position (flow, GST_CLOCK_TIME_NONE);
}

/* --- the timer: frames of a live source leave in time although no other frame comes in --- */

/* The running time at which a frame of a live source arrives, or NONE: the clock then releases no frame. */
static GstClockTime
arrival_time (GstL1L2StabFlow * flow)
{
  if (!gst_l1l2_stab_latency_is_live (&flow->latency,
          GST_BASE_TRANSFORM_SINK_PAD (flow->trans)))
    return GST_CLOCK_TIME_NONE;
  return gst_l1l2_stab_timer_now (&flow->timer);
}

/* The running time at which the oldest frame has to leave. While a push blocks, no frame can come in. So after a push
 * upstream gets a moment to deliver, as long as the sink still gets its frame in time. */
static GstClockTime
due_time (GstL1L2StabFlow * flow)
{
  GstClockTime limit, grace, due;

  limit = gst_l1l2_stab_latency_limit (&flow->latency, &grace);
  due = gst_l1l2_stab_stream_due_time (&flow->stream, limit);
  if (GST_CLOCK_TIME_IS_VALID (due)
      && GST_CLOCK_TIME_IS_VALID (flow->last_push_end))
    due = MAX (due, gst_l1l2_stab_convert_add_times (flow->last_push_end,
            grace));
  return due;
}

/* Called from the timer's task. */
static void
on_timer (gpointer user_data)
{
  GstL1L2StabFlow *flow = user_data;
  GstPad *sink_pad = GST_BASE_TRANSFORM_SINK_PAD (flow->trans);
  GstClockTime now, due;

  GST_PAD_STREAM_LOCK (sink_pad);
  now = gst_l1l2_stab_timer_now (&flow->timer);
  due = due_time (flow);
  if (!GST_CLOCK_TIME_IS_VALID (now) || !GST_CLOCK_TIME_IS_VALID (due)
      || now < due) {
    gst_l1l2_stab_timer_set (&flow->timer, due);
  } else {
    flow->timer_flow = release_overdue (flow, now, GST_CLOCK_TIME_NONE);
    if (flow->timer_flow == GST_FLOW_OK)
      flow->timer_flow = gst_l1l2_stab_flow_push_ready (flow);
  }
  GST_PAD_STREAM_UNLOCK (sink_pad);
}

/* --- the position --- */

/* In reverse playback a frame ends at its timestamp. */
static void
advance_position (GstL1L2StabFlow * flow, GstBuffer * output)
{
  const GstSegment *segment = &flow->trans->segment;
  GstClockTime end = GST_BUFFER_PTS (output);

  if (!GST_CLOCK_TIME_IS_VALID (end) || segment->format != GST_FORMAT_TIME)
    return;
  if (segment->rate > 0 && GST_BUFFER_DURATION_IS_VALID (output))
    end = gst_l1l2_stab_convert_add_times (end, GST_BUFFER_DURATION (output));
  if (GST_CLOCK_TIME_IS_VALID (segment->stop))
    end = MIN (end, segment->stop);
  set_position (flow, gst_segment_to_stream_time (segment, GST_FORMAT_TIME,
          end));
}

gboolean
gst_l1l2_stab_flow_query_position (GstL1L2StabFlow * flow, GstQuery * query)
{
  GstClockTime position;
  GstFormat format;

  gst_query_parse_position (query, &format, NULL);
  if (format != GST_FORMAT_TIME)
    return FALSE;
  GST_OBJECT_LOCK (flow->trans);
  position = flow->position;
  GST_OBJECT_UNLOCK (flow->trans);
  if (!GST_CLOCK_TIME_IS_VALID (position))
    return FALSE;
  gst_query_set_position (query, format, position);
  return TRUE;
}

/* --- object --- */

void
gst_l1l2_stab_flow_init (GstL1L2StabFlow * flow, GstBaseTransform * trans,
    GstL1L2StabSettings * settings)
{
  GstElement *element = GST_ELEMENT_CAST (trans);

  flow->trans = trans;
  flow->settings = settings;
  gst_l1l2_stab_latency_init (&flow->latency, element);
  gst_l1l2_stab_timer_init (&flow->timer, element, on_timer, flow);
  gst_l1l2_stab_stream_init (&flow->stream, element);
  gst_segment_init (&flow->in_segment, GST_FORMAT_UNDEFINED);
  flow->timer_flow = GST_FLOW_OK;
  flow->position = flow->last_push_end = GST_CLOCK_TIME_NONE;
}

void
gst_l1l2_stab_flow_clear (GstL1L2StabFlow * flow)
{
  gst_l1l2_stab_flow_stop (flow);
  gst_l1l2_stab_timer_clear (&flow->timer);
}
