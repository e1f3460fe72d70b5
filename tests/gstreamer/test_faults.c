/* SPDX-License-Identifier: MIT */
/* Faults around the element: what each leaves behind, and how the stream goes on. docs/reliability.md has the table. */
#include "stabharness.h"

#define WINDOW 8
#define BIGGER_CAPS \
  "video/x-raw, format=I420, width=96, height=64, framerate=25/1"

/* ---- downstream refuses a frame ---- */

typedef struct
{
  guint seen;                   /* frames that have come to downstream */
  guint refused;                /* the index of the one that it refuses */
  GstFlowReturn flow;
} Refusal;

static GstPadProbeReturn
refuse (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  Refusal *refusal = user_data;

  if (refusal->seen++ != refusal->refused)
    return GST_PAD_PROBE_OK;
  gst_buffer_unref (GST_PAD_PROBE_INFO_BUFFER (info));
  GST_PAD_PROBE_INFO_FLOW_RETURN (info) = refusal->flow;
  return GST_PAD_PROBE_HANDLED;
}

static GstHarness *
harness_that_refuses (Refusal * refusal)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstPad *pad = gst_element_get_static_pad (h->element, "src");

  gst_pad_add_probe (pad, GST_PAD_PROBE_TYPE_BUFFER, refuse, refusal, NULL);
  gst_object_unref (pad);
  return h;
}

static const GstFlowReturn flows[] = {
  GST_FLOW_ERROR, GST_FLOW_EOS, GST_FLOW_FLUSHING, GST_FLOW_NOT_LINKED,
  GST_FLOW_NOT_NEGOTIATED, GST_FLOW_CUSTOM_ERROR
};

static void
count_down (gpointer user_data, GstMiniObject * object)
{
  g_atomic_int_dec_and_test ((gint *) user_data);
}

/* Pushes frame `index`, and counts it as long as it lives. */
static GstFlowReturn
push_counted (GstHarness * h, guint index, gint * alive)
{
  GstBuffer *buffer = stab_frame_new (h, index);

  g_atomic_int_inc (alive);
  gst_mini_object_weak_ref (GST_MINI_OBJECT (buffer), count_down, alive);
  return gst_harness_push (h, buffer);
}

static void
flush (GstHarness * h)
{
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
}

static void
drop_pulled (GstHarness * h)
{
  GstBuffer *buffer;

  while ((buffer = gst_harness_try_pull (h)))
    gst_buffer_unref (buffer);
}

GST_START_TEST (what_downstream_answers_goes_upstream_and_a_flush_recovers)
{
  static const guint places[] = { 0, 1, 5 };
  guint k;

  for (k = 0; k < G_N_ELEMENTS (places); k++) {
    Refusal refusal = { 0, places[k], flows[__i__] };
    GstHarness *h = harness_that_refuses (&refusal);
    gint alive = 0;
    guint i;

    for (i = 0; i < places[k] + WINDOW - 1; i++)
      fail_unless_equals_int (push_counted (h, i, &alive), GST_FLOW_OK);
    fail_unless_equals_int (push_counted (h, i, &alive), flows[__i__]);
    drop_pulled (h);

    flush (h);
    fail_unless_equals_int (g_atomic_int_get (&alive), 0);
    stab_push_frames (h, 0, 3 * WINDOW);
    fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
    stab_pull_frames (h, 0, 3 * WINDOW);
    stab_harness_free (h);
  }
}

GST_END_TEST;

