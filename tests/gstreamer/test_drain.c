/* SPDX-License-Identifier: MIT */
/* Draining: events that must not overtake the held frames push them out. A flush drops them. */
#include "stabharness.h"

#define WINDOW 8
#define BIGGER_CAPS \
  "video/x-raw, format=I420, width=96, height=64, framerate=25/1"

static GstHarness *
harness_with_frames (guint n)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);

  stab_push_frames (h, 0, n);
  return h;
}

static GstEvent *
segment_event (GstClockTime start)
{
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = segment.time = start;
  return gst_event_new_segment (&segment);
}

static GstEvent *
draining_event (gint which)
{
  switch (which) {
    case 0:
      return gst_event_new_eos ();
    case 1:
      return segment_event (5 * FRAME_DURATION);
    case 2:
      return gst_event_new_segment_done (GST_FORMAT_TIME, 5 * FRAME_DURATION);
    default:
      return gst_event_new_stream_start ("another");
  }
}

GST_START_TEST (held_frames_leave_before_an_event_that_ends_the_path)
{
  GstHarness *h = harness_with_frames (5);
  GString *out = stab_record_new (h);
  GstEvent *event = draining_event (__i__);
  gchar *expected = g_strdup_printf ("f0 f1 f2 f3 f4 %s ",
      GST_EVENT_TYPE_NAME (event));

  fail_unless (gst_harness_push_event (h, event));
  fail_unless_equals_string (out->str, expected);
  stab_pull_frames (h, 0, 5);
  g_free (expected);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_new_window_begins_after_a_new_segment)
{
  GstHarness *h = harness_with_frames (2 * WINDOW);
  GString *out = stab_record_new (h);

  gst_harness_push_event (h, segment_event (30 * FRAME_DURATION));
  fail_unless_equals_string (out->str, "f9 f10 f11 f12 f13 f14 f15 segment ");
  g_string_truncate (out, 0);
  stab_push_frames (h, 30, WINDOW - 1);
  fail_unless_equals_string (out->str, "");
  stab_push_frames (h, 30 + WINDOW - 1, 1);
  fail_unless_equals_string (out->str, "f30 ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (changed_caps_drain_with_the_old_caps)
{
  GstHarness *h = harness_with_frames (5);
  GString *out = stab_record_new (h);

  gst_harness_set_src_caps_str (h, BIGGER_CAPS);
  stab_push_frames (h, 5, WINDOW);
  fail_unless (g_str_has_prefix (out->str, "f0 f1 f2 f3 f4 caps "), "%s",
      out->str);
  fail_unless (g_str_has_suffix (out->str, "f5 "), "%s", out->str);
  stab_harness_free (h);
}

GST_END_TEST;

static gboolean
push_caps (GstHarness * h, const gchar * text)
{
  GstCaps *caps = gst_caps_from_string (text);
  gboolean ret = gst_harness_push_event (h, gst_event_new_caps (caps));

  gst_caps_unref (caps);
  return ret;
}

GST_START_TEST (the_same_caps_again_do_not_drain)
{
  GstHarness *h = harness_with_frames (5);
  GString *out = stab_record_new (h);

  fail_unless (push_caps (h, SMALL_CAPS));
  fail_unless_equals_string (out->str, "");
  stab_push_frames (h, 5, 3);
  fail_unless_equals_string (out->str, "f0 ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_reconfiguration_that_changes_nothing_does_not_drain)
{
  GstHarness *h = harness_with_frames (5);
  GString *out = stab_record_new (h);

  gst_harness_push_upstream_event (h, gst_event_new_reconfigure ());
  stab_push_frames (h, 5, 3);
  fail_unless_equals_string (out->str, "f0 ");
  stab_harness_free (h);
}

GST_END_TEST;

/* Pulls frames 0 to n - 1, of which frame `which` alone is marked as discontinuous. */
static void
pull_discont (GstHarness * h, guint n, guint which)
{
  guint i;

  for (i = 0; i < n; i++) {
    GstBuffer *buffer = gst_harness_pull (h);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    fail_unless_equals_int (GST_BUFFER_IS_DISCONT (buffer), i == which);
    gst_buffer_unref (buffer);
  }
}

GST_START_TEST (a_discontinuity_drains_the_old_frames_and_marks_the_new_one)
{
  GstHarness *h = harness_with_frames (5);
  GstBuffer *buffer = stab_frame_new (h, 5);

  GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 5);
  stab_push_frames (h, 6, 6);
  gst_harness_push_event (h, gst_event_new_eos ());
  pull_discont (h, 12, 5);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_discontinuity_of_the_first_frame_marks_no_other)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstBuffer *buffer = stab_frame_new (h, 0);

  GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
  gst_harness_push (h, buffer);
  stab_push_frames (h, 1, WINDOW - 2);
  fail_unless_equals_int (gst_harness_buffers_received (h), 0);
  stab_push_frames (h, WINDOW - 1, WINDOW);
  pull_discont (h, WINDOW, 0);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_drain_before_the_window_is_full_marks_no_other_frame)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstBuffer *buffer = stab_frame_new (h, 0);

  GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
  gst_harness_push (h, buffer);
  stab_push_frames (h, 1, 3);
  gst_harness_push_event (h, segment_event (0));
  stab_push_frames (h, 4, WINDOW);
  pull_discont (h, 5, 0);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (the_position_is_that_of_the_last_frame_out)
{
  GstHarness *h = harness_with_frames (WINDOW - 1);
  GstSegment segment;

  fail_unless_equals_uint64 (stab_position (h), 0);
  stab_push_frames (h, WINDOW - 1, 3);
  fail_unless_equals_uint64 (stab_position (h), 3 * FRAME_DURATION);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_uint64 (stab_position (h), (WINDOW + 2) * FRAME_DURATION);

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = segment.position = 50 * FRAME_DURATION;
  segment.time = 70 * FRAME_DURATION;
  gst_harness_push_event (h, gst_event_new_stream_start ("another"));
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  fail_unless_equals_uint64 (stab_position (h), 70 * FRAME_DURATION);
  stab_push_frames (h, 50, 2);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_uint64 (stab_position (h), 72 * FRAME_DURATION);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_drain_query_gives_upstream_its_frames_back)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstQuery *query = gst_query_new_drain ();
  GstBuffer *kept = stab_frame_new (h, 0);

  gst_harness_push (h, gst_buffer_ref (kept));
  stab_push_frames (h, 1, 4);
  fail_unless (GST_MINI_OBJECT_REFCOUNT_VALUE (kept) > 1);
  gst_pad_peer_query (h->srcpad, query);
  stab_pull_frames (h, 0, 5);
  ASSERT_BUFFER_REFCOUNT (kept, "input", 1);
  gst_buffer_unref (kept);
  gst_query_unref (query);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_flush_drops_the_held_frames_and_starts_a_new_path)
{
  GstHarness *h = harness_with_frames (5);
  GString *out = stab_record_new (h);

  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_harness_push_event (h, segment_event (0));
  stab_push_frames (h, 50, WINDOW);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_string (out->str, "flush-start flush-stop segment "
      "f50 f51 f52 f53 f54 f55 f56 f57 eos ");
  stab_harness_free (h);
}

GST_END_TEST;

static GstPadProbeReturn
note_block (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  g_atomic_int_inc ((gint *) user_data);
  return GST_PAD_PROBE_OK;
}

static gpointer
push_a_frame (gpointer user_data)
{
  GstHarness *h = user_data;

  return GINT_TO_POINTER (gst_harness_push (h, stab_frame_new (h, WINDOW - 1)));
}

GST_START_TEST (a_flush_unblocks_a_push)
{
  GstHarness *h = harness_with_frames (WINDOW - 1);
  gint n_blocked = 0;
  GThread *thread;

  gst_pad_add_probe (h->sinkpad,
      GST_PAD_PROBE_TYPE_BLOCK | GST_PAD_PROBE_TYPE_BUFFER, note_block,
      &n_blocked, NULL);
  thread = g_thread_new ("push", push_a_frame, h);
  while (!g_atomic_int_get (&n_blocked))
    g_thread_yield ();
  gst_harness_push_event (h, gst_event_new_flush_start ());
  fail_unless_equals_int (GPOINTER_TO_INT (g_thread_join (thread)),
      GST_FLOW_FLUSHING);
  stab_harness_free (h);
}

GST_END_TEST;

/* Here the task of the timer holds the stream lock. */
GST_START_TEST (a_flush_unblocks_a_push_that_the_timer_made)
{
  GstHarness *h = harness_with_frames (3);
  GString *out;
  gint n_blocked = 0;
  gulong probe;

  probe = gst_pad_add_probe (h->sinkpad,
      GST_PAD_PROBE_TYPE_BLOCK | GST_PAD_PROBE_TYPE_BUFFER, note_block,
      &n_blocked, NULL);
  fail_unless (gst_harness_crank_single_clock_wait (h));
  while (!g_atomic_int_get (&n_blocked))
    g_thread_yield ();
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_pad_remove_probe (h->sinkpad, probe);
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  out = stab_record_new (h);
  gst_harness_push_event (h, segment_event (0));
  stab_push_frames (h, 20, WINDOW);
  fail_unless_equals_string (out->str, "segment f20 ");
  stab_harness_free (h);
}

GST_END_TEST;

/* identity lets one buffer pass and then fails. */
GST_START_TEST (a_drain_stops_when_downstream_refuses_a_frame)
{
  GstHarness *h =
      gst_harness_new_parse ("l1l2stab window=8 ! identity error-after=2");
  GstBuffer *buffer;

  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  stab_push_frames (h, 0, 5);
  buffer = stab_frame_new (h, 5);
  GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_ERROR);
  stab_pull_frames (h, 0, 1);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
drain_suite (void)
{
  Suite *s = suite_create ("drain");
  TCase *tc = tcase_create ("drain");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      held_frames_leave_before_an_event_that_ends_the_path, 0, 4);
  tcase_add_test (tc, a_new_window_begins_after_a_new_segment);
  tcase_add_test (tc, changed_caps_drain_with_the_old_caps);
  tcase_add_test (tc, the_same_caps_again_do_not_drain);
  tcase_add_test (tc, a_reconfiguration_that_changes_nothing_does_not_drain);
  tcase_add_test (tc,
      a_discontinuity_drains_the_old_frames_and_marks_the_new_one);
  tcase_add_test (tc,
      a_discontinuity_of_the_first_frame_marks_no_other);
  tcase_add_test (tc, a_drain_before_the_window_is_full_marks_no_other_frame);
  tcase_add_test (tc, the_position_is_that_of_the_last_frame_out);
  tcase_add_test (tc, a_drain_query_gives_upstream_its_frames_back);
  tcase_add_test (tc, a_flush_drops_the_held_frames_and_starts_a_new_path);
  tcase_add_test (tc, a_flush_unblocks_a_push);
  tcase_add_test (tc, a_flush_unblocks_a_push_that_the_timer_made);
  tcase_add_test (tc, a_drain_stops_when_downstream_refuses_a_frame);
  return s;
}

GST_CHECK_MAIN (drain);
