/* SPDX-License-Identifier: MIT */
/* What an application does during playback: bypass, navigation events, and QoS events. */
#include <gst/controller/gstdirectcontrolbinding.h>
#include <gst/controller/gstinterpolationcontrolsource.h>
#include <math.h>

#include "stabnoise.h"

#define WINDOW 6
#define N_FRAMES 100
#define ON 20                   /* the first frame out after the switch */
#define RAMP L1L2STAB_BYPASS_FRAMES

static gboolean
is_whole (GstBuffer * buffer, guint index)
{
  GstBuffer *source = stab_noise_new (index);
  GstMapInfo map;
  gboolean whole;

  fail_unless (gst_buffer_map (source, &map, GST_MAP_READ));
  whole = gst_buffer_memcmp (buffer, 0, map.data, map.size) == 0;
  gst_buffer_unmap (source, &map);
  gst_buffer_unref (source);
  return whole;
}

/* Fails unless the output frames from frame `start` on are whole source frames, except for the last `rest`. */
static void
assert_whole (GstHarness * h, guint start, guint rest)
{
  guint i;

  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = gst_harness_try_pull (h);

    fail_unless (buffer != NULL);
    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    fail_unless (is_whole (buffer, i) == (i >= start && i < N_FRAMES - rest),
        "frame %u", i);
    gst_buffer_unref (buffer);
  }
}

GST_START_TEST (a_bypass_acts_on_the_next_frame_out_and_keeps_the_delay)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  guint i;

  g_object_set (h->element, "rolling-shutter", __i__, NULL);
  gst_harness_set_src_caps_str (h, NOISE_CAPS);
  for (i = 0; i < N_FRAMES; i++) {
    g_object_set (h->element, "bypass", i >= ON + WINDOW - 1, NULL);
    stab_noise_push (h, i, 1);
    fail_unless_equals_int (gst_harness_buffers_received (h),
        i < WINDOW - 1 ? 0 : i - WINDOW + 2);
  }
  g_object_set (h->element, "bypass", FALSE, NULL);
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_whole (h, ON + RAMP - 1, WINDOW - 1);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_stream_that_starts_bypassed_is_whole_from_its_first_frame)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);

  g_object_set (h->element, "bypass", TRUE, NULL);
  stab_noise_push (h, 0, N_FRAMES);
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_whole (h, 0, 0);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_controller_switches_the_bypass_by_the_time_of_the_frame_out)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  GstControlSource *source = gst_interpolation_control_source_new ();
  GstTimedValueControlSource *timed = GST_TIMED_VALUE_CONTROL_SOURCE (source);

  g_object_set (source, "mode", GST_INTERPOLATION_MODE_NONE, NULL);
  gst_timed_value_control_source_set (timed, 0, 0);
  gst_timed_value_control_source_set (timed, ON * FRAME_DURATION, 1);
  gst_object_add_control_binding (GST_OBJECT (h->element),
      gst_direct_control_binding_new_absolute (GST_OBJECT (h->element),
          "bypass", source));
  stab_noise_push (h, 0, N_FRAMES);
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_whole (h, ON + RAMP - 1, 0);
  gst_object_unref (source);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_bypass_with_output_size_crop_shows_the_middle)
{
  const guint left = (NOISE_WIDTH - 120) / 2, top = (NOISE_HEIGHT - 90) / 2;
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstBuffer *source = stab_noise_new (0), *buffer;
  GstMapInfo map;
  guint row;

  g_object_set (h->element, "output-size", L1L2STAB_OUTPUT_SIZE_CROP,
      "crop-ratio", 0.75, "bypass", TRUE, NULL);
  gst_harness_set_src_caps_str (h, NOISE_CAPS);
  stab_noise_push (h, 0, WINDOW);
  buffer = gst_harness_pull (h);
  fail_unless (gst_buffer_map (source, &map, GST_MAP_READ));
  for (row = 0; row < 90; row++)
    fail_unless (gst_buffer_memcmp (buffer, row * 120,
            map.data + (top + row) * NOISE_WIDTH + left, 120) == 0);
  gst_buffer_unmap (source, &map);
  gst_buffer_unref (source);
  gst_buffer_unref (buffer);
  stab_harness_free (h);
}

GST_END_TEST;

static GstEvent *
new_pointer (guint kind, gdouble x, gdouble y)
{
  switch (kind) {
    case 0:
      return gst_navigation_event_new_mouse_move (x, y,
          GST_NAVIGATION_MODIFIER_NONE);
    case 1:
      return gst_navigation_event_new_mouse_button_press (1, x, y,
          GST_NAVIGATION_MODIFIER_NONE);
    case 2:
      return gst_navigation_event_new_mouse_scroll (x, y, 1, 2,
          GST_NAVIGATION_MODIFIER_NONE);
    case 3:
      return gst_navigation_event_new_touch_down (7, x, y, 0.5,
          GST_NAVIGATION_MODIFIER_NONE);
    default:
      return gst_navigation_event_new_touch_motion (7, x, y, 0.5,
          GST_NAVIGATION_MODIFIER_NONE);
  }
}

static void
get_pointer (GstEvent * event, gdouble * x, gdouble * y)
{
  fail_unless (gst_structure_get (gst_event_get_structure (event),
          "pointer_x", G_TYPE_DOUBLE, x, "pointer_y", G_TYPE_DOUBLE, y, NULL));
}

/* Sends an event upstream and returns the one that arrives there. */
static GstEvent *
send_up (GstHarness * h, GstEvent * event)
{
  GstEvent *arrived;

  gst_harness_push_upstream_event (h, event);
  do {
    arrived = gst_harness_pull_upstream_event (h);
    if (GST_EVENT_TYPE (arrived) == GST_EVENT_NAVIGATION)
      return arrived;
    gst_event_unref (arrived);
  } while (TRUE);
}

