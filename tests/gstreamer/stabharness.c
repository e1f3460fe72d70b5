/* SPDX-License-Identifier: MIT */
#include "stabharness.h"

gboolean
stab_have_elements (const gchar * const *names)
{
  gboolean all = TRUE;

  for (; *names; names++) {
    if (!gst_registry_check_feature_version (gst_registry_get (), *names, 1, 0,
            0)) {
      g_print ("skipped: no element %s\n", *names);
      all = FALSE;
    }
  }
  return all;
}

GstHarness *
stab_harness_new (const gchar * caps, const gchar * property, ...)
{
  GstElementFactory *factory = gst_element_factory_find ("l1l2stab");
  GstElement *element;
  GstHarness *h;
  GstBus *bus;
  va_list properties;

  fail_unless (factory != NULL, "the element is not on GST_PLUGIN_PATH");
  va_start (properties, property);
  element = gst_element_factory_create_valist (factory, property, properties);
  va_end (properties);
  gst_object_unref (factory);
  fail_unless (element != NULL);

  bus = gst_bus_new ();
  gst_element_set_bus (element, bus);
  gst_object_unref (bus);

  h = gst_harness_new_with_element (element, "sink", "src");
  gst_object_unref (element);
  if (caps)
    gst_harness_set_src_caps_str (h, caps);
  return h;
}

