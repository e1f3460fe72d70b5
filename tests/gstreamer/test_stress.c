/* SPDX-License-Identifier: MIT */
/* A thousand random actions with a fixed seed: no frame is lost or comes twice, and nothing blocks forever. What
 * comes out of the element is compared at its pads with what went in. */
#include <gst/check/gsttestclock.h>

#include "stabharness.h"

#define N_ROUNDS 1000
#define PATIENCE (20 * GST_SECOND)

/* A segment among the frames. */
#define SEGMENT_MARK GST_CLOCK_TIME_NONE

/* The frames that are inside, by their timestamps, and the segments between them. The probes of both pads run under the
 * same stream lock. */
typedef struct
{
  GQueue inside;
  guint n_out;
  gchar *fault;                 /* the first; the test's own thread reports it */
} Monitor;

static void
forget (Monitor * monitor)
{
  GstClockTime *pts;

  while ((pts = g_queue_pop_head (&monitor->inside)) != NULL)
    g_free (pts);
}

static GstPadProbeReturn
goes_in (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  Monitor *monitor = user_data;
  GstClockTime mark = SEGMENT_MARK;

  if (GST_PAD_PROBE_INFO_TYPE (info) & GST_PAD_PROBE_TYPE_BUFFER)
    mark = GST_BUFFER_PTS (GST_PAD_PROBE_INFO_BUFFER (info));
  else if (GST_EVENT_TYPE (GST_PAD_PROBE_INFO_EVENT (info))
      != GST_EVENT_SEGMENT)
    return GST_PAD_PROBE_OK;
  g_queue_push_tail (&monitor->inside, g_memdup2 (&mark, sizeof (mark)));
  return GST_PAD_PROBE_OK;
}

/* A pad that could not push caps while it was flushing pushes them before the next segment, so segments are
 * not counted. */
static gboolean
has_frames (const Monitor * monitor)
{
  const GList *link;

  for (link = monitor->inside.head; link; link = link->next) {
    if (*(const GstClockTime *) link->data != SEGMENT_MARK)
      return TRUE;
  }
  return FALSE;
}

/* A frame that comes out must be the oldest one that is held. */
static void
take_oldest (Monitor * monitor, GstClockTime mark)
{
  GstClockTime *oldest = g_queue_pop_head (&monitor->inside);

  if (!monitor->fault && !(oldest && *oldest == mark))
    monitor->fault = g_strdup_printf ("%" GST_TIME_FORMAT " came out, not %"
        GST_TIME_FORMAT "; %u more are inside", GST_TIME_ARGS (mark),
        GST_TIME_ARGS (oldest ? *oldest : 0),
        g_queue_get_length (&monitor->inside));
  g_free (oldest);
}

static GstPadProbeReturn
comes_out (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  Monitor *monitor = user_data;

  if (GST_PAD_PROBE_INFO_TYPE (info) & GST_PAD_PROBE_TYPE_BUFFER) {
    take_oldest (monitor, GST_BUFFER_PTS (GST_PAD_PROBE_INFO_BUFFER (info)));
    monitor->n_out++;
    return GST_PAD_PROBE_OK;
  }
  switch (GST_EVENT_TYPE (GST_PAD_PROBE_INFO_EVENT (info))) {
    case GST_EVENT_FLUSH_STOP:
      forget (monitor);
      break;
    case GST_EVENT_SEGMENT:
      take_oldest (monitor, SEGMENT_MARK);
      break;
    case GST_EVENT_STREAM_START:
    case GST_EVENT_CAPS:
    case GST_EVENT_SEGMENT_DONE:
    case GST_EVENT_EOS:
      if (!monitor->fault && has_frames (monitor))
        monitor->fault = g_strdup_printf ("%s overtakes a frame",
            GST_EVENT_TYPE_NAME (GST_PAD_PROBE_INFO_EVENT (info)));
      break;
    default:
      break;
  }
  return GST_PAD_PROBE_OK;
}

