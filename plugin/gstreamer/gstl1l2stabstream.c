/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabstream.h"

#include "gstl1l2staballoc.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug

/* A frame that the library holds. The library releases it after it has rendered it. */
typedef struct
{
  GList link;                   /* in `queue` */
  GQueue *queue;                /* NULL: not in a queue yet */
  GstBuffer *buffer;            /* timestamps, flags and metas; the pixels too, unless they were copied */
  GstVideoFrame pixels;         /* mapped for reading; holds a reference to the buffer that is mapped */
  GstClockTime arrival;         /* running time, or NONE */
  GstClockTime stream_time;     /* or NONE */
  GstL1L2StabMotion motion;     /* of motion-in, if there is one */
} HeldFrame;

/* An event that must not overtake the frames that came in before it. */
typedef struct
{
  GstEvent *event;
  guint64 n_before;             /* number of frames that came in before it */
} WaitingEvent;

void
gst_l1l2_stab_stream_init (GstL1L2StabStream * stream, GstElement * element)
{
  memset (stream, 0, sizeof (*stream));
  stream->element = element;
  gst_l1l2_stab_report_init (&stream->report, element);
  stream->log.object = GST_OBJECT_CAST (element);
  g_queue_init (&stream->held);
  g_queue_init (&stream->events);
}

static GstFlowReturn
flow (GstL1L2StabStream * stream, L1L2StabResult result)
{
  return gst_l1l2_stab_convert_result (stream->element, result, &stream->log);
}

static void
drop_own_pool (GstL1L2StabStream * stream)
{
  if (stream->own_pool)
    gst_buffer_pool_set_active (stream->own_pool, FALSE);
  gst_clear_object (&stream->own_pool);
}

gboolean
gst_l1l2_stab_stream_open (GstL1L2StabStream * stream,
    const L1L2StabConfig * settings, const GstVideoInfo * in_info,
    const GstVideoInfo * out_info)
{
  L1L2StabConfig config = *settings;

  gst_l1l2_stab_stream_reset (stream);
  l1l2stab_free (&stream->stab);
  drop_own_pool (stream);

  stream->in_info = *in_info;
  stream->out_info = *out_info;
  stream->most_held = settings->window +
      (settings->border == L1L2STAB_BORDER_FILL ? settings->fill_frames : 0);

  gst_l1l2_stab_convert_config (&config, in_info);
  gst_l1l2_stab_convert_logger (&config.logger, &stream->log);
  if (flow (stream, l1l2stab_create (&stream->stab, &config)) != GST_FLOW_OK)
    return FALSE;
  gst_l1l2_stab_report_use (&stream->report, stream->stab);
  return gst_l1l2_stab_motion_files_begin (&stream->files, in_info);
}

void
gst_l1l2_stab_stream_close (GstL1L2StabStream * stream)
{
  GstEvent *event;

  gst_l1l2_stab_stream_reset (stream);
  while ((event = gst_l1l2_stab_stream_due_event (stream)) != NULL)
    gst_event_unref (event);
  l1l2stab_free (&stream->stab);
  drop_own_pool (stream);
  g_clear_pointer (&stream->log.reason, g_free);
}

gboolean
gst_l1l2_stab_stream_is_empty (const GstL1L2StabStream * stream)
{
  return stream->n_in == stream->n_out
      && g_queue_is_empty ((GQueue *) & stream->events);
}

static void
held_frame_free (gpointer data)
{
  HeldFrame *held = data;

  if (held->queue)
    g_queue_unlink (held->queue, &held->link);
  if (held->pixels.buffer)
    gst_video_frame_unmap (&held->pixels);
  gst_buffer_unref (held->buffer);
  g_free (held);
}

/* Metas that describe the memory, or keep the memory of another buffer alive, are not kept with a copy. */
static gboolean
drop_memory_meta (GstBuffer * buffer, GstMeta ** meta, gpointer user_data)
{
  const GType api = (*meta)->info->api;

  if (gst_meta_api_type_has_tag (api,
          g_quark_from_static_string (GST_META_TAG_MEMORY_STR))
      || gst_meta_api_type_has_tag (api,
          g_quark_from_static_string (GST_META_TAG_MEMORY_REFERENCE_STR)))
    *meta = NULL;
  return TRUE;
}

/* Copies the pixels, so that upstream gets its buffer back at once. An empty buffer keeps the metadata. */
static GstBuffer *
copy_scarce (GstL1L2StabStream * stream, HeldFrame * held)
{
  GstBuffer *input = held->buffer;
  GstBuffer *copy;

  if (!stream->own_pool) {
    GST_INFO_OBJECT (stream->element, "upstream has too few buffers to hold "
        "%u of them: frames are copied", stream->most_held);
    stream->own_pool = gst_l1l2_stab_alloc_own_pool (&stream->in_info);
  }
  if (!stream->own_pool)
    return NULL;
  copy = gst_l1l2_stab_alloc_copy (stream->own_pool, input, &stream->in_info);

  held->buffer = gst_buffer_new ();
  gst_buffer_copy_into (held->buffer, input, GST_BUFFER_COPY_METADATA, 0, -1);
  gst_buffer_foreach_meta (held->buffer, drop_memory_meta, NULL);
  gst_buffer_unref (input);
  return copy;
}

