/* SPDX-License-Identifier: MIT */
/* In real time, so the machine must not be busy: the latency tracer measures the latency that is reported, and a
 * synchronized sink gets no frame too late. test_time.c has the same with a test clock. */
#include <stdlib.h>

#include "stabharness.h"

#define RATE 50
#define FRAME (GST_SECOND / RATE)
#define ENOUGH 60               /* frames to take the median of */

/* --- the latency that the tracer measures --- */

static GMutex lock;
static GArray *measured;        /* GstClockTime */

/* What the tracer logs about the element named "stab". */
static void
read_tracer (GstDebugCategory * category, GstDebugLevel level,
    const gchar * file, const gchar * function, gint line, GObject * object,
    GstDebugMessage * message, gpointer user_data)
{
  const gchar *text = gst_debug_message_get (message);
  const gchar *time;
  guint64 value;

  if (!text || !g_str_has_prefix (text, "element-latency,")
      || !strstr (text, "element=(string)stab,"))
    return;
  time = strstr (text, "time=(guint64)");
  if (!time)
    return;
  value = g_ascii_strtoull (time + strlen ("time=(guint64)"), NULL, 10);
  g_mutex_lock (&lock);
  g_array_append_val (measured, value);
  g_mutex_unlock (&lock);
}

static gint
compare (gconstpointer a, gconstpointer b)
{
  const guint64 x = *(const guint64 *) a, y = *(const guint64 *) b;

  return x < y ? -1 : x > y;
}

static GstClockTime
latency_of (GstElement * pipeline, const gchar * name)
{
  GstElement *element = gst_bin_get_by_name (GST_BIN (pipeline), name);
  GstPad *pad = gst_element_get_static_pad (element, "src");
  GstQuery *query = gst_query_new_latency ();
  GstClockTime latency;

  fail_unless (gst_pad_query (pad, query));
  gst_query_parse_latency (query, NULL, &latency, NULL);
  gst_query_unref (query);
  gst_object_unref (pad);
  gst_object_unref (element);
  return latency;
}

static const struct
{
  guint window;
  gboolean live;
} cases[] = {
  {4, FALSE}, {30, FALSE}, {150, FALSE}, {4, TRUE}, {30, TRUE}, {150, TRUE}
};

/* Without the first frames, which come as fast as possible, and the last ones, which are drained: their latency means
 * nothing. */
GST_START_TEST (the_measured_latency_is_the_reported_one_within_a_frame)
{
  const guint window = cases[__i__].window;
  const GstClockTime ours = window * FRAME;
  gchar *text =
      g_strdup_printf ("videotestsrc name=source is-live=%d num-buffers=%u ! "
      "video/x-raw, width=64, height=48, framerate=%d/1 ! "
      "l1l2stab name=stab window=%u ! fakesink sync=true",
      cases[__i__].live, 2 * window + ENOUGH, RATE, window);
  GstElement *pipeline = gst_parse_launch (text, NULL);
  guint64 median;

  measured = g_array_new (FALSE, FALSE, sizeof (guint64));
  gst_debug_add_log_function (read_tracer, NULL, NULL);
  stab_play_to_end (pipeline, "the live source");
  fail_unless_equals_uint64 (latency_of (pipeline, "stab"),
      latency_of (pipeline, "source") + ours);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_debug_remove_log_function (read_tracer);

  fail_unless_equals_int (measured->len, 2 * window + ENOUGH);
  g_array_remove_range (measured, window + ENOUGH, window);
  g_array_remove_range (measured, 0, window);
  g_array_sort (measured, compare);
  median = g_array_index (measured, guint64, ENOUGH / 2);
  g_print ("window %u, %s: reported %.1f ms, measured %.1f ms\n", window,
      cases[__i__].live ? "live" : "not live", ours / 1e6, median / 1e6);
  /* One frame, and a millisecond for the scheduling of two threads. */
  fail_unless (ABS (GST_CLOCK_DIFF (ours, median)) <= FRAME + GST_MSECOND);
  g_array_unref (measured);
  gst_object_unref (pipeline);
  g_free (text);
}

GST_END_TEST;

/* --- a sink that drops what is late --- */

static void
assert_nothing_was_late (GstElement * pipeline, guint64 n_frames)
{
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  GstStructure *stats;
  guint64 rendered = 0, dropped = 0;

  g_object_get (sink, "stats", &stats, NULL);
  gst_structure_get_uint64 (stats, "rendered", &rendered);
  gst_structure_get_uint64 (stats, "dropped", &dropped);
  fail_unless_equals_uint64 (dropped, 0);
  fail_unless_equals_uint64 (rendered, n_frames);
  gst_structure_free (stats);
  gst_object_unref (sink);
}

GST_START_TEST (a_source_at_half_its_nominal_rate_is_not_late_at_the_sink)
{
  GstElement *pipeline = gst_parse_launch ("videotestsrc is-live=true "
      "num-buffers=40 ! video/x-raw, width=64, height=48, framerate=10/1 ! "
      "capssetter caps=video/x-raw,framerate=20/1 ! l1l2stab window=20 ! "
      "fakesink name=sink sync=true max-lateness=0", NULL);

  stab_play_to_end (pipeline, "the live source");
  assert_nothing_was_late (pipeline, 40);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
}

GST_END_TEST;

static GstPadProbeReturn
leave_a_gap (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  const GstClockTime pts = GST_BUFFER_PTS (GST_PAD_PROBE_INFO_BUFFER (info));

  if (pts >= 2 * GST_SECOND && pts < 5 * GST_SECOND)
    return GST_PAD_PROBE_DROP;
  (*(guint *) user_data)++;
  return GST_PAD_PROBE_OK;
}

GST_START_TEST (a_source_with_a_gap_of_three_seconds_is_not_late_at_the_sink)
{
  GstElement *pipeline = gst_parse_launch ("videotestsrc is-live=true "
      "num-buffers=140 ! video/x-raw, width=64, height=48, framerate=20/1 ! "
      "l1l2stab name=stab window=20 ! "
      "fakesink name=sink sync=true max-lateness=0", NULL);
  GstElement *stab = gst_bin_get_by_name (GST_BIN (pipeline), "stab");
  GstPad *pad = gst_element_get_static_pad (stab, "sink");
  guint n_frames = 0;

  gst_pad_add_probe (pad, GST_PAD_PROBE_TYPE_BUFFER, leave_a_gap, &n_frames,
      NULL);
  stab_play_to_end (pipeline, "the live source");
  fail_unless_equals_int (n_frames, 80);
  assert_nothing_was_late (pipeline, n_frames);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pad);
  gst_object_unref (stab);
  gst_object_unref (pipeline);
}

GST_END_TEST;

static Suite *
realtime_suite (void)
{
  Suite *s = suite_create ("realtime");
  TCase *tc = tcase_create ("realtime");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      the_measured_latency_is_the_reported_one_within_a_frame, 0,
      G_N_ELEMENTS (cases));
  tcase_add_test (tc,
      a_source_at_half_its_nominal_rate_is_not_late_at_the_sink);
  tcase_add_test (tc,
      a_source_with_a_gap_of_three_seconds_is_not_late_at_the_sink);
  return s;
}

GST_CHECK_MAIN (realtime);