void
stab_harness_free (GstHarness * h)
{
  gst_element_set_state (h->element, GST_STATE_NULL);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

void
stab_play_to_end (GstElement * pipeline, const gchar * what)
{
  GstBus *bus = gst_element_get_bus (pipeline);
  GstMessage *message;

  fail_if (gst_element_set_state (pipeline, GST_STATE_PLAYING) ==
      GST_STATE_CHANGE_FAILURE, "%s does not start", what);
  message = gst_bus_timed_pop_filtered (bus, 40 * GST_SECOND,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless (message && GST_MESSAGE_TYPE (message) == GST_MESSAGE_EOS,
      "%s: %" GST_PTR_FORMAT, what, message);
  gst_message_unref (message);
  gst_object_unref (bus);
}

GstMessage *
stab_harness_message (GstHarness * h, GstMessageType type)
{
  GstBus *bus = gst_element_get_bus (h->element);
  GstMessage *message = gst_bus_pop_filtered (bus, type);

  gst_object_unref (bus);
  return message;
}

guint8
stab_frame_level (guint index)
{
  return 20 + index % 200;
}

/* An 8-bit level as component c stores it in memory. */
static guint
component_level (const GstVideoFormatInfo * format, guint c, guint8 level)
{
  return level << (GST_VIDEO_FORMAT_INFO_DEPTH (format, c) - 8)
      << GST_VIDEO_FORMAT_INFO_SHIFT (format, c);
}

/* GStreamer 1.22 puts the second chroma component of P010 at byte 1 instead of 2. */
guint8 *
stab_frame_component (const GstVideoFrame * frame, guint c, gint x, gint y)
{
  guint8 *plane = GST_VIDEO_FRAME_PLANE_DATA (frame,
      GST_VIDEO_FRAME_COMP_PLANE (frame, c));
  gint offset = GST_VIDEO_FRAME_COMP_POFFSET (frame, c);

  if (GST_VIDEO_FRAME_COMP_DEPTH (frame, c) > 8)
    offset = GST_ROUND_UP_2 (offset);
  return plane + y * GST_VIDEO_FRAME_COMP_STRIDE (frame, c)
      + x * GST_VIDEO_FRAME_COMP_PSTRIDE (frame, c) + offset;
}

GstBuffer *
stab_frame_new (GstHarness * h, guint index)
{
  GstCaps *caps = gst_pad_get_current_caps (h->srcpad);
  GstVideoInfo info;
  GstVideoFrame frame;
  GstBuffer *buffer;
  guint c;
  gint x, y;

  fail_unless (gst_video_info_from_caps (&info, caps));
  gst_caps_unref (caps);
  buffer = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (&info), NULL);
  gst_buffer_memset (buffer, 0, stab_frame_level (index),
      GST_VIDEO_INFO_SIZE (&info));
  fail_unless (gst_video_frame_map (&frame, &info, buffer, GST_MAP_WRITE));
  for (c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS (&frame); c++) {
    const gboolean deep = GST_VIDEO_FRAME_COMP_DEPTH (&frame, c) > 8;
    const guint level = component_level (info.finfo, c,
        stab_frame_level (index));

    for (y = 0; deep && y < GST_VIDEO_FRAME_COMP_HEIGHT (&frame, c); y++) {
      for (x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH (&frame, c); x++)
        GST_WRITE_UINT16_LE (stab_frame_component (&frame, c, x, y), level);
    }
  }
  gst_video_frame_unmap (&frame);
  GST_BUFFER_PTS (buffer) = index * FRAME_DURATION;
  GST_BUFFER_DURATION (buffer) = FRAME_DURATION;
  return buffer;
}

GstBuffer *
stab_frame_new_at (GstHarness * h, GstClockTime pts, GstClockTime duration)
{
  GstBuffer *buffer = stab_frame_new (h, 0);

  GST_BUFFER_PTS (buffer) = pts;
  GST_BUFFER_DURATION (buffer) = duration;
  return buffer;
}

void
stab_frame_assert_level (GstBuffer * buffer, GstCaps * caps, guint8 level)
{
  GstVideoInfo info;
  GstVideoFrame frame;
  guint c;
  gint x, y;

  fail_unless (gst_video_info_from_caps (&info, caps));
  fail_unless (gst_video_frame_map (&frame, &info, buffer, GST_MAP_READ));
  for (c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS (&frame); c++) {
    const gboolean deep = GST_VIDEO_FRAME_COMP_DEPTH (&frame, c) > 8;
    const guint expected = component_level (info.finfo, c, level);

    for (y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT (&frame, c); y++) {
      for (x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH (&frame, c); x++) {
        const guint8 *at = stab_frame_component (&frame, c, x, y);
        const guint got = deep ? GST_READ_UINT16_LE (at) : at[0];

        if (got != expected)
          fail ("component %u at %d, %d: %u, not %u", c, x, y, got, expected);
      }
    }
  }
  gst_video_frame_unmap (&frame);
}

void
stab_push_frames (GstHarness * h, guint start, guint n)
{
  guint i;

  for (i = start; i < start + n; i++)
    fail_unless_equals_int (gst_harness_push (h, stab_frame_new (h, i)),
        GST_FLOW_OK);
}

void
stab_pull_frames (GstHarness * h, guint start, guint n)
{
  guint i;

  for (i = start; i < start + n; i++) {
    GstBuffer *buffer = gst_harness_try_pull (h);
    GstCaps *caps;

    fail_unless (buffer != NULL, "frame %u has not come out", i);
    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    fail_unless_equals_uint64 (GST_BUFFER_DURATION (buffer), FRAME_DURATION);
    caps = gst_pad_get_current_caps (h->sinkpad);
    stab_frame_assert_level (buffer, caps, stab_frame_level (i));
    gst_caps_unref (caps);
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
}

GstClockTime
stab_position (GstHarness * h)
{
  GstQuery *query = gst_query_new_position (GST_FORMAT_TIME);
  gint64 position;

  fail_unless (gst_pad_peer_query (h->sinkpad, query));
  gst_query_parse_position (query, NULL, &position);
  gst_query_unref (query);
  return position;
}

static GstPadProbeReturn
record (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  GString *line = user_data;

  if (GST_PAD_PROBE_INFO_TYPE (info) & GST_PAD_PROBE_TYPE_BUFFER)
    g_string_append_printf (line, "f%" G_GUINT64_FORMAT " ",
        GST_BUFFER_PTS (GST_PAD_PROBE_INFO_BUFFER (info)) / FRAME_DURATION);
  else
    g_string_append_printf (line, "%s ",
        GST_EVENT_TYPE_NAME (GST_PAD_PROBE_INFO_EVENT (info)));
  return GST_PAD_PROBE_OK;
}

static void
free_record (gpointer line)
{
  g_string_free (line, TRUE);
}

GString *
stab_record_new (GstHarness * h)
{
  GString *line = g_string_new (NULL);

  gst_pad_add_probe (h->sinkpad,
      GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM |
      GST_PAD_PROBE_TYPE_EVENT_FLUSH, record, line, free_record);
  return line;
}
