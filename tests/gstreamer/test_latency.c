/* SPDX-License-Identifier: MIT */
/* The latency: the window in frames plus the latency of upstream. */
#include "stabharness.h"

typedef struct
{
  gboolean live;
  GstClockTime least, most;
} Latency;

/* What the source pad of the harness answers; NULL: no upstream latency. */
static const Latency *upstream;

static gboolean
answer (GstPad * pad, GstObject * parent, GstQuery * query)
{
  if (GST_QUERY_TYPE (query) != GST_QUERY_LATENCY)
    return gst_pad_query_default (pad, parent, query);
  if (!upstream)
    return FALSE;
  gst_query_set_latency (query, upstream->live, upstream->least,
      upstream->most);
  return TRUE;
}

static gboolean
ask (GstHarness * h, Latency * latency)
{
  GstQuery *query = gst_query_new_latency ();
  gboolean ret;

  gst_pad_set_query_function (h->srcpad, answer);
  ret = gst_pad_peer_query (h->sinkpad, query);
  gst_query_parse_latency (query, &latency->live, &latency->least,
      &latency->most);
  gst_query_unref (query);
  return ret;
}

static const Latency no_latency = { FALSE, 0, GST_CLOCK_TIME_NONE };

static const struct
{
  gint window;
  const gchar *rate;
  GstClockTime latency;
} cases[] = {
  {4, "30/1", GST_SECOND * 4 / 30},
  {30, "30/1", GST_SECOND},
  {150, "30/1", 5 * GST_SECOND},
  {4, "60/1", GST_SECOND * 4 / 60},
  {30, "60/1", GST_SECOND / 2},
  {150, "60/1", GST_SECOND * 5 / 2},
  {4, "30000/1001", GST_USECOND * 400400 / 3},
  {30, "30000/1001", GST_MSECOND * 1001},
  {150, "30000/1001", GST_MSECOND * 5005},
  {4, "0/1", GST_MSECOND * 160},
  {30, "0/1", GST_MSECOND * 1200},
  {150, "0/1", GST_SECOND * 6},
};

GST_START_TEST (the_latency_is_the_window_in_frames)
{
  gchar *caps = g_strdup_printf ("video/x-raw, format=I420, width=64, "
      "height=48, framerate=%s", cases[__i__].rate);
  GstHarness *h = stab_harness_new (caps, "window", cases[__i__].window, NULL);
  Latency latency;

  upstream = &no_latency;
  fail_unless (ask (h, &latency));
  fail_unless_equals_uint64 (latency.least, cases[__i__].latency);
  fail_unless_equals_uint64 (latency.most, GST_CLOCK_TIME_NONE);
  g_free (caps);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (the_minimum_and_the_maximum_of_upstream_are_both_raised)
{
  const Latency live = { TRUE, 20 * GST_MSECOND, 300 * GST_MSECOND };
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", 10, NULL);
  Latency latency;

  upstream = &live;
  fail_unless (ask (h, &latency));
  fail_unless (latency.live);
  fail_unless_equals_uint64 (latency.least, 420 * GST_MSECOND);
  fail_unless_equals_uint64 (latency.most, 700 * GST_MSECOND);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_latency_that_would_overflow_is_the_largest_one)
{
  const GstClockTime largest = GST_CLOCK_TIME_NONE - 1;
  const Latency live = { TRUE, largest - GST_MSECOND, largest };
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", 10, NULL);
  Latency latency;

  upstream = &live;
  fail_unless (ask (h, &latency));
  fail_unless_equals_uint64 (latency.least, largest);
  fail_unless_equals_uint64 (latency.most, largest);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (without_an_answer_from_upstream_the_query_fails)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", 10, NULL);
  Latency latency;

  upstream = NULL;
  fail_if (ask (h, &latency));
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (before_the_caps_are_known_25_frames_a_second_are_assumed)
{
  GstHarness *h = stab_harness_new (NULL, "window", 25, NULL);
  Latency latency;

  upstream = &no_latency;
  fail_unless (ask (h, &latency));
  fail_unless_equals_uint64 (latency.least, GST_SECOND);
  stab_harness_free (h);
}

GST_END_TEST;

static gboolean
latency_was_posted (GstHarness * h)
{
  GstMessage *message = stab_harness_message (h, GST_MESSAGE_LATENCY);
  const gboolean posted = message != NULL;

  if (message)
    gst_message_unref (message);
  return posted;
}

static void
set_rate (GstHarness * h, const gchar * rate)
{
  gchar *text = g_strdup_printf ("video/x-raw, format=I420, width=64, "
      "height=48, framerate=%s", rate);
  GstCaps *caps = gst_caps_from_string (text);

  fail_unless (gst_harness_push_event (h, gst_event_new_caps (caps)));
  gst_caps_unref (caps);
  g_free (text);
}

GST_START_TEST (a_message_is_posted_when_the_latency_changes_and_only_then)
{
  GstHarness *h = stab_harness_new (NULL, "window", 8, NULL);

  gst_harness_set_src_caps_str (h, "video/x-raw, format=I420, width=64, "
      "height=48, framerate=30/1");
  fail_unless (latency_was_posted (h));
  set_rate (h, "60/1");
  fail_unless (latency_was_posted (h));
  set_rate (h, "60/1");
  fail_if (latency_was_posted (h));
  g_object_set (h->element, "window", 16, NULL);
  set_rate (h, "120/1");
  fail_if (latency_was_posted (h));     /* 16 frames of 1/120 s are 8 of 1/60 s */
  set_rate (h, "60/1");
  fail_unless (latency_was_posted (h));
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
latency_suite (void)
{
  Suite *s = suite_create ("latency");
  TCase *tc = tcase_create ("latency");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, the_latency_is_the_window_in_frames, 0,
      G_N_ELEMENTS (cases));
  tcase_add_test (tc, the_minimum_and_the_maximum_of_upstream_are_both_raised);
  tcase_add_test (tc, a_latency_that_would_overflow_is_the_largest_one);
  tcase_add_test (tc, without_an_answer_from_upstream_the_query_fails);
  tcase_add_test (tc, before_the_caps_are_known_25_frames_a_second_are_assumed);
  tcase_add_test (tc,
      a_message_is_posted_when_the_latency_changes_and_only_then);
  return s;
}

GST_CHECK_MAIN (latency);