GST_START_TEST (after_a_refused_frame_the_ones_behind_it_can_still_go_out)
{
  Refusal refusal = { 0, 2, flows[__i__] };
  GstHarness *h = harness_that_refuses (&refusal);
  guint i;

  for (i = 0; i < WINDOW + 1; i++)
    fail_unless_equals_int (gst_harness_push (h, stab_frame_new (h, i)),
        GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new (h, i)),
      flows[__i__]);
  stab_pull_frames (h, 0, 2);
  stab_push_frames (h, i + 1, WINDOW);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  stab_pull_frames (h, 3, 2 * WINDOW - 1);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_refusal_while_the_end_drains_releases_every_frame)
{
  Refusal refusal = { 0, 2, flows[__i__] };
  GstHarness *h = harness_that_refuses (&refusal);
  gint alive = 0;
  guint i;

  for (i = 0; i < WINDOW - 1; i++)
    fail_unless_equals_int (push_counted (h, i, &alive), GST_FLOW_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  drop_pulled (h);
  gst_element_set_state (h->element, GST_STATE_NULL);
  fail_unless_equals_int (g_atomic_int_get (&alive), 0);
  stab_harness_free (h);
}

GST_END_TEST;

/* ---- frames and streams that are not as they should be ---- */

GST_START_TEST (damaged_frames_and_durations_of_zero_come_out_as_they_came)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  for (i = 0; i < 2 * WINDOW; i++) {
    GstBuffer *buffer = stab_frame_new (h, i);

    GST_BUFFER_DURATION (buffer) = i % 3 ? FRAME_DURATION : 0;
    if (i % 4 == 1)
      GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_CORRUPTED);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  for (i = 0; i < 2 * WINDOW; i++) {
    GstBuffer *buffer = gst_harness_try_pull (h);

    fail_unless (buffer != NULL);
    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    fail_unless_equals_uint64 (GST_BUFFER_DURATION (buffer),
        i % 3 ? FRAME_DURATION : 0);
    fail_unless_equals_int (GST_BUFFER_FLAG_IS_SET (buffer,
            GST_BUFFER_FLAG_CORRUPTED), i % 4 == 1);
    gst_buffer_unref (buffer);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_source_that_stops_and_starts_loses_no_frame)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint part;

  for (part = 0; part < 3; part++) {
    if (part > 0) {
      GstSegment segment;

      gst_segment_init (&segment, GST_FORMAT_TIME);
      gst_harness_push_event (h, gst_event_new_stream_start ("again"));
      gst_harness_push_event (h, gst_event_new_segment (&segment));
    }
    stab_push_frames (h, 20 * part, 20);
    fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
    stab_pull_frames (h, 20 * part, 20);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (caps_that_change_in_the_middle_of_a_flush_hold_after_it)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstCaps *bigger = gst_caps_from_string (BIGGER_CAPS);
  GstSegment segment;

  stab_push_frames (h, 0, WINDOW - 1);
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  gst_harness_push_event (h, gst_event_new_caps (bigger));
  gst_caps_unref (bigger);
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_set_src_caps_str (h, BIGGER_CAPS);
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
  stab_push_frames (h, 0, 2 * WINDOW);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  stab_pull_frames (h, 0, 2 * WINDOW);
  stab_harness_free (h);
}

GST_END_TEST;

/* ---- pipelines ---- */

static void
count_frame (GstElement * sink, GstBuffer * buffer, GstPad * pad,
    gpointer user_data)
{
  g_atomic_int_inc ((gint *) user_data);
}

/* Plays a pipeline until it ends or fails within 40 seconds. Returns the name of the element that failed, or "". */
static gchar *
play (const gchar * description, gint * frames)
{
  GstElement *pipeline = gst_parse_launch (description, NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "counted");
  GstBus *bus = gst_element_get_bus (pipeline);
  GstMessage *message;
  gchar *failed;

  *frames = 0;
  if (sink) {
    g_object_set (sink, "signal-handoffs", TRUE, NULL);
    g_signal_connect (sink, "handoff", G_CALLBACK (count_frame), frames);
    gst_object_unref (sink);
  }
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, 40 * GST_SECOND,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless (message != NULL, "%s does not end", description);
  failed = g_strdup (GST_MESSAGE_TYPE (message) == GST_MESSAGE_ERROR ?
      GST_OBJECT_NAME (GST_MESSAGE_SRC (message)) : "");
  gst_message_unref (message);
  fail_unless_equals_int (gst_element_set_state (pipeline, GST_STATE_NULL),
      GST_STATE_CHANGE_SUCCESS);
  gst_object_unref (bus);
  gst_object_unref (pipeline);
  return failed;
}

static void
assert_played (const gchar * description, const gchar * failing, gint expected)
{
  gint frames;
  gchar *failed = play (description, &frames);

  fail_unless_equals_string (failed, failing);
  if (expected >= 0)
    fail_unless_equals_int (frames, expected);
  g_free (failed);
}

#define SMALL_SOURCE "videotestsrc num-buffers=40 ! " SMALL_CAPS " ! "

GST_START_TEST (a_full_disk_ends_the_pipeline_with_the_error_of_its_sink)
{
  assert_played (SMALL_SOURCE "l1l2stab window=8 ! "
      "filesink name=disk buffer-mode=unbuffered location=/dev/full", "disk",
      -1);
}

GST_END_TEST;

GST_START_TEST (an_error_downstream_ends_the_pipeline_with_that_error)
{
  assert_played (SMALL_SOURCE "l1l2stab window=8 ! "
      "identity name=broken error-after=5 ! fakesink", "broken", -1);
}

GST_END_TEST;

GST_START_TEST (after_an_error_upstream_all_frames_that_came_go_out)
{
  GstElement *pipeline = gst_parse_launch (SMALL_SOURCE
      "identity name=broken error-after=20 ! l1l2stab window=8 ! "
      "fakesink name=counted signal-handoffs=true", NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "counted");
  GstBus *bus = gst_element_get_bus (pipeline);
  GstMessage *message;
  gint frames = 0;
  guint waited;

  g_signal_connect (sink, "handoff", G_CALLBACK (count_frame), &frames);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, 40 * GST_SECOND,
      GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  fail_unless_equals_string (GST_OBJECT_NAME (GST_MESSAGE_SRC (message)),
      "broken");
  gst_message_unref (message);
  /* The source ends its stream after the error, which drains. */
  for (waited = 0; waited < 400 && g_atomic_int_get (&frames) < 19; waited++)
    g_usleep (G_USEC_PER_SEC / 100);
  fail_unless_equals_int (g_atomic_int_get (&frames), 19);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (bus);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

GST_START_TEST (a_sink_slower_than_the_live_source_gets_every_frame)
{
  assert_played ("videotestsrc is-live=true num-buffers=40 ! " SMALL_CAPS
      " ! queue ! l1l2stab window=8 ! identity sleep-time=60000 ! "
      "fakesink name=counted sync=false", "", 40);
}

GST_END_TEST;

static Suite *
faults_suite (void)
{
  Suite *s = suite_create ("faults");
  TCase *tc = tcase_create ("faults");
  const int n = G_N_ELEMENTS (flows);

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      what_downstream_answers_goes_upstream_and_a_flush_recovers, 0, n);
  tcase_add_loop_test (tc,
      after_a_refused_frame_the_ones_behind_it_can_still_go_out, 0, n);
  tcase_add_loop_test (tc,
      a_refusal_while_the_end_drains_releases_every_frame, 0, n);
  tcase_add_test (tc,
      damaged_frames_and_durations_of_zero_come_out_as_they_came);
  tcase_add_test (tc, a_source_that_stops_and_starts_loses_no_frame);
  tcase_add_test (tc, caps_that_change_in_the_middle_of_a_flush_hold_after_it);
  tcase_add_test (tc, a_full_disk_ends_the_pipeline_with_the_error_of_its_sink);
  tcase_add_test (tc, an_error_downstream_ends_the_pipeline_with_that_error);
  tcase_add_test (tc, after_an_error_upstream_all_frames_that_came_go_out);
  tcase_add_test (tc, a_sink_slower_than_the_live_source_gets_every_frame);
  return s;
}

GST_CHECK_MAIN (faults);
