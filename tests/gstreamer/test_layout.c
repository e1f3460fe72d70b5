/* SPDX-License-Identifier: MIT */
/* Buffers with any layout of planes and rows. */
#include "stabharness.h"

#define WINDOW 12
#define ODD_CAPS(format) \
  "video/x-raw, format=" format ", width=35, height=21, framerate=25/1"
#define PADDING 0xee

/* A frame with padding before its first byte, between its rows and between its planes. */
static GstBuffer *
padded_frame_new (GstHarness * h, guint index)
{
  GstBuffer *tight = stab_frame_new (h, index);
  GstCaps *caps = gst_pad_get_current_caps (h->srcpad);
  GstVideoInfo info, wide;
  GstVideoFrame from, to;
  GstVideoAlignment align;
  GstBuffer *buffer;
  guint p;

  fail_unless (gst_video_info_from_caps (&info, caps));
  gst_caps_unref (caps);
  wide = info;
  gst_video_alignment_reset (&align);
  align.padding_left = 8;
  align.padding_right = 24;
  align.padding_top = 4;
  align.padding_bottom = 6;
  fail_unless (gst_video_info_align (&wide, &align));
  for (p = 0; p < GST_VIDEO_INFO_N_PLANES (&wide); p++)
    wide.offset[p] += 64;

  buffer = gst_buffer_new_allocate (NULL, wide.size + 64, NULL);
  gst_buffer_memset (buffer, 0, PADDING, wide.size + 64);
  gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_INFO_FORMAT (&info), info.width, info.height,
      GST_VIDEO_INFO_N_PLANES (&info), wide.offset, wide.stride);
  gst_buffer_copy_into (buffer, tight, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);

  fail_unless (gst_video_frame_map (&from, &info, tight, GST_MAP_READ));
  fail_unless (gst_video_frame_map (&to, &info, buffer, GST_MAP_WRITE));
  fail_unless (GST_VIDEO_FRAME_PLANE_STRIDE (&to, 0)
      > GST_VIDEO_FRAME_PLANE_STRIDE (&from, 0));
  gst_video_frame_copy (&to, &from);
  gst_video_frame_unmap (&from);
  gst_video_frame_unmap (&to);
  gst_buffer_unref (tight);
  return buffer;
}

static const gchar *padded_caps[] = {
  ODD_CAPS ("I420"), ODD_CAPS ("NV12"), ODD_CAPS ("Y42B"), ODD_CAPS ("BGR"),
  ODD_CAPS ("RGBA"), ODD_CAPS ("GRAY8")
};