/* Takes `buffer`. NULL: it cannot be mapped as a frame of the caps. */
static HeldFrame *
held_frame_new (GstL1L2StabStream * stream, GstBuffer * buffer)
{
  HeldFrame *held = g_new0 (HeldFrame, 1);
  GstBuffer *pixels;
  gboolean mapped = FALSE;

  held->buffer = buffer;
  if (gst_l1l2_stab_alloc_is_scarce (buffer, stream->most_held))
    pixels = copy_scarce (stream, held);
  else
    pixels = gst_buffer_ref (buffer);

  if (pixels) {
    mapped = gst_l1l2_stab_alloc_map (&held->pixels, &stream->in_info, pixels,
        GST_MAP_READ);
    gst_buffer_unref (pixels);
  }
  if (!mapped) {
    held->pixels.buffer = NULL;
    g_clear_pointer (&held, held_frame_free);
  }
  return held;
}

GstFlowReturn
gst_l1l2_stab_stream_set_live (GstL1L2StabStream * stream, gdouble lambda,
    gdouble crop_ratio)
{
  L1L2StabResult result = l1l2stab_set_lambda (stream->stab, lambda);

  if (result >= 0)
    result = l1l2stab_set_crop_ratio (stream->stab, crop_ratio);
  return flow (stream, result);
}

GstFlowReturn
gst_l1l2_stab_stream_push (GstL1L2StabStream * stream, GstBuffer * buffer,
    GstClockTime arrival, GstClockTime stream_time)
{
  L1L2StabFrame frame = { 0 };
  L1L2StabResult result;
  HeldFrame *held = held_frame_new (stream, buffer);

  if (!held) {
    GST_ELEMENT_ERROR (stream->element, STREAM, FORMAT,
        ("A buffer is too small for a frame of its caps, or for the rows that "
            "its video meta describes."), (NULL));
    return GST_FLOW_ERROR;
  }

  gst_l1l2_stab_convert_planes (&frame, &held->pixels);
  frame.pts = GST_BUFFER_PTS_IS_VALID (held->buffer) ?
      (gint64) GST_BUFFER_PTS (held->buffer) : L1L2STAB_NO_PTS;
  frame.opaque = held;
  frame.release = held_frame_free;
  held->arrival = arrival;
  held->stream_time = stream_time;
  if (!gst_l1l2_stab_motion_files_read (&stream->files, stream_time,
          &held->motion, &frame)) {
    held_frame_free (held);
    return GST_FLOW_ERROR;
  }

  result = l1l2stab_push (stream->stab, &frame);
  if (result == L1L2STAB_OK) {
    stream->n_in++;
    held->link.data = held;
    held->queue = &stream->held;
    g_queue_push_tail_link (held->queue, &held->link);
    gst_l1l2_stab_report_in (&stream->report);
    return flow (stream, l1l2stab_take_error (stream->stab));
  }
  held_frame_free (held);
  return flow (stream, result == L1L2STAB_AGAIN ? L1L2STAB_ERR_STATE : result);
}

static gboolean
has_been_held (const HeldFrame * held, GstClockTime limit, GstClockTime now,
    GstClockTime position)
{
  const GstClockTime pts = GST_BUFFER_PTS (held->buffer);

  if (GST_CLOCK_TIME_IS_VALID (now) && GST_CLOCK_TIME_IS_VALID (held->arrival)
      && now >= gst_l1l2_stab_convert_add_times (held->arrival, limit))
    return TRUE;
  /* The distance, because timestamps fall in reverse playback. */
  return GST_CLOCK_TIME_IS_VALID (position) && GST_CLOCK_TIME_IS_VALID (pts)
      && gst_l1l2_stab_convert_time_distance (pts, position) >= limit;
}

GstFlowReturn
gst_l1l2_stab_stream_hurry (GstL1L2StabStream * stream, GstClockTime limit,
    GstClockTime now, GstClockTime position)
{
  gint n = 0;
  GList *link;

  for (link = stream->held.head; link
      && has_been_held (link->data, limit, now, position); link = link->next)
    n++;
  if (n == 0)
    return GST_FLOW_OK;
  GST_LOG_OBJECT (stream->element, "%d of %u held frames are overdue", n,
      stream->held.length);
  return flow (stream, l1l2stab_hurry (stream->stab, n));
}

