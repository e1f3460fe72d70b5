/* SPDX-License-Identifier: MIT */
/* What the element reports: a message for each frame, and statistics of all frames. */
#include <math.h>

#include "stabnoise.h"

#define WINDOW 6
#define N_FRAMES 24

static void
assert_times (const GstStructure * frame, guint index, GstClockTime base)
{
  guint64 number, timestamp, duration, stream, running, path_frame;

  fail_unless (gst_structure_get (frame, "frame", G_TYPE_UINT64, &number,
          "timestamp", G_TYPE_UINT64, &timestamp, "duration", G_TYPE_UINT64,
          &duration, "stream-time", G_TYPE_UINT64, &stream, "running-time",
          G_TYPE_UINT64, &running, "path-frame", G_TYPE_UINT64, &path_frame,
          NULL));
  fail_unless_equals_uint64 (number, index);
  fail_unless_equals_uint64 (path_frame, index);
  fail_unless_equals_uint64 (timestamp, base + index * FRAME_DURATION);
  fail_unless_equals_uint64 (duration, FRAME_DURATION);
  fail_unless_equals_uint64 (stream, index * FRAME_DURATION);
  fail_unless_equals_uint64 (running, index * FRAME_DURATION / 2);
}

static void
assert_numbers (const GstStructure * frame, const L1L2StabInfo * info)
{
  const struct
  {
    const gchar *field;
    const gdouble *matrix;
  } matrices[] = {
    {"motion", info->F}, {"update", info->B}, {"camera", info->C},
    {"path", info->P}, {"warp", info->warp},
  };
  gdouble matrix[9], quality, lambda, crop_ratio, bypass, residual, readout;
  gboolean start, lost, fallback, early;
  gint tracks, inliers;
  guint i;

  for (i = 0; i < G_N_ELEMENTS (matrices); i++) {
    stab_get_matrix (frame, matrices[i].field, matrix);
    fail_unless (memcmp (matrix, matrices[i].matrix, sizeof (matrix)) == 0,
        "%s", matrices[i].field);
  }
  fail_unless (gst_structure_get (frame, "quality", G_TYPE_DOUBLE, &quality,
          "lambda", G_TYPE_DOUBLE, &lambda, "crop-ratio", G_TYPE_DOUBLE,
          &crop_ratio, "bypass", G_TYPE_DOUBLE, &bypass, "residual",
          G_TYPE_DOUBLE, &residual, "readout", G_TYPE_DOUBLE, &readout,
          "tracks", G_TYPE_INT,
          &tracks, "inliers", G_TYPE_INT, &inliers, "path-start",
          G_TYPE_BOOLEAN, &start, "motion-lost", G_TYPE_BOOLEAN, &lost,
          "path-fallback", G_TYPE_BOOLEAN, &fallback, "early", G_TYPE_BOOLEAN,
          &early, NULL));
  fail_unless (quality == info->quality && lambda == info->lambda);
  fail_unless (crop_ratio == info->crop_ratio && bypass == 0);
  fail_unless (residual == info->residual && readout == info->readout);
  fail_unless (tracks == info->tracks && inliers == info->inliers);
  fail_unless (start == ((info->flags & L1L2STAB_INFO_PATH_START) != 0));
  fail_unless (lost == ((info->flags & L1L2STAB_INFO_MOTION_LOST) != 0));
  fail_if (fallback || early);
}

GST_START_TEST (messages_report_what_the_library_reports_of_each_frame)
{
  static const gchar *models[] = { "none", "identity", "predicted",
    "given", "translation", "similarity", "affine"
  };
  const GstClockTime base = 7 * GST_SECOND;
  GstHarness *h = stab_noise_harness_new (WINDOW);
  L1L2StabInfo infos[N_FRAMES];
  GstSegment segment;
  guint i;

  stab_noise_infos (WINDOW, N_FRAMES, infos);
  g_object_set (h->element, "post-messages", TRUE, NULL);
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = base;
  segment.rate = 2;
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = stab_noise_new (i);

    GST_BUFFER_PTS (buffer) += base;
    gst_harness_push (h, buffer);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < N_FRAMES; i++) {
    GstMessage *message = stab_harness_message (h, GST_MESSAGE_ELEMENT);
    const GstStructure *frame = gst_message_get_structure (message);

    fail_unless (gst_structure_has_name (frame, "l1l2stab-frame"));
    assert_times (frame, i, base);
    assert_numbers (frame, &infos[i]);
    fail_unless_equals_string (gst_structure_get_string (frame, "model"),
        models[infos[i].model]);
    gst_message_unref (message);
  }
  fail_unless (stab_harness_message (h, GST_MESSAGE_ELEMENT) == NULL);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (messages_start_and_stop_with_the_property)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  guint i, n = 0;
  GstMessage *message;

  for (i = 0; i < 3 * WINDOW; i++) {
    g_object_set (h->element, "post-messages", i == 2 * WINDOW, NULL);
    stab_noise_push (h, i, 1);
  }
  while ((message = stab_harness_message (h, GST_MESSAGE_ELEMENT)) != NULL) {
    gst_message_unref (message);
    n++;
  }
  fail_unless_equals_int (n, 1);
  stab_harness_free (h);
}

