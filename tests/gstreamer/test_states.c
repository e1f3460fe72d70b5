/* SPDX-License-Identifier: MIT */
/* State changes: the element starts, stops and starts again, and keeps nothing of the stream before. */
#include "stabharness.h"

#define WINDOW 8

static void
count (GstElement * sink, GstBuffer * buffer, GstPad * pad, gpointer user_data)
{
  (*(guint *) user_data)++;
}

GST_START_TEST (a_hundred_restarts_give_all_frames_each_time)
{
  GstElement *pipeline = gst_parse_launch ("videotestsrc num-buffers=12 ! "
      "video/x-raw, width=64, height=48 ! l1l2stab window=8 ! "
      "fakesink name=sink signal-handoffs=true", NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  guint n = 0, round;

  g_signal_connect (sink, "handoff", G_CALLBACK (count), &n);
  for (round = 1; round <= 100; round++) {
    stab_play_to_end (pipeline, "the test source");
    fail_unless_equals_int (n, 12 * round);
    fail_unless_equals_int (gst_element_set_state (pipeline, GST_STATE_NULL),
        GST_STATE_CHANGE_SUCCESS);
  }
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

GST_START_TEST (a_seek_gives_all_frames_from_its_target_on)
{
  GstElement *pipeline = gst_parse_launch ("videotestsrc ! "
      "video/x-raw, width=64, height=48, framerate=10/1 ! l1l2stab window=8 ! "
      "fakesink name=sink signal-handoffs=true", NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  guint n = 0;

  gst_element_set_state (pipeline, GST_STATE_PAUSED);
  fail_unless_equals_int (gst_element_get_state (pipeline, NULL, NULL,
          30 * GST_SECOND), GST_STATE_CHANGE_SUCCESS);
  g_signal_connect (sink, "handoff", G_CALLBACK (count), &n);
  fail_unless (gst_element_seek (pipeline, 1, GST_FORMAT_TIME,
          GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE, GST_SEEK_TYPE_SET,
          GST_SECOND, GST_SEEK_TYPE_SET, 3 * GST_SECOND));
  stab_play_to_end (pipeline, "the test source");
  fail_unless_equals_int (n, 20);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

GST_START_TEST (stopping_releases_the_held_frames)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstBuffer *kept = stab_frame_new (h, 0);
  GstEvent *tag = gst_event_new_custom (GST_EVENT_CUSTOM_DOWNSTREAM,
      gst_structure_new_empty ("test"));

  gst_harness_push (h, gst_buffer_ref (kept));
  gst_harness_push_event (h, gst_event_ref (tag));
  fail_unless (GST_MINI_OBJECT_REFCOUNT_VALUE (kept) > 1);
  gst_element_set_state (h->element, GST_STATE_READY);
  ASSERT_BUFFER_REFCOUNT (kept, "frame", 1);
  ASSERT_MINI_OBJECT_REFCOUNT (tag, "event", 1);
  gst_buffer_unref (kept);
  gst_event_unref (tag);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (after_a_restart_nothing_of_the_old_stream_comes_out)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);

  stab_push_frames (h, 0, 5);
  gst_element_set_state (h->element, GST_STATE_READY);
  g_object_set (h->element, "window", 4, NULL);
  gst_element_set_state (h->element, GST_STATE_PLAYING);
  gst_harness_push_event (h, gst_event_new_stream_start ("again"));
  gst_harness_set_src_caps_str (h, "video/x-raw, format=NV12, width=32, "
      "height=32, framerate=25/1");
  stab_push_frames (h, 7, 4);
  stab_pull_frames (h, 7, 1);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_frame_before_any_caps_is_refused)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (h, gst_event_new_stream_start ("bare"));
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  fail_unless_equals_int (gst_harness_push (h,
          gst_buffer_new_allocate (NULL, 64 * 48 * 3 / 2, NULL)),
      GST_FLOW_NOT_NEGOTIATED);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
states_suite (void)
{
  Suite *s = suite_create ("states");
  TCase *tc = tcase_create ("states");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, a_hundred_restarts_give_all_frames_each_time);
  tcase_add_test (tc, a_seek_gives_all_frames_from_its_target_on);
  tcase_add_test (tc, stopping_releases_the_held_frames);
  tcase_add_test (tc, after_a_restart_nothing_of_the_old_stream_comes_out);
  tcase_add_test (tc, a_frame_before_any_caps_is_refused);
  return s;
}

GST_CHECK_MAIN (states);
