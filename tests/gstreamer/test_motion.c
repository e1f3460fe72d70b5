/* SPDX-License-Identifier: MIT */
/* Motion files that one run writes and another reads: the output is the same to the bit. */
#include "motion_fixture.h"

/* No frame has the timestamp of the frame before it. */
#define NO_FRAME N_FRAMES

/* The pictures of a clip with a cut, one after the other. Frame `repeated` and the one after it have the timestamp of
 * the frame before. *analysis: ns per frame. */
static GByteArray *
run (const gchar * in, const gchar * out, L1L2StabMotionModel model,
    guint repeated, guint64 * analysis)
{
  static const gchar *stages[] = { "scale-time", "track-time", "fit-time" };
  GByteArray *pictures = g_byte_array_new ();
  GstHarness *h = harness_new (in, out);
  GstStructure *stats = NULL;
  GstBuffer *buffer;
  guint64 time;
  guint i;

  g_object_set (h->element, "motion-model", model, NULL);
  play (h);
  for (i = 0; i < N_FRAMES; i++)
    push_frame_at (h, i, i == repeated || i == repeated + 1 ? repeated - 1 : i);
  gst_harness_push_event (h, gst_event_new_eos ());
  while ((buffer = gst_harness_try_pull (h)) != NULL) {
    GstMapInfo map;

    fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READ));
    g_byte_array_append (pictures, map.data, map.size);
    gst_buffer_unmap (buffer, &map);
    gst_buffer_unref (buffer);
  }
  g_object_get (h->element, "stats", &stats, NULL);
  *analysis = 0;
  for (i = 0; i < G_N_ELEMENTS (stages); i++) {
    fail_unless (gst_structure_get_uint64 (stats, stages[i], &time));
    *analysis += time;
  }
  fail_unless (gst_structure_get_uint64 (stats, "cuts", &time));
  fail_unless_equals_uint64 (time, 1);
  gst_structure_free (stats);
  stab_harness_free (h);
  return pictures;
}

static void
assert_second_run_is_the_same (L1L2StabMotionModel model, guint repeated)
{
  guint64 first_analysis, second_analysis;
  GByteArray *one = run (NULL, "a", model, repeated, &first_analysis);
  GByteArray *two = run ("a", "b", model, repeated, &second_analysis);
  gchar *a = contents ("a"), *b = contents ("b");

  fail_unless_equals_int (one->len, N_FRAMES * NOISE_WIDTH * NOISE_HEIGHT);
  fail_unless_equals_int (two->len, one->len);
  fail_unless (memcmp (one->data, two->data, one->len) == 0);
  fail_unless_equals_string (a, b);
  fail_unless (first_analysis > 0);
  fail_unless_equals_uint64 (second_analysis, 0);
  g_byte_array_unref (one);
  g_byte_array_unref (two);
  g_free (a);
  g_free (b);
}

GST_START_TEST (a_second_run_gives_the_same_bytes_without_analysis)
{
  assert_second_run_is_the_same (__i__, NO_FRAME);
}

GST_END_TEST;

GST_START_TEST (a_second_run_with_repeated_timestamps_gives_the_same_bytes)
{
  assert_second_run_is_the_same (L1L2STAB_MOTION_MODEL_SIMILARITY, 10);
}

GST_END_TEST;