GST_END_TEST;

static guint64
stat_of (GstHarness * h, const gchar * field)
{
  GstStructure *stats = NULL;
  guint64 value;

  g_object_get (h->element, "stats", &stats, NULL);
  fail_unless (gst_structure_has_name (stats, "l1l2stab-stats"));
  fail_unless (gst_structure_get_uint64 (stats, field, &value), "%s", field);
  gst_structure_free (stats);
  return value;
}

static void
assert_counts (GstHarness * h, guint in, guint out, guint dropped)
{
  fail_unless_equals_uint64 (stat_of (h, "frames-in"), in);
  fail_unless_equals_uint64 (stat_of (h, "frames-out"), out);
  fail_unless_equals_uint64 (stat_of (h, "frames-dropped"), dropped);
  fail_unless_equals_uint64 (stat_of (h, "frames-held"), in - out - dropped);
}

GST_START_TEST (the_statistics_count_every_frame_once)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  assert_counts (h, 0, 0, 0);
  stab_noise_push (h, 0, 10);
  assert_counts (h, 10, 5, 0);
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  assert_counts (h, 10, 5, 5);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  stab_noise_push (h, 0, 10);
  assert_counts (h, 20, 10, 5);
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_counts (h, 20, 15, 5);
  gst_element_set_state (h->element, GST_STATE_READY);
  assert_counts (h, 20, 15, 5); /* to be read after the end, too */
  gst_element_set_state (h->element, GST_STATE_PLAYING);
  assert_counts (h, 0, 0, 0);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (the_statistics_report_quality_latency_and_time)
{
  static const gchar *times[] = { "scale-time", "track-time", "fit-time",
    "solve-time", "warp-time"
  };
  GstHarness *h = stab_noise_harness_new (WINDOW);
  L1L2StabInfo infos[N_FRAMES];
  GstStructure *stats = NULL;
  gdouble mean, least, sum = 0, expected_least = 1;
  const gchar *simd;
  gint window, threads;
  guint i;

  stab_noise_infos (WINDOW, N_FRAMES, infos);
  for (i = 1; i < N_FRAMES; i++) {
    sum += infos[i].quality;
    expected_least = MIN (expected_least, infos[i].quality);
  }
  stab_noise_push (h, 0, N_FRAMES);
  gst_harness_push_event (h, gst_event_new_eos ());
  g_object_get (h->element, "stats", &stats, NULL);
  fail_unless (gst_structure_get (stats, "quality-mean", G_TYPE_DOUBLE, &mean,
          "quality-min", G_TYPE_DOUBLE, &least, "window", G_TYPE_INT, &window,
          "threads", G_TYPE_INT, &threads, NULL));
  fail_unless (fabs (mean - sum / (N_FRAMES - 1)) < 1e-12);
  fail_unless (least == expected_least && least > 0);
  fail_unless_equals_int (window, WINDOW);
  fail_unless (threads >= 1);
  simd = gst_structure_get_string (stats, "simd");
  fail_unless (g_str_equal (simd, "avx2") || g_str_equal (simd, "neon") ||
      g_str_equal (simd, "none"));
  fail_unless_equals_string (gst_structure_get_string (stats, "version"),
      l1l2stab_version ());
  fail_unless_equals_uint64 (stat_of (h, "latency"), WINDOW * FRAME_DURATION);
  for (i = 0; i < G_N_ELEMENTS (times); i++)
    fail_unless (stat_of (h, times[i]) > 0, "%s", times[i]);
  gst_structure_free (stats);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
report_suite (void)
{
  Suite *s = suite_create ("report");
  TCase *tc = tcase_create ("report");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, messages_report_what_the_library_reports_of_each_frame);
  tcase_add_test (tc, messages_start_and_stop_with_the_property);
  tcase_add_test (tc, the_statistics_count_every_frame_once);
  tcase_add_test (tc, the_statistics_report_quality_latency_and_time);
  return s;
}

GST_CHECK_MAIN (report);