static void
monitor_element (Monitor * monitor, GstElement * element)
{
  GstPad *sink = gst_element_get_static_pad (element, "sink");
  GstPad *src = gst_element_get_static_pad (element, "src");
  GstPad *peer = gst_pad_get_peer (src);

  g_queue_init (&monitor->inside);
  monitor->n_out = 0;
  monitor->fault = NULL;
  gst_pad_add_probe (sink, GST_PAD_PROBE_TYPE_BUFFER |
      GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, goes_in, monitor, NULL);
  /* On the pad of the peer, because nothing comes out while that pad is stopped. */
  gst_pad_add_probe (peer, GST_PAD_PROBE_TYPE_BUFFER |
      GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM | GST_PAD_PROBE_TYPE_EVENT_FLUSH,
      comes_out, monitor, NULL);
  gst_object_unref (sink);
  gst_object_unref (src);
  gst_object_unref (peer);
}

static const gchar *caps_list[] = {
  "video/x-raw, format=I420, width=64, height=48, framerate=25/1",
  "video/x-raw, format=NV12, width=64, height=48, framerate=25/1",
  "video/x-raw, format=GRAY8, width=35, height=33, framerate=25/1",
  "video/x-raw, format=RGB, width=48, height=32, framerate=50/1",
  "video/x-raw, format=I420, width=64, height=48, framerate=0/1",
};

static void
change_a_property (GRand * rand, GstElement * stab)
{
  switch (g_rand_int_range (rand, 0, 4)) {
    case 0:
      g_object_set (stab, "lambda", g_rand_double_range (rand, 0, 3), NULL);
      break;
    case 1:
      g_object_set (stab, "crop-ratio", g_rand_double_range (rand, 0.6, 0.95),
          NULL);
      break;
    case 2:
      g_object_set (stab, "bypass", g_rand_boolean (rand), NULL);
      break;
    default:
      g_object_set (stab, "window", g_rand_int_range (rand, 4, 12), NULL);
      break;
  }
}

/* --- a harness: all actions from one thread, with the task of the timer in parallel --- */

typedef struct
{
  GRand *rand;
  GstHarness *h;
  GstClock *clock;
  guint next;                   /* frame */
} Play;

static void
push_some (Play * play)
{
  const guint n = g_rand_int_range (play->rand, 1, 14);
  guint i;

  for (i = 0; i < n; i++) {
    GstBuffer *buffer = stab_frame_new (play->h, play->next++);

    if (g_rand_int_range (play->rand, 0, 25) == 0)
      GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
    if (g_rand_int_range (play->rand, 0, 25) == 0)
      play->next += g_rand_int_range (play->rand, 0, 20);
    if (gst_clock_get_time (play->clock) < GST_BUFFER_PTS (buffer))
      gst_harness_set_time (play->h, GST_BUFFER_PTS (buffer));
    fail_unless_equals_int (gst_harness_push (play->h, buffer), GST_FLOW_OK);
  }
}

/* Often an update of the segment before it. */
static void
push_segment (Play * play)
{
  const gdouble rates[] = { 1, 2, 0.5, -1 };
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = rates[g_rand_int_range (play->rand, 0, 4)];
  if (g_rand_int_range (play->rand, 0, 5) == 0)
    segment.flags = GST_SEGMENT_FLAG_TRICKMODE_KEY_UNITS;
  segment.stop = GST_SECOND * 100000;
  gst_harness_push_event (play->h, gst_event_new_segment (&segment));
}

static void
start_anew (Play * play, Monitor * monitor)
{
  gst_element_set_state (play->h->element, g_rand_boolean (play->rand) ?
      GST_STATE_NULL : GST_STATE_READY);
  forget (monitor);
  gst_element_set_state (play->h->element, GST_STATE_PLAYING);
  gst_harness_push_event (play->h, gst_event_new_stream_start ("again"));
  gst_harness_set_src_caps_str (play->h, caps_list[0]);
  push_segment (play);
}

