/* SPDX-License-Identifier: MIT */
/* No frame is held for longer than the reported latency, whether other frames come in or not. A test clock gives the
 * time. */
#include <gst/check/gsttestclock.h>

#include "stabharness.h"

#define WINDOW 8
#define LATENCY (WINDOW * FRAME_DURATION)
/* A frame leaves half a frame duration before the latency has passed. */
#define LIMIT (LATENCY - FRAME_DURATION / 2)

/* The source pad of a harness is live. */
static GstHarness *
live_harness_new (void)
{
  return stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
}

static GstClockTime
clock_time (GstHarness * h)
{
  GstTestClock *clock = gst_harness_get_testclock (h);
  const GstClockTime now = gst_clock_get_time (GST_CLOCK (clock));

  gst_object_unref (clock);
  return now;
}

/* Pushes the frame with this timestamp when the clock has this time. */
static void
push_live (GstHarness * h, GstClockTime pts)
{
  gst_harness_set_time (h, pts);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new_at (h, pts,
              FRAME_DURATION)), GST_FLOW_OK);
}

/* Pulls the frame with this timestamp, which must be there and not be late. */
static void
pull_in_time (GstHarness * h, GstClockTime pts)
{
  GstBuffer *buffer = gst_harness_pull (h);

  fail_unless (buffer != NULL);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), pts);
  fail_unless (clock_time (h) <= pts + LATENCY);
  gst_buffer_unref (buffer);
}

/* Advances the clock to this time, ending the waits on it one by one. The first wait can be for a frame that has
 * already left. */
static void
crank_to (GstHarness * h, GstClockTime time)
{
  do
    fail_unless (gst_harness_crank_single_clock_wait (h));
  while (clock_time (h) < time);
}

GST_START_TEST (frames_of_a_stalled_live_source_leave_by_the_clock)
{
  GstHarness *h = live_harness_new ();
  guint i;

  for (i = 0; i < 3; i++)
    push_live (h, i * FRAME_DURATION);
  for (i = 0; i < 3; i++) {
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
    fail_unless (gst_harness_crank_single_clock_wait (h));
    pull_in_time (h, i * FRAME_DURATION);
    fail_unless_equals_uint64 (clock_time (h), i * FRAME_DURATION + LIMIT);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_live_source_at_half_its_rate_is_in_time)
{
  const GstClockTime step = 2 * FRAME_DURATION;
  GstHarness *h = live_harness_new ();
  guint i;

  for (i = 0; i < 4; i++)
    push_live (h, i * step);
  for (i = 4; i < 40; i++) {
    fail_unless (gst_harness_crank_single_clock_wait (h));
    pull_in_time (h, (i - 4) * step);
    push_live (h, i * step);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_live_source_with_a_gap_of_three_seconds_is_in_time)
{
  GstHarness *h = live_harness_new ();
  const GstClockTime later = 20 * FRAME_DURATION + 3 * GST_SECOND;
  guint i;

  for (i = 0; i < 20; i++) {
    push_live (h, i * FRAME_DURATION);
    if (i >= WINDOW - 1)
      pull_in_time (h, (i - (WINDOW - 1)) * FRAME_DURATION);
  }
  for (i = 20 - WINDOW + 1; i < 20; i++) {
    crank_to (h, i * FRAME_DURATION + LIMIT);
    pull_in_time (h, i * FRAME_DURATION);
  }
  for (i = 0; i < 20; i++) {
    push_live (h, later + i * FRAME_DURATION);
    if (i >= WINDOW - 1)
      pull_in_time (h, later + (i - (WINDOW - 1)) * FRAME_DURATION);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_live_source_in_time_keeps_its_full_look_ahead)
{
  GstHarness *h = live_harness_new ();
  guint i;

  for (i = 0; i < 4 * WINDOW; i++) {
    push_live (h, i * FRAME_DURATION);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h),
        i >= WINDOW - 1 ? 1 : 0);
    if (i >= WINDOW - 1)
      pull_in_time (h, (i - (WINDOW - 1)) * FRAME_DURATION);
  }
  stab_harness_free (h);
}

GST_END_TEST;

static GstPadProbeReturn
take_three_durations (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  GstHarness *h = user_data;

  gst_harness_set_time (h, clock_time (h) + 3 * FRAME_DURATION);
  return GST_PAD_PROBE_OK;
}

/* The source waits while a push blocks, and delivers its frames as soon as the sink has taken one. */
GST_START_TEST (a_sink_that_blocks_shortens_no_look_ahead)
{
  GstHarness *h = live_harness_new ();
  guint i;

  gst_pad_add_probe (h->sinkpad, GST_PAD_PROBE_TYPE_BUFFER,
      take_three_durations, h, NULL);
  for (i = 0; i < WINDOW; i++)
    push_live (h, i * FRAME_DURATION);
  for (; i < 3 * WINDOW; i++) {
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 1);
    gst_buffer_unref (gst_harness_pull (h));
    fail_unless_equals_int (gst_harness_push (h, stab_frame_new_at (h,
                i * FRAME_DURATION, FRAME_DURATION)), GST_FLOW_OK);
  }
  stab_harness_free (h);
}

