/* SPDX-License-Identifier: MIT */
/* Events keep their place among the frames. */
#include "stabharness.h"

#define WINDOW 8

static GstEvent *
tag_event (const gchar * title)
{
  return gst_event_new_tag (gst_tag_list_new (GST_TAG_TITLE, title, NULL));
}

static GstEvent *
custom_event (GstEventType type)
{
  return gst_event_new_custom (type, gst_structure_new_empty ("test"));
}

/* A harness in which `n` frames are held. *out: a record of what comes out from now on. */
static GstHarness *
recorded_harness_new (guint n, GString ** out)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);

  stab_push_frames (h, 0, n);
  *out = stab_record_new (h);
  return h;
}

GST_START_TEST (a_serialized_event_stays_before_its_frame)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);

  fail_unless (gst_harness_push_event (h, tag_event ("one")));
  fail_unless (gst_harness_push_event (h,
          custom_event (GST_EVENT_CUSTOM_DOWNSTREAM)));
  stab_push_frames (h, 3, WINDOW);
  fail_unless_equals_string (out->str, "f0 f1 f2 tag custom-downstream f3 ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (an_event_after_the_last_frame_goes_before_the_end)
{
  GString *out;
  GstHarness *h = recorded_harness_new (2, &out);

  gst_harness_push_event (h, tag_event ("one"));
  stab_push_frames (h, 2, 1);
  gst_harness_push_event (h, tag_event ("two"));
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_string (out->str, "f0 f1 tag f2 tag eos ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (an_event_with_no_frame_before_it_passes_at_once)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GString *out = stab_record_new (h);

  gst_harness_push_event (h, tag_event ("one"));
  gst_harness_push_event (h, gst_event_new_gap (0, FRAME_DURATION));
  fail_unless (g_str_has_suffix (out->str, "tag gap "), "%s", out->str);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_gap_stays_in_its_place_and_ends_no_window)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);

  gst_harness_push_event (h, gst_event_new_gap (3 * FRAME_DURATION,
          FRAME_DURATION));
  fail_unless_equals_string (out->str, "");
  stab_push_frames (h, 4, WINDOW - 1);
  fail_unless_equals_string (out->str, "f0 f1 f2 gap ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (in_a_long_gap_the_frames_before_it_leave)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);

  gst_harness_push_event (h, gst_event_new_gap (3 * FRAME_DURATION,
          6 * FRAME_DURATION));
  fail_unless_equals_string (out->str, "f0 f1 ");
  gst_harness_push_event (h, gst_event_new_gap (9 * FRAME_DURATION,
          6 * FRAME_DURATION));
  fail_unless_equals_string (out->str, "f0 f1 f2 gap gap ");
  stab_harness_free (h);
}

GST_END_TEST;

/* A player sends this event when the video ends before the audio. The end of the stream comes later, and not before the
 * sink has a frame. */
GST_START_TEST (at_the_end_of_its_group_a_stream_is_drained)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);

  gst_harness_push_event (h, gst_event_new_stream_group_done (1));
  fail_unless_equals_string (out->str, "f0 f1 f2 stream-group-done ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_gap_of_unknown_length_drains)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);

  gst_harness_push_event (h, gst_event_new_gap (3 * FRAME_DURATION,
          GST_CLOCK_TIME_NONE));
  fail_unless_equals_string (out->str, "f0 f1 f2 gap ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (an_out_of_band_event_overtakes_the_frames)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);

  gst_harness_push_event (h, custom_event (GST_EVENT_CUSTOM_DOWNSTREAM_OOB));
  fail_unless_equals_string (out->str, "custom-downstream-oob ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_tag_outlives_a_flush_and_a_custom_event_does_not)
{
  GString *out;
  GstHarness *h = recorded_harness_new (3, &out);
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (h, tag_event ("one"));
  gst_harness_push_event (h, custom_event (GST_EVENT_CUSTOM_DOWNSTREAM));
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  stab_push_frames (h, 20, WINDOW);
  fail_unless_equals_string (out->str,
      "flush-start flush-stop segment tag f20 ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_qos_event_goes_upstream_and_drops_no_frame)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstEvent *event;
  gboolean seen = FALSE;

  stab_push_frames (h, 0, 1);
  gst_harness_push_upstream_event (h, gst_event_new_qos (GST_QOS_TYPE_UNDERFLOW,
          0.1, 10 * GST_SECOND, 10 * GST_SECOND));
  while ((event = gst_harness_try_pull_upstream_event (h)) != NULL) {
    seen |= GST_EVENT_TYPE (event) == GST_EVENT_QOS;
    gst_event_unref (event);
  }
  fail_unless (seen);
  stab_push_frames (h, 1, WINDOW);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, WINDOW + 1);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
events_suite (void)
{
  Suite *s = suite_create ("events");
  TCase *tc = tcase_create ("events");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, a_serialized_event_stays_before_its_frame);
  tcase_add_test (tc, an_event_after_the_last_frame_goes_before_the_end);
  tcase_add_test (tc, an_event_with_no_frame_before_it_passes_at_once);
  tcase_add_test (tc, a_gap_stays_in_its_place_and_ends_no_window);
  tcase_add_test (tc, in_a_long_gap_the_frames_before_it_leave);
  tcase_add_test (tc, a_gap_of_unknown_length_drains);
  tcase_add_test (tc, at_the_end_of_its_group_a_stream_is_drained);
  tcase_add_test (tc, an_out_of_band_event_overtakes_the_frames);
  tcase_add_test (tc, a_tag_outlives_a_flush_and_a_custom_event_does_not);
  tcase_add_test (tc, a_qos_event_goes_upstream_and_drops_no_frame);
  return s;
}

GST_CHECK_MAIN (events);