static void
flush (Play * play)
{
  gst_harness_push_event (play->h, gst_event_new_flush_start ());
  gst_harness_push_event (play->h, gst_event_new_flush_stop (FALSE));
  push_segment (play);
}

/* Ends the next wait of the timer's task, if there is one. */
static void
let_time_pass (Play * play)
{
  if (gst_test_clock_peek_id_count (GST_TEST_CLOCK (play->clock)) > 0)
    gst_test_clock_crank (GST_TEST_CLOCK (play->clock));
}

static void
push_an_event (Play * play)
{
  GstHarness *h = play->h;
  GstQuery *query;

  switch (g_rand_int_range (play->rand, 0, 4)) {
    case 0:
      gst_harness_push_event (h, gst_event_new_tag (gst_tag_list_new
              (GST_TAG_TITLE, "title", NULL)));
      break;
    case 1:
      gst_harness_push_event (h, gst_event_new_gap (play->next * FRAME_DURATION,
              FRAME_DURATION));
      break;
    case 2:
      gst_harness_push_event (h, gst_event_new_segment_done (GST_FORMAT_TIME,
              play->next * FRAME_DURATION));
      break;
    default:
      query = gst_query_new_drain ();
      gst_pad_peer_query (h->srcpad, query);
      gst_query_unref (query);
      break;
  }
}

GST_START_TEST (a_thousand_random_events_lose_no_frame)
{
  Play play = { g_rand_new_with_seed (7 + __i__), NULL, NULL, 0 };
  Monitor monitor;
  guint round;

  play.h = stab_harness_new (NULL, "window", 6, NULL);
  play.clock = GST_CLOCK (gst_harness_get_testclock (play.h));
  gst_harness_set_drop_buffers (play.h, TRUE);
  monitor_element (&monitor, play.h->element);
  start_anew (&play, &monitor);
  for (round = 0; round < N_ROUNDS; round++) {
    switch (g_rand_int_range (play.rand, 0, 12)) {
      case 0:
        flush (&play);
        break;
      case 1:
        gst_harness_set_src_caps_str (play.h,
            caps_list[g_rand_int_range (play.rand, 0,
                    G_N_ELEMENTS (caps_list))]);
        break;
      case 2:
        push_segment (&play);
        break;
      case 3:
        start_anew (&play, &monitor);
        break;
      case 4:
        let_time_pass (&play);
        break;
      case 5:
        change_a_property (play.rand, play.h->element);
        break;
      case 6:
        push_an_event (&play);
        break;
      default:
        push_some (&play);
        break;
    }
    fail_if (monitor.fault, "round %u: %s", round, monitor.fault);
  }
  gst_harness_push_event (play.h, gst_event_new_eos ());
  fail_unless (monitor.n_out > N_ROUNDS);
  fail_unless (stab_harness_message (play.h, GST_MESSAGE_ERROR) == NULL);
  g_rand_free (play.rand);
  gst_object_unref (play.clock);
  stab_harness_free (play.h);
}

GST_END_TEST;

/* --- a pipeline: the thread of the source, the task of the timer and the application in parallel --- */

/* A live source delivers no frame in PAUSED, so there is nothing to wait for. */
static void
set_state (GstElement * pipeline, GstState state, gboolean live)
{
  GstStateChangeReturn ret = gst_element_set_state (pipeline, state);

  if (ret == GST_STATE_CHANGE_ASYNC && !live)
    ret = gst_element_get_state (pipeline, NULL, NULL, PATIENCE);
  fail_unless (ret == GST_STATE_CHANGE_SUCCESS || live, "to %s: %s",
      gst_element_state_get_name (state),
      gst_element_state_change_return_get_name (ret));
}

