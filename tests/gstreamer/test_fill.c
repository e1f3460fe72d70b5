/* SPDX-License-Identifier: MIT */
/* border=fill in the element: nothing is lost, late or kept too long, and what was filled is told. */
#include "motion_fixture.h"

#define FILL_FRAMES 4

/* A shake of some pixels, told by a file, so that borders have to be filled whatever the frames show. */
static GstHarness *
shaken (const gchar * border)
{
  GString *text = g_string_new ("l1l2stab-motion 1\nsize 160 120\n"
      "framerate 25/1\n");
  GstHarness *h;
  guint i;

  for (i = 0; i < N_FRAMES; i++)
    g_string_append_printf (text, "%" G_GUINT64_FORMAT
        " %d given 1 0 0 1 0 %d 0 1 %d\n", i * FRAME_DURATION, i == CUT,
        i % 2 ? 7 : -7, i % 3 ? 3 : -6);
  write_file ("in", text->str);
  g_string_free (text, TRUE);
  h = harness_new ("in", NULL);
  gst_util_set_object_arg (G_OBJECT (h->element), "border", border);
  g_object_set (h->element, "fill-frames", FILL_FRAMES, NULL);
  return h;
}

static gdouble
mean_of (GstHarness * h, const gchar * field)
{
  GstStructure *stats;
  gdouble mean = -1;

  g_object_get (h->element, "stats", &stats, NULL);
  fail_unless (gst_structure_get_double (stats, field, &mean));
  gst_structure_free (stats);
  return mean;
}

GST_START_TEST (every_frame_comes_out_once_and_its_shares_are_told)
{
  static const gchar *const borders[] = { "crop", "fill", "extend" };
  GstHarness *h = shaken (borders[__i__]);
  gdouble filled_sum = 0, extended_sum = 0, filled, extended;
  guint i;

  play (h);
  for (i = 0; i < N_FRAMES; i++) {
    push_frame (h, i);
    fail_unless_equals_int (gst_harness_buffers_received (h),
        i + 1 < WINDOW ? 0 : i + 2 - WINDOW);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = gst_harness_pull (h);
    GstMessage *message = stab_harness_message (h, GST_MESSAGE_ELEMENT);
    const GstStructure *frame = gst_message_get_structure (message);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    fail_unless (gst_structure_get_double (frame, "filled", &filled));
    fail_unless (gst_structure_get_double (frame, "extended", &extended));
    filled_sum += filled;
    extended_sum += extended;
    gst_message_unref (message);
    gst_buffer_unref (buffer);
  }
  fail_unless (ABS (mean_of (h, "filled-mean") - filled_sum / N_FRAMES) < 1e-9);
  fail_unless (ABS (mean_of (h, "extended-mean") - extended_sum / N_FRAMES) <
      1e-9);
  fail_unless_equals_int (filled_sum > 0, __i__ == 1);
  fail_unless_equals_int (extended_sum > 0, __i__ > 0);
  stab_harness_free (h);
}

GST_END_TEST;

/* How many pixels of a frame the map in its meta says were given by neighbors. -1: there is no map. */
static gint
count_filled (GstBuffer * buffer)
{
  GstCustomMeta *meta = gst_buffer_get_custom_meta (buffer, "GstL1L2StabMeta");
  GstBuffer *border_map = NULL;
  GstMapInfo memory;
  gint n = 0;
  gsize i;

  if (!gst_structure_get (gst_custom_meta_get_structure (meta), "border-map",
          GST_TYPE_BUFFER, &border_map, NULL))
    return -1;
  fail_unless (gst_buffer_map (border_map, &memory, GST_MAP_READ));
  fail_unless_equals_int (memory.size, 160 * 120);
  for (i = 0; i < memory.size; i++)
    n += memory.data[i] != 0 && memory.data[i] != 255;
  gst_buffer_unmap (border_map, &memory);
  gst_buffer_unref (border_map);
  return n;
}