GST_START_TEST (frames_that_share_a_timestamp_have_a_line_each)
{
  static const guint timestamps[] = { 0, 1, 1, 1, 2, 3, 3 };
  GstHarness *h = harness_new (NULL, "a");
  gchar **lines, *text;
  guint i;

  play (h);
  for (i = 0; i < G_N_ELEMENTS (timestamps); i++)
    push_frame_at (h, i, timestamps[i]);
  gst_harness_push_event (h, gst_event_new_eos ());
  text = contents ("a");
  lines = g_strsplit (text, "\n", -1);
  fail_unless_equals_int (g_strv_length (lines),
      4 + G_N_ELEMENTS (timestamps) + 1);
  for (i = 0; i < G_N_ELEMENTS (timestamps); i++)
    fail_unless_equals_uint64 (g_ascii_strtoull (lines[4 + i], NULL, 10),
        timestamps[i] * FRAME_DURATION);
  g_strfreev (lines);
  g_free (text);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (the_file_is_complete_when_the_stream_ends_and_is_as_documented)
{
  GstHarness *h = harness_new (NULL, "a");
  gchar **lines, *text, *before;
  guint i;

  play (h);
  for (i = 0; i < N_FRAMES; i++)
    push_frame (h, i);
  before = contents ("a");
  gst_harness_push_event (h, gst_event_new_eos ());
  text = contents ("a");
  fail_unless (g_str_has_prefix (text, before));
  lines = g_strsplit (text, "\n", -1);
  fail_unless_equals_int (g_strv_length (lines), 4 + N_FRAMES + 1);
  fail_unless_equals_string (lines[0], "l1l2stab-motion 1");
  fail_unless_equals_string (lines[1], "size 160 120");
  fail_unless_equals_string (lines[2], "framerate 25/1");
  fail_unless_equals_string (lines[4], "0 1 none 0 0 0 1 0 0 0 1 0");
  for (i = 1; i < N_FRAMES; i++) {
    gchar *start = g_strdup_printf ("%" G_GUINT64_FORMAT " %d ",
        i * FRAME_DURATION, i == CUT);

    fail_unless (g_str_has_prefix (lines[4 + i], start), "%s", lines[4 + i]);
    g_free (start);
  }
  g_strfreev (lines);
  g_free (before);
  g_free (text);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (frames_played_again_are_written_once_and_a_flush_empties_the_file)
{
  GstHarness *h = harness_new (NULL, "a");
  GstSegment segment;
  gchar *text;
  guint i;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  play (h);
  for (i = 0; i < 9; i++)
    push_frame (h, i);
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  for (i = 3; i < 9; i++)
    push_frame (h, i);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  for (i = 5; i < 11; i++)
    push_frame (h, i);
  gst_harness_push_event (h, gst_event_new_eos ());
  text = contents ("a");
  for (i = 0; i < 11; i++) {
    gchar *start = g_strdup_printf ("\n%" G_GUINT64_FORMAT " ",
        i * FRAME_DURATION);
    gchar **parts = g_strsplit (text, start, -1);

    fail_unless_equals_int (g_strv_length (parts) - 1, i >= 3);
    g_strfreev (parts);
    g_free (start);
  }
  g_free (text);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (frames_of_another_size_end_the_file_with_a_warning)
{
  GstHarness *h = harness_new (NULL, "a");
  GstMessage *message;
  gchar *before, *after;

  play (h);
  stab_noise_push (h, 0, WINDOW);
  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  before = contents ("a");
  stab_push_frames (h, WINDOW, WINDOW);
  gst_harness_push_event (h, gst_event_new_eos ());
  after = contents ("a");
  fail_unless_equals_int (gst_harness_buffers_received (h), 2 * WINDOW);
  fail_unless_equals_string (before, after);
  message = stab_harness_message (h, GST_MESSAGE_WARNING);
  fail_unless (message != NULL);
  gst_message_unref (message);
  fail_unless (stab_harness_message (h, GST_MESSAGE_WARNING) == NULL);
  g_free (before);
  g_free (after);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_full_disk_is_an_error)
{
  GstHarness *h = harness_new (NULL, NULL);
  guint i;

  g_object_set (h->element, "motion-out", "/dev/full", NULL);
  play (h);
  for (i = 0; i < WINDOW - 1; i++)
    push_frame (h, i);
  fail_unless_equals_int (gst_harness_push (h, stab_noise_new (i)),
      GST_FLOW_ERROR);
  assert_error_says (h, GST_RESOURCE_ERROR_WRITE, "/dev/full");
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
motion_suite (void)
{
  Suite *s = suite_create ("motion");
  TCase *tc = tcase_create ("motion");

  suite_add_tcase (s, tc);
  tcase_add_checked_fixture (tc, make_folder, remove_folder);
  tcase_add_loop_test (tc, a_second_run_gives_the_same_bytes_without_analysis,
      L1L2STAB_MOTION_MODEL_TRANSLATION, L1L2STAB_MOTION_MODEL_AFFINE + 1);
  tcase_add_test (tc,
      a_second_run_with_repeated_timestamps_gives_the_same_bytes);
  tcase_add_test (tc, frames_that_share_a_timestamp_have_a_line_each);
  tcase_add_test (tc,
      the_file_is_complete_when_the_stream_ends_and_is_as_documented);
  tcase_add_test (tc,
      frames_played_again_are_written_once_and_a_flush_empties_the_file);
  tcase_add_test (tc, frames_of_another_size_end_the_file_with_a_warning);
  tcase_add_test (tc, a_full_disk_is_an_error);
  return s;
}

GST_CHECK_MAIN (motion);
