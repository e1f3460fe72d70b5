/* SPDX-License-Identifier: MIT */
/* Motion files of other tools: how frames find their lines, and which faults of a file are reported. */
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "motion_fixture.h"

/* Writes a file with pans by 1, 2, 3, ... pixels, with the times of the frames or without. */
static void
write_pans (gboolean timed)
{
  GString *text = g_string_new ("l1l2stab-motion 1\r\nmade-by somebody\n\n"
      "size 160 120\nframerate 25/1\n");
  guint i;

  for (i = 0; i < N_FRAMES; i++) {
    if (timed)      /* nearly */
      g_string_append_printf (text, "%" G_GUINT64_FORMAT,
          i * FRAME_DURATION + 333);
    else
      g_string_append (text, "  -");
    g_string_append_printf (text, " %d given 1 0\t0 1 0 %u 0 0x1p0 -.5e0\n",
        i == CUT, i);
  }
  write_file ("in", text->str);
  g_string_free (text, TRUE);
}

/* The motion in the next message. FALSE: its frame starts a path. */
static gboolean
next_motion (GstHarness * h, gdouble * x, gdouble * y)
{
  GstMessage *message = stab_harness_message (h, GST_MESSAGE_ELEMENT);
  const GstStructure *frame = gst_message_get_structure (message);
  gboolean starts;
  gdouble F[9];

  stab_get_matrix (frame, "motion", F);
  gst_structure_get_boolean (frame, "path-start", &starts);
  *x = F[2];
  *y = F[5];
  gst_message_unref (message);
  return !starts;
}

GST_START_TEST (skipped_frames_and_reverse_playback_find_their_motion)
{
  static const guint forward[] = { 3, 4, 6, 9, 9 + 5, 19, 20 };
  static const guint backward[] = { 12, 11, 8, 5 };
  GstHarness *h = harness_new ("in", NULL);
  GstSegment segment;
  gdouble x, y;
  guint i;

  write_pans (TRUE);
  play (h);
  for (i = 0; i < G_N_ELEMENTS (forward); i++)
    push_frame (h, forward[i]);
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  for (i = 0; i < G_N_ELEMENTS (backward); i++)
    push_frame (h, backward[i]);
  gst_harness_push_event (h, gst_event_new_eos ());

  fail_if (next_motion (h, &x, &y));
  fail_unless (next_motion (h, &x, &y) && x == 4 && y == -.5);
  fail_unless (next_motion (h, &x, &y) && x == 5 + 6 && y == -1);
  fail_unless (next_motion (h, &x, &y) && x == 7 + 8 + 9);
  fail_unless (next_motion (h, &x, &y) && x == 10 + 11 + 12 + 13 + 14);
  fail_if (next_motion (h, &x, &y));    /* the cut was left out */
  fail_unless (next_motion (h, &x, &y) && x == 20);
  fail_if (next_motion (h, &x, &y));
  fail_unless (next_motion (h, &x, &y) && x == -12 && y == .5);
  fail_unless (next_motion (h, &x, &y) && x == -(9 + 10 + 11));
  fail_unless (next_motion (h, &x, &y) && x == -(6 + 7 + 8));
  stab_harness_free (h);
}

GST_END_TEST;

/* Thirty lines that pan by half a diagonal each, or zoom: the library accepts each, but not what they make together. */
GST_START_TEST (skipping_farther_than_the_library_follows_starts_a_path)
{
  static const gchar *motions[] = {
    "1 0 100 0 1 0", "1.2 0 0 0 1.2 0", "0.8 0 0 0 0.8 0", "1.02 0 100 0 1.02 0"
  };
  const gboolean backward = __i__ % 2;
  GstHarness *h = harness_new ("in", NULL);
  GString *text = g_string_new ("l1l2stab-motion 1\n");
  GstSegment segment;
  gdouble x, y;
  guint i;

  for (i = 0; i < N_FRAMES; i++)
    g_string_append_printf (text, "%" G_GUINT64_FORMAT " 0 given 1 0 0 %s\n",
        i * FRAME_DURATION, motions[__i__ / 2]);
  write_file ("in", text->str);
  g_string_free (text, TRUE);
  play (h);
  if (backward) {
    gst_segment_init (&segment, GST_FORMAT_TIME);
    segment.rate = -1;
    segment.stop = 2 * GST_SECOND;
    gst_harness_push_event (h, gst_event_new_segment (&segment));
  }
  push_frame (h, backward ? 28 : 1);
  push_frame (h, backward ? 27 : 2);
  push_frame (h, backward ? 1 : 28);
  push_frame (h, backward ? 0 : 29);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_if (next_motion (h, &x, &y));
  fail_unless (next_motion (h, &x, &y));
  fail_if (next_motion (h, &x, &y));
  fail_unless (next_motion (h, &x, &y));
  fail_unless (stab_harness_message (h, GST_MESSAGE_ERROR) == NULL);
  stab_harness_free (h);
}