GST_START_TEST (a_pointer_over_the_last_frame_out_points_at_its_source)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  gdouble x = 40, y = 100, m[9];
  GstBuffer *buffer;
  GstEvent *event = send_up (h, new_pointer (__i__, x, y));
  gdouble found_x, found_y;
  guint i;

  /* No frame has gone out yet. */
  get_pointer (event, &found_x, &found_y);
  fail_unless (found_x == x && found_y == y);
  gst_event_unref (event);

  stab_noise_push (h, 0, 2 * WINDOW);
  for (i = 0; i < WINDOW; i++)
    gst_buffer_unref (gst_harness_pull (h));
  buffer = gst_harness_pull (h);
  stab_get_matrix (gst_custom_meta_get_structure (gst_buffer_get_custom_meta
          (buffer, "GstL1L2StabMeta")), "to-source", m);
  event = send_up (h, new_pointer (__i__, x, y));
  get_pointer (event, &found_x, &found_y);
  fail_unless (fabs (found_x - (m[0] * x + m[1] * y + m[2])) < 1e-9);
  fail_unless (fabs (found_y - (m[3] * x + m[4] * y + m[5])) < 1e-9);
  fail_unless (fabs (found_x - x) > 0.5);
  gst_event_unref (event);
  gst_buffer_unref (buffer);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_key_goes_upstream_as_it_is)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  GstEvent *event;
  const gchar *key = NULL;

  stab_noise_push (h, 0, WINDOW);
  event = send_up (h, gst_navigation_event_new_key_press ("space",
          GST_NAVIGATION_MODIFIER_NONE));
  fail_unless (gst_navigation_event_parse_key_event (event, &key));
  fail_unless_equals_string (key, "space");
  gst_event_unref (event);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (lateness_drops_no_input_whatever_qos_says)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  gboolean found = FALSE;
  guint i;

  for (i = 0; i < 3 * WINDOW; i++) {
    g_object_set (h->element, "qos", TRUE, NULL);
    gst_harness_push_upstream_event (h, gst_event_new_qos
        (GST_QOS_TYPE_UNDERFLOW, 2.0, 10 * GST_SECOND, 0));
    stab_noise_push (h, i, 1);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (h), 3 * WINDOW);
  /* The event goes upstream, where less work can be done. */
  while (!found) {
    GstEvent *event = gst_harness_try_pull_upstream_event (h);

    fail_unless (event != NULL);
    found = GST_EVENT_TYPE (event) == GST_EVENT_QOS;
    gst_event_unref (event);
  }
  stab_harness_free (h);
}

GST_END_TEST;

static GstHarnessThread *
switch_on_and_on (GstHarness * h, const gchar * name, gboolean on)
{
  GValue value = G_VALUE_INIT;

  g_value_init (&value, G_TYPE_BOOLEAN);
  g_value_set_boolean (&value, on);
  return gst_harness_stress_property_start (h, name, &value);
}

static void
read_and_point (gpointer thread, gpointer harness)
{
  GstHarness *h = harness;
  GstStructure *stats = NULL;

  g_object_get (h->element, "stats", &stats, NULL);
  gst_structure_free (stats);
  gst_pad_push_event (h->sinkpad, new_pointer (0, 10, 20));
}

GST_START_TEST (threads_that_switch_read_and_point_lose_no_frame)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  GstHarnessThread *threads[5];
  GstStructure *stats = NULL;
  guint64 out;
  guint i;

  threads[0] = switch_on_and_on (h, "bypass", TRUE);
  threads[1] = switch_on_and_on (h, "bypass", FALSE);
  threads[2] = switch_on_and_on (h, "post-messages", TRUE);
  threads[3] = switch_on_and_on (h, "post-messages", FALSE);
  threads[4] = gst_harness_stress_custom_start (h, NULL, read_and_point, h,
      100);
  stab_noise_push (h, 0, 3 * N_FRAMES);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < G_N_ELEMENTS (threads); i++)
    gst_harness_stress_thread_stop (threads[i]);
  fail_unless_equals_int (gst_harness_buffers_received (h), 3 * N_FRAMES);
  g_object_get (h->element, "stats", &stats, NULL);
  fail_unless (gst_structure_get_uint64 (stats, "frames-out", &out));
  fail_unless_equals_uint64 (out, 3 * N_FRAMES);
  gst_structure_free (stats);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
live_suite (void)
{
  Suite *s = suite_create ("live");
  TCase *tc = tcase_create ("live");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      a_bypass_acts_on_the_next_frame_out_and_keeps_the_delay,
      L1L2STAB_ROLLING_SHUTTER_NONE, L1L2STAB_ROLLING_SHUTTER_MIXTURE + 1);
  tcase_add_test (tc,
      a_stream_that_starts_bypassed_is_whole_from_its_first_frame);
  tcase_add_test (tc,
      a_controller_switches_the_bypass_by_the_time_of_the_frame_out);
  tcase_add_test (tc, a_bypass_with_output_size_crop_shows_the_middle);
  tcase_add_loop_test (tc,
      a_pointer_over_the_last_frame_out_points_at_its_source, 0, 5);
  tcase_add_test (tc, a_key_goes_upstream_as_it_is);
  tcase_add_test (tc, threads_that_switch_read_and_point_lose_no_frame);
  tcase_add_test (tc, lateness_drops_no_input_whatever_qos_says);
  return s;
}

GST_CHECK_MAIN (live);
