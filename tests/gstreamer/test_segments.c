/* SPDX-License-Identifier: MIT */
/* Segments: rates, directions, trick modes and updates. */
#include "stabharness.h"

#define WINDOW 8
#define STOP (G_GUINT64_CONSTANT (50) * FRAME_DURATION)

/* A segment of frames 0 to 49. */
static void
push_segment (GstHarness * h, gdouble rate, GstSegmentFlags flags)
{
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = rate;
  segment.flags = flags;
  segment.stop = STOP;
  segment.position = rate > 0 ? 0 : STOP;
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
}

static const gdouble rates[] = { 0.25, 1, 4 };

GST_START_TEST (the_window_is_full_at_any_rate)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  guint i;

  push_segment (h, rates[__i__], GST_SEGMENT_FLAG_NONE);
  stab_push_frames (h, 0, WINDOW - 1);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
  for (i = WINDOW - 1; i < 50; i++) {
    stab_push_frames (h, i, 1);
    stab_pull_frames (h, i - (WINDOW - 1), 1);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 50 - (WINDOW - 1), WINDOW - 1);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (in_reverse_the_frames_and_the_position_go_back)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  gint i;

  push_segment (h, -1, GST_SEGMENT_FLAG_NONE);
  for (i = 49; i >= 0; i--) {
    stab_push_frames (h, i, 1);
    if (i + WINDOW - 1 < 50) {
      stab_pull_frames (h, i + WINDOW - 1, 1);
      fail_unless_equals_uint64 (stab_position (h),
          (i + WINDOW - 1) * FRAME_DURATION);
    }
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = WINDOW - 2; i >= 0; i--) {
    GstBuffer *buffer = gst_harness_pull (h);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_uint64 (stab_position (h), 0);
  stab_harness_free (h);
}

GST_END_TEST;

/* A discontinuity at every tenth frame, as with groups of ten pictures. */
GST_START_TEST (in_reverse_the_discontinuities_of_a_decoder_end_no_path)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  gint i;

  push_segment (h, -1, GST_SEGMENT_FLAG_NONE);
  for (i = 49; i >= 0; i--) {
    GstBuffer *buffer = stab_frame_new (h, i);
    const gint next = i + WINDOW - 1;

    if (i % 10 == 9)
      GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), next < 50);
    if (next < 50) {
      buffer = gst_harness_pull (h);
      fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer),
          next * FRAME_DURATION);
      fail_unless_equals_int (GST_BUFFER_IS_DISCONT (buffer), next % 10 == 9);
      gst_buffer_unref (buffer);
    }
  }
  stab_harness_free (h);
}

GST_END_TEST;

/* Each key frame is cropped as in normal playback; the region of interest shows it. */
GST_START_TEST (key_frames_alone_leave_at_once)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW,
      "crop-ratio", 0.8, NULL);
  guint i;

  push_segment (h, 8, GST_SEGMENT_FLAG_TRICKMODE
      | GST_SEGMENT_FLAG_TRICKMODE_KEY_UNITS);
  for (i = 0; i < 50; i += 12) {
    GstBuffer *buffer = stab_frame_new (h, i);
    GstVideoRegionOfInterestMeta *region;

    gst_buffer_add_video_region_of_interest_meta (buffer, "face", 28, 20, 8, 8);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
    buffer = gst_harness_try_pull (h);
    fail_unless (buffer != NULL);
    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    region = gst_buffer_get_video_region_of_interest_meta (buffer);
    fail_unless (region && region->x == 27 && region->y == 19
        && region->w == 10 && region->h == 10);
    gst_buffer_unref (buffer);
  }
  push_segment (h, 1, GST_SEGMENT_FLAG_NONE);
  stab_push_frames (h, 0, WINDOW);
  stab_pull_frames (h, 0, 1);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_segment_goes_downstream_as_it_came)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstSegment segment;
  const GstSegment *seen;
  GstEvent *event;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = 0.5;
  segment.applied_rate = 2;
  segment.base = 7 * GST_SECOND;
  segment.offset = GST_MSECOND;
  segment.start = segment.position = GST_SECOND;
  segment.stop = 3 * GST_SECOND;
  segment.time = 5 * GST_SECOND;
  segment.duration = 9 * GST_SECOND;
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  event = gst_pad_get_sticky_event (h->sinkpad, GST_EVENT_SEGMENT, 0);
  gst_event_parse_segment (event, &seen);
  fail_unless (gst_segment_is_equal (seen, &segment));
  gst_event_unref (event);
  stab_harness_free (h);
}