static void
seek (GRand * rand, GstElement * pipeline, gboolean live)
{
  const gdouble rates[] = { 1, 1, 2, live ? 1 : -1 };
  const gint64 start = g_rand_int_range (rand, 0, 100) * FRAME_DURATION;
  GstSeekFlags flags = GST_SEEK_FLAG_FLUSH;

  if (g_rand_int_range (rand, 0, 4) == 0)
    flags |= GST_SEEK_FLAG_TRICKMODE_KEY_UNITS;
  gst_element_seek (pipeline, rates[g_rand_int_range (rand, 0, 4)],
      GST_FORMAT_TIME, flags, GST_SEEK_TYPE_SET, start, GST_SEEK_TYPE_SET,
      start + g_rand_int_range (rand, 1, 60) * FRAME_DURATION);
}

static void
set_caps (GRand * rand, GstElement * filter)
{
  GstCaps *caps = gst_caps_from_string (caps_list[g_rand_int_range (rand, 0,
              G_N_ELEMENTS (caps_list))]);

  /* A high frame rate, so that a live source fills a window now and then. */
  gst_caps_set_simple (caps, "framerate", GST_TYPE_FRACTION, 400, 1, NULL);
  g_object_set (filter, "caps", caps, NULL);
  gst_caps_unref (caps);
}

static void
change_state (GRand * rand, GstElement * pipeline, gboolean live,
    Monitor * monitor)
{
  const GstState state = g_rand_int_range (rand, GST_STATE_NULL,
      GST_STATE_PLAYING + 1);

  set_state (pipeline, state, live);
  if (state <= GST_STATE_READY) {
    forget (monitor);
    set_state (pipeline, GST_STATE_PLAYING, live);
  }
}

static const gchar *pipelines[] = {
  "videotestsrc ! capsfilter name=caps ! l1l2stab name=stab window=6 ! "
      "fakesink",
  "videotestsrc is-live=true ! capsfilter name=caps ! "
      "l1l2stab name=stab window=6 ! fakesink",
};

GST_START_TEST (a_thousand_seeks_and_changes_of_caps_and_state_lose_no_frame)
{
  const gboolean live = __i__ == 1;
  GRand *rand = g_rand_new_with_seed (11);
  GstElement *pipeline = gst_parse_launch (pipelines[__i__], NULL);
  GstElement *stab = gst_bin_get_by_name (GST_BIN (pipeline), "stab");
  GstElement *filter = gst_bin_get_by_name (GST_BIN (pipeline), "caps");
  GstBus *bus = gst_element_get_bus (pipeline);
  Monitor monitor;
  guint round;

  monitor_element (&monitor, stab);
  set_caps (rand, filter);
  set_state (pipeline, GST_STATE_PLAYING, live);
  for (round = 0; round < N_ROUNDS; round++) {
    switch (g_rand_int_range (rand, 0, 5)) {
      case 0:
        set_caps (rand, filter);
        break;
      case 1:
        change_state (rand, pipeline, live, &monitor);
        break;
      case 2:
        change_a_property (rand, stab);
        break;
      default:
        seek (rand, pipeline, live);
        break;
    }
    g_usleep (g_rand_int_range (rand, 0, 4000));
    fail_if (monitor.fault, "round %u: %s", round, monitor.fault);
  }
  set_state (pipeline, GST_STATE_NULL, live);
  forget (&monitor);
  fail_unless (monitor.n_out > 20, "%u frames came out", monitor.n_out);
  fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR) == NULL);
  g_rand_free (rand);
  gst_object_unref (bus);
  gst_object_unref (filter);
  gst_object_unref (stab);
  gst_object_unref (pipeline);
}

GST_END_TEST;

static Suite *
stress_suite (void)
{
  Suite *s = suite_create ("stress");
  TCase *tc = tcase_create ("stress");

  suite_add_tcase (s, tc);
  tcase_set_timeout (tc, 120);
  tcase_add_loop_test (tc, a_thousand_random_events_lose_no_frame, 0, 3);
  tcase_add_loop_test (tc,
      a_thousand_seeks_and_changes_of_caps_and_state_lose_no_frame, 0,
      G_N_ELEMENTS (pipelines));
  return s;
}

GST_CHECK_MAIN (stress);