GST_END_TEST;

static const guint windows[] = { 4, 30, 150 };

GST_START_TEST (a_live_frames_delay_is_the_reported_latency_within_a_frame)
{
  const guint window = windows[__i__];
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", window, NULL);
  const GstClockTime reported = gst_harness_query_latency (h);
  guint i;

  for (i = 0; i < 2 * window; i++) {
    GstBuffer *buffer;

    push_live (h, i * FRAME_DURATION);
    buffer = gst_harness_try_pull (h);
    fail_unless_equals_int (buffer != NULL, i >= window - 1);
    if (buffer) {
      const GstClockTime delay = clock_time (h) - GST_BUFFER_PTS (buffer);

      fail_unless (delay <= reported && reported - delay <= FRAME_DURATION);
      gst_buffer_unref (buffer);
    }
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (an_event_that_waits_for_a_frame_leaves_with_it)
{
  GstHarness *h = live_harness_new ();
  GString *out;

  push_live (h, 0);
  out = stab_record_new (h);
  gst_harness_push_event (h, gst_event_new_tag (gst_tag_list_new (GST_TAG_TITLE,
              "one", NULL)));
  fail_unless_equals_string (out->str, "");
  fail_unless (gst_harness_crank_single_clock_wait (h));
  pull_in_time (h, 0);
  push_live (h, LATENCY);
  fail_unless_equals_string (out->str, "f0 tag ");
  stab_harness_free (h);
}

GST_END_TEST;

/* The base time is moved as a pipeline does it, so running time stands still. */
GST_START_TEST (no_time_passes_in_a_pause)
{
  const GstClockTime pause = 10 * GST_SECOND;
  GstHarness *h = live_harness_new ();

  push_live (h, 0);
  gst_element_set_state (h->element, GST_STATE_PAUSED);
  gst_harness_set_time (h, pause);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
  gst_element_set_base_time (h->element, pause);
  gst_element_set_state (h->element, GST_STATE_PLAYING);
  fail_unless (gst_harness_crank_single_clock_wait (h));
  gst_buffer_unref (gst_harness_pull (h));
  fail_unless_equals_uint64 (clock_time (h), pause + LIMIT);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (after_a_flush_the_timer_releases_no_old_frame)
{
  GstHarness *h = live_harness_new ();
  GstSegment segment;

  push_live (h, 0);
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (FALSE));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  push_live (h, FRAME_DURATION);
  crank_to (h, FRAME_DURATION + LIMIT);
  pull_in_time (h, FRAME_DURATION);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
  stab_harness_free (h);
}

GST_END_TEST;

/* The timer was set with the old latency. */
GST_START_TEST (after_the_latency_shrinks_a_frame_leaves_by_the_new_one)
{
  const GstClockTime duration = 10 * GST_MSECOND;
  GstHarness *h = live_harness_new ();

  push_live (h, 0);
  fail_unless (gst_harness_wait_for_clock_id_waits (h, 1, 10));
  gst_harness_set_src_caps_str (h, "video/x-raw, format=I420, width=64, "
      "height=48, framerate=100/1");
  pull_in_time (h, 0);
  push_live (h, FRAME_DURATION);
  fail_unless (gst_harness_crank_single_clock_wait (h));
  pull_in_time (h, FRAME_DURATION);
  fail_unless_equals_uint64 (clock_time (h),
      FRAME_DURATION + WINDOW * duration - duration / 2);
  stab_harness_free (h);
}

GST_END_TEST;

static GstPadProbeReturn
end_once (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  gint *n_ended = user_data;

  if (g_atomic_int_get (n_ended) > 0)
    return GST_PAD_PROBE_OK;
  gst_buffer_unref (GST_PAD_PROBE_INFO_BUFFER (info));
  GST_PAD_PROBE_INFO_FLOW_RETURN (info) = GST_FLOW_EOS;
  g_atomic_int_inc (n_ended);
  return GST_PAD_PROBE_HANDLED;
}

GST_START_TEST (a_flow_return_that_the_timer_got_goes_upstream_with_the_next_frame)
{
  GstHarness *h = live_harness_new ();
  GstPad *pad = gst_element_get_static_pad (h->element, "src");
  gint n_ended = 0;

  gst_pad_add_probe (pad, GST_PAD_PROBE_TYPE_BUFFER, end_once, &n_ended, NULL);
  push_live (h, 0);
  crank_to (h, LIMIT);
  while (g_atomic_int_get (&n_ended) == 0)
    g_usleep (1000);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new_at (h, LATENCY,
              FRAME_DURATION)), GST_FLOW_EOS);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new_at (h, LATENCY,
              FRAME_DURATION)), GST_FLOW_OK);
  gst_object_unref (pad);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (stopping_ends_the_wait)
{
  GstHarness *h = live_harness_new ();
  guint i;

  for (i = 0; i < 20; i++) {
    push_live (h, i * FRAME_DURATION);
    gst_element_set_state (h->element, GST_STATE_NULL);
    gst_element_set_state (h->element, GST_STATE_PLAYING);
    gst_harness_push_event (h, gst_event_new_stream_start ("again"));
    gst_harness_set_src_caps_str (h, SMALL_CAPS);
  }
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
time_suite (void)
{
  Suite *s = suite_create ("time");
  TCase *tc = tcase_create ("time");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, frames_of_a_stalled_live_source_leave_by_the_clock);
  tcase_add_test (tc, a_live_source_at_half_its_rate_is_in_time);
  tcase_add_test (tc, a_live_source_with_a_gap_of_three_seconds_is_in_time);
  tcase_add_test (tc, a_live_source_in_time_keeps_its_full_look_ahead);
  tcase_add_test (tc, a_sink_that_blocks_shortens_no_look_ahead);
  tcase_add_loop_test (tc,
      a_live_frames_delay_is_the_reported_latency_within_a_frame, 0,
      G_N_ELEMENTS (windows));
  tcase_add_test (tc, an_event_that_waits_for_a_frame_leaves_with_it);
  tcase_add_test (tc, no_time_passes_in_a_pause);
  tcase_add_test (tc, after_a_flush_the_timer_releases_no_old_frame);
  tcase_add_test (tc, after_the_latency_shrinks_a_frame_leaves_by_the_new_one);
  tcase_add_test (tc,
      a_flow_return_that_the_timer_got_goes_upstream_with_the_next_frame);
  tcase_add_test (tc, stopping_ends_the_wait);
  return s;
}

GST_CHECK_MAIN (time);