GST_START_TEST (padded_rows_and_moved_planes_are_honored)
{
  GstHarness *h = stab_harness_new (padded_caps[__i__], "window", WINDOW, NULL);
  guint i;

  for (i = 0; i < WINDOW + 2; i++)
    fail_unless_equals_int (gst_harness_push (h, padded_frame_new (h, i)),
        GST_FLOW_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, WINDOW + 2);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (planes_can_be_in_different_memories)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  for (i = 0; i < WINDOW; i++) {
    GstBuffer *whole = stab_frame_new (h, i);
    GstBuffer *parts = gst_buffer_copy_region (whole,
        GST_BUFFER_COPY_ALL, 0, 64 * 48);

    parts = gst_buffer_append (parts, gst_buffer_copy_region (whole,
            GST_BUFFER_COPY_MEMORY, 64 * 48, -1));
    fail_unless_equals_int (gst_buffer_n_memory (parts), 2);
    gst_buffer_copy_into (parts, whole, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
    gst_buffer_unref (whole);
    fail_unless_equals_int (gst_harness_push (h, parts), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, WINDOW);
  stab_harness_free (h);
}

GST_END_TEST;

/* What the sink pad of the harness answers: a pool whose frames have padding. */
static gboolean
offer_padded_pool (GstPad * pad, GstObject * parent, GstQuery * query)
{
  GstVideoAlignment align;
  GstStructure *config;
  GstBufferPool *pool;
  GstVideoInfo info;
  GstCaps *caps;

  if (GST_QUERY_TYPE (query) != GST_QUERY_ALLOCATION)
    return gst_pad_query_default (pad, parent, query);

  gst_query_parse_allocation (query, &caps, NULL);
  fail_unless (gst_video_info_from_caps (&info, caps));
  gst_video_alignment_reset (&align);
  align.padding_right = 30;
  align.padding_bottom = 2;
  pool = gst_video_buffer_pool_new ();
  config = gst_buffer_pool_get_config (pool);
  gst_buffer_pool_config_set_params (config, caps, info.size, 0, 0);
  gst_buffer_pool_config_add_option (config,
      GST_BUFFER_POOL_OPTION_VIDEO_ALIGNMENT);
  gst_buffer_pool_config_set_video_alignment (config, &align);
  fail_unless (gst_buffer_pool_set_config (pool, config));
  gst_query_add_allocation_pool (query, pool, info.size, 0, 0);
  gst_query_add_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  gst_object_unref (pool);
  return TRUE;
}

GST_START_TEST (downstreams_padded_buffers_are_filled)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstBuffer *buffer;
  GstCaps *caps;
  GstVideoMeta *meta;
  guint i;

  gst_pad_set_query_function (h->sinkpad, offer_padded_pool);
  gst_harness_set_src_caps_str (h, ODD_CAPS ("I420"));
  stab_push_frames (h, 0, WINDOW + 3);
  caps = gst_pad_get_current_caps (h->sinkpad);
  for (i = 0; i < 4; i++) {
    buffer = gst_harness_pull (h);
    meta = gst_buffer_get_video_meta (buffer);
    fail_unless (meta && meta->stride[0] > GST_ROUND_UP_4 (35));
    stab_frame_assert_level (buffer, caps, stab_frame_level (i));
    gst_buffer_unref (buffer);
  }
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

/* Video metas whose last row lies outside the buffer of 3072 bytes, or outside the memory that the plane begins in. */
static const struct
{
  gsize offset;
  gint stride, first_memory;
} false_metas[] = {
  {0, 66, 3072}, {1, 64, 3072}, {3000, 64, 3072}, {0, 1 << 30, 3072}, {0, -64, 3072}, {47 * 64 - 1, -64, 3072},
  {0, 64, 1000},
};

/* The buffer is taken, and the stream ends with an error. */
static void
push_refused (GstHarness * h, GstBuffer * buffer)
{
  GstMessage *message;

  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_ERROR);
  message = stab_harness_message (h, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_unref (message);
}

GST_START_TEST (a_meta_that_reaches_beyond_the_memory_is_an_error)
{
  GstHarness *h = stab_harness_new ("video/x-raw, format=GRAY8, width=64, "
      "height=48, framerate=25/1", "window", WINDOW, NULL);
  GstBuffer *buffer = gst_buffer_new ();
  gsize offset[GST_VIDEO_MAX_PLANES] = { false_metas[__i__].offset };
  gint stride[GST_VIDEO_MAX_PLANES] = { false_metas[__i__].stride };
  const gsize first_size = false_metas[__i__].first_memory;

  gst_buffer_append_memory (buffer, gst_allocator_alloc (NULL, first_size, NULL));
  if (first_size < 3072)
    gst_buffer_append_memory (buffer,
        gst_allocator_alloc (NULL, 3072 - first_size, NULL));
  gst_buffer_memset (buffer, 0, 0, 3072);
  gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_FORMAT_GRAY8, 64, 48, 1, offset, stride);
  push_refused (h, buffer);
  stab_harness_free (h);
}

GST_END_TEST;

/* Also where critical messages end the program, as in these tests. */
GST_START_TEST (a_meta_for_other_frames_than_those_of_the_caps_is_an_error)
{
  GstHarness *h = stab_harness_new ("video/x-raw, format=GRAY8, width=64, "
      "height=48, framerate=25/1", "window", WINDOW, NULL);
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, 3072, NULL);

  gst_buffer_add_video_meta (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      __i__ == 0 ? GST_VIDEO_FORMAT_I420 : GST_VIDEO_FORMAT_GRAY8,
      __i__ == 1 ? 63 : 64, __i__ == 2 ? 47 : 48);
  push_refused (h, buffer);
  stab_harness_free (h);
}

GST_END_TEST;

/* The last row ends with the last byte; from the bottom up too. */
GST_START_TEST (a_meta_that_reaches_to_the_last_byte_is_honored)
{
  GstHarness *h = stab_harness_new ("video/x-raw, format=GRAY8, width=63, "
      "height=48, framerate=25/1", "window", WINDOW, NULL);
  const gboolean bottom_up = __i__ == 1;
  const gsize size = 47 * 80 + 63;
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, size, NULL);
  gsize offset[GST_VIDEO_MAX_PLANES] = { bottom_up ? 47 * 80 : 0 };
  gint stride[GST_VIDEO_MAX_PLANES] = { bottom_up ? -80 : 80 };

  gst_buffer_memset (buffer, 0, 0, size);
  gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_FORMAT_GRAY8, 63, 48, 1, offset, stride);
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
layout_suite (void)
{
  Suite *s = suite_create ("layout");
  TCase *tc = tcase_create ("layout");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, padded_rows_and_moved_planes_are_honored, 0,
      G_N_ELEMENTS (padded_caps));
  tcase_add_test (tc, planes_can_be_in_different_memories);
  tcase_add_loop_test (tc, a_meta_that_reaches_beyond_the_memory_is_an_error, 0,
      G_N_ELEMENTS (false_metas));
  tcase_add_loop_test (tc, a_meta_for_other_frames_than_those_of_the_caps_is_an_error, 0, 3);
  tcase_add_loop_test (tc, a_meta_that_reaches_to_the_last_byte_is_honored, 0, 2);
  tcase_add_test (tc, downstreams_padded_buffers_are_filled);
  return s;
}

GST_CHECK_MAIN (layout);