GstClockTime
gst_l1l2_stab_stream_due_time (const GstL1L2StabStream * stream,
    GstClockTime limit)
{
  const HeldFrame *oldest = g_queue_peek_head ((GQueue *) & stream->held);

  if (!oldest || !GST_CLOCK_TIME_IS_VALID (oldest->arrival))
    return GST_CLOCK_TIME_NONE;
  return gst_l1l2_stab_convert_add_times (oldest->arrival, limit);
}

GstFlowReturn
gst_l1l2_stab_stream_peek (GstL1L2StabStream * stream, GstBuffer ** next,
    GstClockTime * stream_time)
{
  void *opaque = NULL;
  L1L2StabResult result;

  *next = NULL;
  *stream_time = GST_CLOCK_TIME_NONE;
  if (!stream->stab)
    return GST_FLOW_OK;
  result = l1l2stab_peek (stream->stab, NULL, &opaque);
  if (result == L1L2STAB_OK) {
    const HeldFrame *held = opaque;

    *next = held->buffer;
    *stream_time = held->stream_time;
  }
  return flow (stream, result);
}

void
gst_l1l2_stab_stream_set_bypass (GstL1L2StabStream * stream, gboolean bypass)
{
  if (stream->stab)
    l1l2stab_set_bypass (stream->stab, bypass);
}

GstFlowReturn
gst_l1l2_stab_stream_render (GstL1L2StabStream * stream, GstBuffer * output,
    L1L2StabInfo * info)
{
  HeldFrame *held = g_queue_peek_head (&stream->held);
  const GstL1L2StabMotion motion = held->motion;
  const GstClockTime stream_time = held->stream_time;
  L1L2StabFrame frame = { 0 };
  L1L2StabResult result;
  GstVideoFrame pixels;

  if (!gst_l1l2_stab_alloc_map (&pixels, &stream->out_info, output,
          GST_MAP_WRITE)) {
    GST_ELEMENT_ERROR (stream->element, RESOURCE, WRITE,
        ("An output buffer is too small for a frame of its caps, or for the "
            "rows that its video meta describes."), (NULL));
    return GST_FLOW_ERROR;
  }
  gst_l1l2_stab_convert_planes (&frame, &pixels);
  /* The library may keep the frame, or release it. */
  held->queue = NULL;
  g_queue_unlink (&stream->held, &held->link);
  result = l1l2stab_pull (stream->stab, &frame, info);
  gst_video_frame_unmap (&pixels);

  if (result != L1L2STAB_OK) {
    held->queue = &stream->held;
    g_queue_push_head_link (&stream->held, &held->link);
    return flow (stream, result);
  }
  stream->n_out++;
  return gst_l1l2_stab_motion_files_write (&stream->files, stream_time,
      &motion, info) ? GST_FLOW_OK : GST_FLOW_ERROR;
}

GstBuffer *
gst_l1l2_stab_stream_border_map (const GstL1L2StabStream * stream)
{
  const gint width = GST_VIDEO_INFO_WIDTH (&stream->out_info);
  const gint height = GST_VIDEO_INFO_HEIGHT (&stream->out_info);
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, (gsize) width * height,
      NULL);
  GstMapInfo memory;
  L1L2StabResult result = L1L2STAB_ERR_NOMEM;

  if (gst_buffer_map (buffer, &memory, GST_MAP_WRITE)) {
    result = l1l2stab_border_map (stream->stab, memory.data, width);
    gst_buffer_unmap (buffer, &memory);
  }
  if (result != L1L2STAB_OK)
    gst_clear_buffer (&buffer);
  return buffer;
}

GstFlowReturn
gst_l1l2_stab_stream_finish (GstL1L2StabStream * stream)
{
  if (!stream->stab)
    return GST_FLOW_OK;
  return flow (stream, l1l2stab_finish (stream->stab));
}

void
gst_l1l2_stab_stream_reset (GstL1L2StabStream * stream)
{
  if (stream->stab)
    l1l2stab_reset (stream->stab);
  gst_l1l2_stab_report_dropped (&stream->report, stream->n_in - stream->n_out);
  stream->n_out = stream->n_in;
}

void
gst_l1l2_stab_stream_add_event (GstL1L2StabStream * stream, GstEvent * event)
{
  WaitingEvent *waiting = g_new (WaitingEvent, 1);

  waiting->event = event;
  waiting->n_before = stream->n_in;
  g_queue_push_tail (&stream->events, waiting);
}

GstEvent *
gst_l1l2_stab_stream_due_event (GstL1L2StabStream * stream)
{
  WaitingEvent *waiting = g_queue_peek_head (&stream->events);
  GstEvent *event;

  if (!waiting || waiting->n_before > stream->n_out)
    return NULL;
  event = waiting->event;
  g_free (g_queue_pop_head (&stream->events));
  return event;
}