GST_END_TEST;

/* A roll that is given in square pixels becomes a map of samples that depends on the caps' pixel aspect ratio. */
GST_START_TEST (the_pixel_aspect_ratio_of_the_caps_reaches_the_library)
{
  static const struct
  {
    const gchar *caps;
    gdouble aspect;
  } cases[] = {
    {NOISE_CAPS, 1},
    {NOISE_CAPS ", pixel-aspect-ratio=64/45", 64. / 45},
    {NOISE_CAPS ", pixel-aspect-ratio=1/2", .5},
    {NOISE_CAPS ", pixel-aspect-ratio=100/1", 1},       /* nonsense */
  };
  GString *text = g_string_new ("l1l2stab-motion 1\n");
  guint i, c;

  for (i = 0; i < N_FRAMES; i++)
    g_string_append_printf (text, "- 0 given 1 0 0 1 %s 0 %s 1 0\n",
        i % 2 ? "-0.02" : "0.02", i % 2 ? "0.02" : "-0.02");
  write_file ("in", text->str);
  g_string_free (text, TRUE);
  for (c = 0; c < G_N_ELEMENTS (cases); c++) {
    GstHarness *h = harness_new ("in", NULL);
    gdouble turned = 0;

    play (h);
    gst_harness_set_src_caps_str (h, cases[c].caps);
    for (i = 0; i < N_FRAMES; i++)
      push_frame (h, i);
    gst_harness_push_event (h, gst_event_new_eos ());
    for (i = 0; i < N_FRAMES; i++) {
      GstMessage *message = stab_harness_message (h, GST_MESSAGE_ELEMENT);
      const gdouble a = cases[c].aspect;
      gdouble warp[9];

      stab_get_matrix (gst_message_get_structure (message), "warp", warp);
      gst_message_unref (message);
      fail_unless (fabs (warp[0] - warp[4]) < 1e-9);
      fail_unless (fabs (warp[3] + a * a * warp[1]) < 1e-9,
          "%s: %g, %g", cases[c].caps, warp[1], warp[3]);
      turned = MAX (turned, fabs (warp[1]));
    }
    fail_unless (turned > 1e-3);
    stab_harness_free (h);
  }
}

GST_END_TEST;

/* Lines 0 1 1 1 2 3 3 4, by their times in frames; line i is a pan by i pixels. */
static void
write_repeated_pans (void)
{
  static const guint times[] = { 0, 1, 1, 1, 2, 3, 3, 4 };
  GString *text = g_string_new ("l1l2stab-motion 1\nframerate 25/1\n");
  guint i;

  for (i = 0; i < G_N_ELEMENTS (times); i++)
    g_string_append_printf (text, "%" G_GUINT64_FORMAT
        " 0 given 1 0 0 1 0 %u 0 1 0\n", times[i] * FRAME_DURATION, i);
  write_file ("in", text->str);
  g_string_free (text, TRUE);
}