GST_END_TEST;

static void
push_segment_with (GstHarness * h, gdouble rate, GstClockTime stop,
    GstClockTime position)
{
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = rate;
  segment.stop = stop;
  segment.position = position;
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
}

/* A live source or an adaptive stream sends one when its end becomes known or moves. */
GST_START_TEST (an_update_of_the_segment_keeps_its_place_and_does_not_drain)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW,
      "post-messages", TRUE, NULL);
  GstMessage *message;
  GString *out;
  guint i;

  push_segment_with (h, 1, 6 * FRAME_DURATION, 0);
  out = stab_record_new (h);
  stab_push_frames (h, 0, 6);
  push_segment_with (h, 1, 40 * FRAME_DURATION, 6 * FRAME_DURATION);
  fail_unless_equals_string (out->str, "");
  stab_push_frames (h, 6, WINDOW + 1);
  fail_unless_equals_string (out->str, "f0 f1 f2 f3 f4 f5 segment f6 f7 ");
  fail_unless_equals_uint64 (stab_position (h), 8 * FRAME_DURATION);

  /* One path; every frame has the stream time of its own segment. */
  for (i = 0; i < 8; i++) {
    const GstStructure *frame;
    gboolean starts;
    guint64 time;

    message = stab_harness_message (h, GST_MESSAGE_ELEMENT);
    fail_unless (message != NULL);
    frame = gst_message_get_structure (message);
    fail_unless (gst_structure_get (frame, "path-start", G_TYPE_BOOLEAN,
            &starts, "stream-time", G_TYPE_UINT64, &time, NULL));
    fail_unless_equals_int (starts, i == 0);
    fail_unless_equals_uint64 (time, i * FRAME_DURATION);
    gst_message_unref (message);
  }
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (an_update_of_the_segment_with_no_frame_held_passes_at_once)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GString *out;

  push_segment_with (h, 1, 6 * FRAME_DURATION, 0);
  out = stab_record_new (h);
  push_segment_with (h, 1, 40 * FRAME_DURATION, 0);
  fail_unless_equals_string (out->str, "segment ");
  stab_harness_free (h);
}

GST_END_TEST;

/* Running time counts back from the stop, so a new one moves the frames. */
GST_START_TEST (in_reverse_a_segment_with_a_new_stop_is_no_update)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GString *out;

  push_segment_with (h, -1, 40 * FRAME_DURATION, 40 * FRAME_DURATION);
  out = stab_record_new (h);
  stab_push_frames (h, 20, 1);
  push_segment_with (h, -1, 30 * FRAME_DURATION, 19 * FRAME_DURATION);
  fail_unless_equals_string (out->str, "f20 segment ");
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_flush_drops_an_update_of_the_segment_that_waits)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GString *out;

  push_segment_with (h, 1, 6 * FRAME_DURATION, 0);
  out = stab_record_new (h);
  stab_push_frames (h, 0, 3);
  push_segment_with (h, 1, 40 * FRAME_DURATION, 0);
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  push_segment_with (h, 1, 50 * FRAME_DURATION, 0);
  stab_push_frames (h, 0, WINDOW);
  fail_unless_equals_string (out->str, "flush-start flush-stop segment f0 ");
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
segments_suite (void)
{
  Suite *s = suite_create ("segments");
  TCase *tc = tcase_create ("segments");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, the_window_is_full_at_any_rate, 0,
      G_N_ELEMENTS (rates));
  tcase_add_test (tc, in_reverse_the_frames_and_the_position_go_back);
  tcase_add_test (tc, in_reverse_the_discontinuities_of_a_decoder_end_no_path);
  tcase_add_test (tc, key_frames_alone_leave_at_once);
  tcase_add_test (tc, a_segment_goes_downstream_as_it_came);
  tcase_add_test (tc,
      an_update_of_the_segment_keeps_its_place_and_does_not_drain);
  tcase_add_test (tc,
      an_update_of_the_segment_with_no_frame_held_passes_at_once);
  tcase_add_test (tc, in_reverse_a_segment_with_a_new_stop_is_no_update);
  tcase_add_test (tc, a_flush_drops_an_update_of_the_segment_that_waits);
  return s;
}

GST_CHECK_MAIN (segments);
