/* SPDX-License-Identifier: MIT */
/* Frames: one comes out for each that goes in, in order, with its own metadata. */
#include "stabharness.h"

#define WINDOW 8

static const guint counts[] =
    { 0, 1, 2, 3, WINDOW - 1, WINDOW, WINDOW + 1, 2 * WINDOW };

GST_START_TEST (every_frame_that_goes_in_comes_out_once_and_in_order)
{
  const guint n = counts[__i__];
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);

  stab_push_frames (h, 0, n);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  stab_pull_frames (h, 0, n);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (one_frame_comes_out_for_each_in_once_the_window_is_full)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  stab_push_frames (h, 0, WINDOW - 1);
  fail_unless_equals_int (gst_harness_buffers_received (h), 0);
  for (i = WINDOW - 1; i < 3 * WINDOW; i++) {
    stab_push_frames (h, i, 1);
    stab_pull_frames (h, i - (WINDOW - 1), 1);
  }
  stab_harness_free (h);
}

GST_END_TEST;

static const GstBufferFlags flags_of_frame[] = {
  GST_BUFFER_FLAG_DISCONT, 0, GST_BUFFER_FLAG_MARKER, GST_BUFFER_FLAG_CORRUPTED,
  GST_BUFFER_FLAG_GAP, GST_BUFFER_FLAG_DROPPABLE, 0, GST_BUFFER_FLAG_RESYNC, 0,
  GST_BUFFER_FLAG_HEADER | GST_BUFFER_FLAG_MARKER, 0, 0
};

GST_START_TEST (flags_and_offsets_stay_with_their_frame)
{
  const guint n = G_N_ELEMENTS (flags_of_frame);
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  for (i = 0; i < n; i++) {
    GstBuffer *buffer = stab_frame_new (h, i);

    GST_BUFFER_FLAG_SET (buffer, flags_of_frame[i]);
    GST_BUFFER_OFFSET (buffer) = 100 + i;
    GST_BUFFER_OFFSET_END (buffer) = 101 + i;
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < n; i++) {
    GstBuffer *buffer = gst_harness_pull (h);

    fail_unless_equals_int (GST_BUFFER_FLAGS (buffer) &
        ~GST_BUFFER_FLAG_TAG_MEMORY, flags_of_frame[i]);
    fail_unless_equals_uint64 (GST_BUFFER_OFFSET (buffer), 100 + i);
    fail_unless_equals_uint64 (GST_BUFFER_OFFSET_END (buffer), 101 + i);
    gst_buffer_unref (buffer);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (frames_without_timestamps_come_out_without)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  for (i = 0; i < WINDOW; i++) {
    GstBuffer *buffer = stab_frame_new (h, i);

    GST_BUFFER_PTS (buffer) = GST_BUFFER_DURATION (buffer) =
        GST_CLOCK_TIME_NONE;
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < WINDOW; i++) {
    GstBuffer *buffer = gst_harness_pull (h);

    fail_if (GST_BUFFER_PTS_IS_VALID (buffer));
    fail_if (GST_BUFFER_DURATION_IS_VALID (buffer));
    gst_buffer_unref (buffer);
  }
  stab_harness_free (h);
}

GST_END_TEST;

/* In reverse playback timestamps fall. */
GST_START_TEST (the_order_is_that_of_arrival_whatever_the_timestamps)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  for (i = 0; i < 2 * WINDOW; i++)
    stab_push_frames (h, 2 * WINDOW - 1 - i, 1);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < 2 * WINDOW; i++) {
    GstBuffer *buffer = gst_harness_pull (h);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer),
        (2 * WINDOW - 1 - i) * FRAME_DURATION);
    gst_buffer_unref (buffer);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (the_input_is_not_changed_and_is_released)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstBuffer *kept[2 * WINDOW];
  guint i;

  for (i = 0; i < 2 * WINDOW; i++) {
    GstBuffer *frame = stab_frame_new (h, i);
    GstMemory *memory = gst_buffer_get_all_memory (frame);

    GST_MINI_OBJECT_FLAG_SET (memory, GST_MEMORY_FLAG_READONLY);
    gst_buffer_replace_all_memory (frame, memory);
    kept[i] = gst_buffer_ref (frame);
    fail_unless_equals_int (gst_harness_push (h, frame), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, 2 * WINDOW);
  for (i = 0; i < 2 * WINDOW; i++) {
    GstCaps *caps = gst_pad_get_current_caps (h->srcpad);

    stab_frame_assert_level (kept[i], caps, stab_frame_level (i));
    ASSERT_BUFFER_REFCOUNT (kept[i], "input", 1);
    gst_buffer_unref (kept[i]);
    gst_caps_unref (caps);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_buffer_too_small_for_its_caps_is_an_error)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstMessage *message;
  GError *error = NULL;

  stab_push_frames (h, 0, 2);
  fail_unless_equals_int (gst_harness_push (h,
          gst_buffer_new_allocate (NULL, 100, NULL)), GST_FLOW_ERROR);
  message = stab_harness_message (h, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, NULL);
  fail_unless (g_error_matches (error, GST_STREAM_ERROR,
          GST_STREAM_ERROR_FORMAT));
  g_clear_error (&error);
  gst_message_unref (message);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
frames_suite (void)
{
  Suite *s = suite_create ("frames");
  TCase *tc = tcase_create ("frames");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      every_frame_that_goes_in_comes_out_once_and_in_order, 0,
      G_N_ELEMENTS (counts));
  tcase_add_test (tc, one_frame_comes_out_for_each_in_once_the_window_is_full);
  tcase_add_test (tc, flags_and_offsets_stay_with_their_frame);
  tcase_add_test (tc, frames_without_timestamps_come_out_without);
  tcase_add_test (tc, the_order_is_that_of_arrival_whatever_the_timestamps);
  tcase_add_test (tc, the_input_is_not_changed_and_is_released);
  tcase_add_test (tc, a_buffer_too_small_for_its_caps_is_an_error);
  return s;
}

GST_CHECK_MAIN (frames);