GST_START_TEST (frames_with_one_timestamp_take_its_lines_in_order)
{
  static const guint forward[] = { 0, 1, 1, 1, 1, 2, 3, 4 };
  static const gdouble motions[] = { 1, 2, 3, 0, 4, 5, 6 + 7 };
  static const guint backward[] = { 4, 3, 3, 2 };
  GstHarness *h = harness_new ("in", NULL);
  GstSegment segment;
  gdouble x, y;
  guint i;

  write_repeated_pans ();
  play (h);
  for (i = 0; i < G_N_ELEMENTS (forward); i++)
    push_frame_at (h, i, forward[i]);
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  for (i = 0; i < G_N_ELEMENTS (backward); i++)
    push_frame_at (h, i, backward[i]);
  gst_harness_push_event (h, gst_event_new_eos ());

  fail_if (next_motion (h, &x, &y));
  for (i = 0; i < G_N_ELEMENTS (motions); i++)
    fail_unless (next_motion (h, &x, &y) && x == motions[i], "%u: %g", i, x);
  fail_if (next_motion (h, &x, &y));
  fail_unless (next_motion (h, &x, &y) && x == -7);
  fail_unless (next_motion (h, &x, &y) && x == -6);
  fail_unless (next_motion (h, &x, &y) && x == -5);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (lines_without_times_are_taken_in_order)
{
  GstHarness *h = harness_new ("in", NULL);
  GstSegment segment;
  gdouble x, y;
  guint i, round;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  write_pans (FALSE);
  play (h);
  for (round = 0; round < 2; round++) {
    for (i = 0; i < N_FRAMES; i++)
      push_frame (h, i);
    gst_harness_push_event (h, gst_event_new_flush_start ());
    gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
    gst_harness_push_event (h, gst_event_new_segment (&segment));
  }
  for (round = 0; round < 2; round++) {
    for (i = 0; i < N_FRAMES - WINDOW + 1; i++) {
      const gboolean moves = next_motion (h, &x, &y);

      fail_unless (moves == (i != 0 && i != CUT));
      fail_unless (!moves || x == i, "%u: %g", i, x);
    }
  }
  stab_harness_free (h);
}

GST_END_TEST;

#define MAGIC "l1l2stab-motion 1\n"
#define FRAME " 0 given 1 0 0 1 0 0 0 1 0\n"

static const struct
{
  const gchar *text, *words;
} faulty[] = {
  {"", "line 1 of "},
  {"l1l2stab-motion 2\n", "line 1 of "},
  {"# a comment\n" MAGIC, "line 1 of "},
  {MAGIC "size 160\n", "line 2 of "},
  {MAGIC "framerate 25\n", "has no rate such as"},
  {MAGIC "0" FRAME "# between\n0 0 given\n", "line 4 of "},
  {MAGIC "0,5" FRAME, "a time in nanoseconds"},
  {MAGIC "0 2 given 1 0 0 1 0 0 0 1 0\n", "neither 0 nor 1"},
  {MAGIC "0 0 rotation 1 0 0 1 0 0 0 1 0\n", "a model that is not known"},
  {MAGIC "0 0 given 1 0 0 1,0 0 0 0 1 0\n", "not of six numbers"},
  {MAGIC "0 0 given 1 0 0 nan 0 0 0 1 0\n", "not of six numbers"},
  {MAGIC "0 0 given 1 0 0 1 0 0 0 -1 0\n", "cannot be inverted, or mirrors"},
  {MAGIC "40" FRAME "39" FRAME, "line 3 of "},
  {MAGIC "40" FRAME "39" FRAME, "is earlier than the line before"},
  {MAGIC "9223372036854775808" FRAME, "line 2 of "},
  {MAGIC "9223372036854775808" FRAME, "a time of more than 2^63 - 1"},
  {MAGIC "99999999999999999999" FRAME, "a time of more than 2^63 - 1"},
  {MAGIC "0 0 given 1e300 0 0 1 0 0 0 1 0\n", "line 2 of "},
  {MAGIC "0 0 given 1e300 0 0 1 0 0 0 1 0\n", "not between 0 and 1"},
  {MAGIC "0 0 given -7 0 0 1 0 0 0 1 0\n", "not between 0 and 1"},
  {MAGIC "0 0 given 1 10 11 1 0 0 0 1 0\n", "more inliers than tracks"},
  {MAGIC "0 0 given 1 0 0 1e200 0 0 0 1e200 0\n", "determinant is too large"},
  {MAGIC "0 0 given 1 0 0 1e200 1e200 0 1e200 1e200 0\n",
      "determinant is too large"},
  {MAGIC "40" FRAME "-" FRAME, "others have none"},
};

GST_START_TEST (a_faulty_file_stops_the_start_and_the_error_says_where)
{
  GstHarness *h = harness_new ("in", NULL);

  write_file ("in", faulty[__i__].text);
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR_READ, faulty[__i__].words);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (files_that_cannot_be_opened_are_an_error_at_the_start)
{
  static const struct
  {
    const gchar *in, *out, *words;
    gint code;
  } cases[] = {
    {"missing", NULL, "missing", GST_RESOURCE_ERROR_OPEN_READ},
    {"missing", "a", "missing", GST_RESOURCE_ERROR_OPEN_READ},
    {NULL, "missing/a", "missing/a", GST_RESOURCE_ERROR_OPEN_WRITE},
    {"in", "in", "are both", GST_RESOURCE_ERROR_OPEN_WRITE},
  };
  gchar *kept;
  guint i;

  write_file ("a", "as it was");
  for (i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstHarness *h = harness_new (cases[i].in, cases[i].out);

    fail_unless_equals_int (gst_element_set_state (h->element,
            GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    assert_error_says (h, cases[i].code, cases[i].words);
    stab_harness_free (h);
  }
  kept = contents ("a");
  fail_unless_equals_string (kept, "as it was");
  g_free (kept);
}

GST_END_TEST;

/* Opening the pipe would wait for ever. */
GST_START_TEST (a_pipe_or_a_device_is_no_motion_file)
{
  GstHarness *h = harness_new (__i__ == 0 ? "in" : NULL, NULL);
  gchar *path = g_build_filename (folder, "in", NULL);

  if (__i__ == 0) {
    fail_unless_equals_int (mkfifo (path, 0600), 0);
  } else {
    g_object_set (h->element, "motion-in", "/dev/null", NULL);
  }
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR_READ, "is not a regular file");
  g_free (path);
  stab_harness_free (h);
}

GST_END_TEST;

/* Writing would destroy what is read. */
GST_START_TEST (two_names_of_one_file_are_one_file)
{
  GstHarness *h = harness_new ("in", "a");
  gchar *path = g_build_filename (folder, "a", NULL);
  gchar *kept;

  write_file ("in", "l1l2stab-motion 1\n0 0 given 1 0 0 1 0 0 0 1 0\n");
  fail_unless_equals_int (symlink ("in", path), 0);
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR_OPEN_WRITE, "are both");
  kept = contents ("in");
  fail_unless (g_str_has_prefix (kept, "l1l2stab-motion 1\n0 0 given"));
  g_free (kept);
  g_free (path);
  stab_harness_free (h);
}

GST_END_TEST;

/* Also by default, because rolling-shutter is on by default. */
GST_START_TEST (a_rolling_shutter_that_is_not_corrected_is_one_warning)
{
  gint shutter;

  write_pans (TRUE);
  for (shutter = L1L2STAB_ROLLING_SHUTTER_NONE;
      shutter <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; shutter++) {
    GstHarness *h = harness_new ("in", NULL);
    GstMessage *message;

    g_object_set (h->element, "rolling-shutter", shutter, NULL);
    play (h);
    message = stab_harness_message (h, GST_MESSAGE_WARNING);
    fail_unless_equals_int (message != NULL,
        shutter != L1L2STAB_ROLLING_SHUTTER_NONE);
    gst_clear_message (&message);
    push_frame (h, 0);
    gst_harness_set_src_caps_str (h, NOISE_CAPS ", pixel-aspect-ratio=2/1");
    push_frame (h, 1);
    fail_unless (stab_harness_message (h, GST_MESSAGE_WARNING) == NULL);
    stab_harness_free (h);
  }
}

GST_END_TEST;

GST_START_TEST (frames_of_another_size_or_rate_or_time_are_refused)
{
  static const struct
  {
    const gchar *text, *words;
  } cases[] = {
    {MAGIC "size 1920 1080\n0" FRAME, "is for frames of 1920x1080 pixels"},
    {MAGIC "framerate 30/1\n-" FRAME, "is for 30/1 frames per second"},
    {MAGIC "size 160 120\n90000000" FRAME, "has no line for the frame"},
    {MAGIC "framerate 25/1\n", "has no line for the frame"},
  };
  guint i;

  for (i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstHarness *h = harness_new ("in", NULL);
    GstCaps *caps = gst_caps_from_string (NOISE_CAPS);

    write_file ("in", cases[i].text);
    gst_element_set_state (h->element, GST_STATE_PLAYING);
    gst_harness_push_event (h, gst_event_new_stream_start ("s"));
    gst_harness_set_src_caps (h, caps);
    fail_if (gst_harness_push (h, stab_noise_new (0)) == GST_FLOW_OK);
    assert_error_says (h, GST_RESOURCE_ERROR_READ, cases[i].words);
    stab_harness_free (h);
  }
}

GST_END_TEST;

static Suite *
motionin_suite (void)
{
  Suite *s = suite_create ("motionin");
  TCase *tc = tcase_create ("motionin");

  suite_add_tcase (s, tc);
  tcase_add_checked_fixture (tc, make_folder, remove_folder);
  tcase_add_test (tc, the_pixel_aspect_ratio_of_the_caps_reaches_the_library);
  tcase_add_test (tc,
      skipped_frames_and_reverse_playback_find_their_motion);
  tcase_add_test (tc, frames_with_one_timestamp_take_its_lines_in_order);
  tcase_add_test (tc, lines_without_times_are_taken_in_order);
  tcase_add_loop_test (tc, a_faulty_file_stops_the_start_and_the_error_says_where, 0,
      G_N_ELEMENTS (faulty));
  tcase_add_test (tc, files_that_cannot_be_opened_are_an_error_at_the_start);
  tcase_add_loop_test (tc, skipping_farther_than_the_library_follows_starts_a_path, 0, 8);
  tcase_add_loop_test (tc, a_pipe_or_a_device_is_no_motion_file, 0, 2);
  tcase_add_test (tc, two_names_of_one_file_are_one_file);
  tcase_add_test (tc, a_rolling_shutter_that_is_not_corrected_is_one_warning);
  tcase_add_test (tc, frames_of_another_size_or_rate_or_time_are_refused);
  return s;
}

GST_CHECK_MAIN (motionin);
