/* SPDX-License-Identifier: MIT */
/* If the source is not live, only timestamps decide how long a frame has been held. */
#include <gst/check/gsttestclock.h>

#include "stabharness.h"

#define WINDOW 8
#define LATENCY (WINDOW * FRAME_DURATION)

static gboolean
not_live (GstPad * pad, GstObject * parent, GstQuery * query)
{
  if (GST_QUERY_TYPE (query) != GST_QUERY_LATENCY)
    return gst_pad_query_default (pad, parent, query);
  gst_query_set_latency (query, FALSE, 0, GST_CLOCK_TIME_NONE);
  return TRUE;
}

static GstHarness *
file_harness_new (void)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);

  gst_pad_set_query_function (h->srcpad, not_live);
  return h;
}

GST_START_TEST (the_timer_pushes_no_frame_of_a_source_that_is_not_live)
{
  GstHarness *h = file_harness_new ();
  GstTestClock *clock = gst_harness_get_testclock (h);

  stab_push_frames (h, 0, 3);
  gst_harness_set_time (h, 10 * LATENCY);
  stab_push_frames (h, 3, 1);
  fail_unless_equals_int (gst_test_clock_peek_id_count (clock), 0);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
  gst_object_unref (clock);
  stab_harness_free (h);
}

GST_END_TEST;

/* The index of the next frame after 0, 1, 2, and how many of these are then overdue: those 8 or more frames before
 * it. */
static const struct
{
  guint index, n_out;
} jumps[] = {
  {7, 0}, {8, 1}, {9, 2}, {10, 3}, {500, 3}
};

GST_START_TEST (a_jump_of_the_timestamps_releases_the_frames_before_it)
{
  GstHarness *h = file_harness_new ();

  stab_push_frames (h, 0, 3);
  stab_push_frames (h, jumps[__i__].index, 1);
  stab_pull_frames (h, 0, jumps[__i__].n_out);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (frames_of_a_variable_rate_keep_their_times_and_wait_no_longer)
{
  const guint steps[] = { 40, 120, 40, 7, 33, 400, 40, 61, 90, 25 };
  GstHarness *h = file_harness_new ();
  GstClockTime times[60], durations[60], in = 0;
  guint n_out = 0, i;

  for (i = 0; i < 60; i++) {
    GstBuffer *buffer;

    times[i] = in;
    durations[i] = steps[i % 10] * GST_MSECOND;
    in += durations[i];
    gst_harness_push (h, stab_frame_new_at (h, times[i], durations[i]));
    while ((buffer = gst_harness_try_pull (h)) != NULL) {
      fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), times[n_out]);
      fail_unless_equals_uint64 (GST_BUFFER_DURATION (buffer),
          durations[n_out]);
      gst_buffer_unref (buffer);
      n_out++;
    }
    fail_unless (times[i] - times[n_out] < LATENCY);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (n_out + gst_harness_buffers_in_queue (h), 60);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
file_suite (void)
{
  Suite *s = suite_create ("file");
  TCase *tc = tcase_create ("file");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, the_timer_pushes_no_frame_of_a_source_that_is_not_live);
  tcase_add_loop_test (tc,
      a_jump_of_the_timestamps_releases_the_frames_before_it, 0,
      G_N_ELEMENTS (jumps));
  tcase_add_test (tc,
      frames_of_a_variable_rate_keep_their_times_and_wait_no_longer);
  return s;
}

GST_CHECK_MAIN (file);