GST_START_TEST (the_meta_tells_who_gave_each_pixel_where_it_is_asked_to)
{
  GstHarness *h = shaken (__i__ == 2 ? "crop" : "fill");
  gint sum = 0;
  guint i;

  g_object_set (h->element, "border-map", __i__ > 0, NULL);
  play (h);
  for (i = 0; i < N_FRAMES; i++)
    push_frame (h, i);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = gst_harness_pull (h);
    const gint n = count_filled (buffer);

    fail_unless_equals_int (n >= 0, __i__ == 1);
    sum += n;
    gst_buffer_unref (buffer);
  }
  if (__i__ == 1)
    fail_unless (ABS (mean_of (h, "filled-mean") - (gdouble) sum / N_FRAMES /
            (160 * 120)) < 1e-9);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (kept_frames_go_back_at_the_end_of_stream_and_at_a_flush)
{
  GstHarness *h = shaken ("fill");
  GstBuffer *pushed[N_FRAMES];
  GstSegment segment;
  guint i;

  play (h);
  for (i = 0; i < N_FRAMES; i++) {
    pushed[i] = stab_noise_new (i);
    GST_BUFFER_PTS (pushed[i]) = i * FRAME_DURATION;
    fail_unless_equals_int (gst_harness_push (h, gst_buffer_ref (pushed[i])),
        GST_FLOW_OK);
  }
  /* A frame that went out is kept for FILL_FRAMES more. */
  ASSERT_BUFFER_REFCOUNT (pushed[N_FRAMES - WINDOW - FILL_FRAMES], "old", 1);
  fail_unless (GST_MINI_OBJECT_REFCOUNT_VALUE (pushed[N_FRAMES - WINDOW - 1])
      > 1);
  if (__i__ == 0) {
    gst_harness_push_event (h, gst_event_new_eos ());
  } else {
    gst_harness_push_event (h, gst_event_new_flush_start ());
    gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
    gst_segment_init (&segment, GST_FORMAT_TIME);
    gst_harness_push_event (h, gst_event_new_segment (&segment));
  }
  for (i = 0; i < N_FRAMES; i++) {
    ASSERT_BUFFER_REFCOUNT (pushed[i], "input", 1);
    gst_buffer_unref (pushed[i]);
  }
  stab_harness_free (h);
}

GST_END_TEST;

/* It has buffers for the window, but not for the frames that are kept. */
GST_START_TEST (a_pool_without_room_for_kept_frames_is_not_starved)
{
  GstHarness *h = shaken ("fill");
  GstBufferPool *pool = gst_video_buffer_pool_new ();
  GstStructure *config = gst_buffer_pool_get_config (pool);
  GstCaps *caps = gst_caps_from_string (NOISE_CAPS);
  GstBufferPoolAcquireParams params = { 0 };
  GstVideoInfo info;
  guint i;

  gst_video_info_from_caps (&info, caps);
  gst_buffer_pool_config_set_params (config, caps, GST_VIDEO_INFO_SIZE (&info),
      0, WINDOW + FILL_FRAMES);
  fail_unless (gst_buffer_pool_set_config (pool, config));
  fail_unless (gst_buffer_pool_set_active (pool, TRUE));
  params.flags = GST_BUFFER_POOL_ACQUIRE_FLAG_DONTWAIT;
  play (h);
  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = NULL;

    fail_unless_equals_int (gst_buffer_pool_acquire_buffer (pool, &buffer,
            &params), GST_FLOW_OK);
    GST_BUFFER_PTS (buffer) = i * FRAME_DURATION;
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (h), N_FRAMES);
  gst_buffer_pool_set_active (pool, FALSE);
  gst_object_unref (pool);
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (whole_frames_of_the_crop_windows_size_are_refused)
{
  GstHarness *h = shaken ("fill");
  GstMessage *message;
  GError *error = NULL;
  gchar *debug = NULL;

  gst_util_set_object_arg (G_OBJECT (h->element), "output-size", "crop");
  gst_element_set_state (h->element, GST_STATE_PLAYING);
  gst_harness_set_src_caps_str (h, NOISE_CAPS);
  fail_unless (gst_harness_push (h, stab_noise_new (0)) < GST_FLOW_OK);
  message = stab_harness_message (h, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, &debug);
  fail_unless (strstr (error->message, "border=fill")
      || (debug && strstr (debug, "border=fill")), "%s, %s", error->message,
      debug);
  g_clear_error (&error);
  g_free (debug);
  gst_message_unref (message);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
fill_suite (void)
{
  Suite *suite = suite_create ("fill");
  TCase *tcase = tcase_create ("fill");

  tcase_add_checked_fixture (tcase, make_folder, remove_folder);
  tcase_add_loop_test (tcase,
      every_frame_comes_out_once_and_its_shares_are_told, 0, 3);
  tcase_add_loop_test (tcase,
      the_meta_tells_who_gave_each_pixel_where_it_is_asked_to, 0, 3);
  tcase_add_loop_test (tcase,
      kept_frames_go_back_at_the_end_of_stream_and_at_a_flush, 0, 2);
  tcase_add_test (tcase, a_pool_without_room_for_kept_frames_is_not_starved);
  tcase_add_test (tcase, whole_frames_of_the_crop_windows_size_are_refused);
  suite_add_tcase (suite, tcase);
  return suite;
}

GST_CHECK_MAIN (fill);
