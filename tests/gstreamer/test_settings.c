/* SPDX-License-Identifier: MIT */
/* Properties: they have the defaults and ranges of the library's fields, and contradictions between them are errors. */
#include <l1l2stab/l1l2stab.h>

#include "stabharness.h"

static void
init_config (L1L2StabConfig * config)
{
  l1l2stab_config_init (config, sizeof (*config));
  config->format = L1L2STAB_FORMAT_I420;
  config->width = 64;
  config->height = 48;
}

GST_START_TEST (the_defaults_are_the_librarys)
{
  GstElement *element = gst_element_factory_make ("l1l2stab", NULL);
  L1L2StabConfig config;
  gdouble lambda, crop_ratio;
  gint window, overlap, join, model, shutter, interpolation, output_size, border,
      fill_frames, threads;
  gboolean qos, bypass, post_messages;
  gchar *motion_in, *motion_out, *region, *mask;

  init_config (&config);
  g_object_get (element, "lambda", &lambda, "crop-ratio", &crop_ratio,
      "window", &window, "overlap", &overlap, "join", &join, "interpolation",
      &interpolation, "output-size", &output_size,
      "border", &border, "fill-frames", &fill_frames, "threads", &threads, "qos",
      &qos, "motion-model", &model,
      "rolling-shutter", &shutter, "bypass", &bypass, "post-messages",
      &post_messages, "motion-in", &motion_in, "motion-out", &motion_out,
      "region", &region, "mask", &mask, NULL);
  fail_unless_equals_float (lambda, config.lambda);
  fail_unless_equals_float (crop_ratio, config.crop_ratio);
  fail_unless_equals_int (window, config.window);
  fail_unless_equals_int (overlap, config.overlap);
  fail_unless_equals_int (join, config.join);
  fail_unless_equals_int (interpolation, config.interpolation);
  fail_unless_equals_int (output_size, config.output_size);
  fail_unless_equals_int (border, config.border);
  fail_unless_equals_int (fill_frames, config.fill_frames);
  fail_unless_equals_int (threads, config.threads);
  fail_unless_equals_int (model, config.motion_model);
  fail_unless_equals_int (shutter, config.rolling_shutter);
  fail_if (qos || bypass || post_messages || motion_in || motion_out);
  fail_if (region || mask);
  gst_object_unref (element);
}

GST_END_TEST;

static const struct
{
  const gchar *property;
  goffset field;
} numbers[] = {
  {"lambda", G_STRUCT_OFFSET (L1L2StabConfig, lambda)},
  {"crop-ratio", G_STRUCT_OFFSET (L1L2StabConfig, crop_ratio)},
  {"window", G_STRUCT_OFFSET (L1L2StabConfig, window)},
  {"threads", G_STRUCT_OFFSET (L1L2StabConfig, threads)},
};

static gboolean
library_takes (gint i, gboolean is_double, gdouble value)
{
  L1L2StabConfig config;

  init_config (&config);
  if (is_double)
    G_STRUCT_MEMBER (double, &config, numbers[i].field) = value;
  else
    G_STRUCT_MEMBER (int, &config, numbers[i].field) = (int) value;
  return l1l2stab_config_delay (&config) > 0;
}

GST_START_TEST (the_ranges_are_the_librarys)
{
  GstElement *element = gst_element_factory_make ("l1l2stab", NULL);
  GParamSpec *spec = g_object_class_find_property
      (G_OBJECT_GET_CLASS (element), numbers[__i__].property);
  const gboolean is_double = G_IS_PARAM_SPEC_DOUBLE (spec);
  const gdouble least = is_double ? G_PARAM_SPEC_DOUBLE (spec)->minimum :
      G_PARAM_SPEC_INT (spec)->minimum;
  const gdouble most = is_double ? G_PARAM_SPEC_DOUBLE (spec)->maximum :
      G_PARAM_SPEC_INT (spec)->maximum;
  const gdouble step = is_double ? 1e-6 : 1;

  fail_unless (library_takes (__i__, is_double, least));
  fail_unless (library_takes (__i__, is_double, most));
  fail_if (library_takes (__i__, is_double, least - step));
  fail_if (library_takes (__i__, is_double, most + step));
  gst_object_unref (element);
}

GST_END_TEST;

/* GLib logs a WARNING up to 2.74 and a CRITICAL in 2.84. Criticals are fatal in this test. */
static void
assert_window_is_refused (GstElement * element, gint window)
{
  const GLogLevelFlags fatal = g_log_set_always_fatal (G_LOG_FATAL_MASK);

  _gst_check_raised_warning = _gst_check_raised_critical = FALSE;
  _gst_check_expecting_log = TRUE;
  g_object_set (element, "window", window, NULL);
  _gst_check_expecting_log = FALSE;
  g_log_set_always_fatal (fatal);
  fail_unless (_gst_check_raised_warning || _gst_check_raised_critical);
}

GST_START_TEST (a_value_out_of_range_is_refused)
{
  GstElement *element = gst_element_factory_make ("l1l2stab", NULL);
  gint window;

  assert_window_is_refused (element, 3);
  assert_window_is_refused (element, 901);
  g_object_get (element, "window", &window, NULL);
  fail_unless_equals_int (window, 150);
  gst_object_unref (element);
}

GST_END_TEST;

/* The flags of the properties that can change during playback. No other property can. */
static const struct
{
  const gchar *name;
  GParamFlags flags;
} moments[] = {
  {"lambda", GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING},
  {"crop-ratio", GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING},
  {"bypass", GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING},
  {"post-messages", GST_PARAM_MUTABLE_PLAYING},
  {"border-map", GST_PARAM_MUTABLE_PLAYING},
  {"stats", 0},
};

GST_START_TEST (flags_say_which_properties_can_change_while_playing)
{
  static const GParamFlags mask = GST_PARAM_CONTROLLABLE
      | GST_PARAM_MUTABLE_READY | GST_PARAM_MUTABLE_PAUSED
      | GST_PARAM_MUTABLE_PLAYING;
  GstElement *element = gst_element_factory_make ("l1l2stab", NULL);
  GParamSpec **specs;
  guint n, i, k, n_others = 0;

  specs = g_object_class_list_properties (G_OBJECT_GET_CLASS (element), &n);
  for (i = 0; i < n; i++) {
    GParamFlags expected = GST_PARAM_MUTABLE_READY;

    if (specs[i]->owner_type != G_OBJECT_TYPE (element))
      continue;
    for (k = 0; k < G_N_ELEMENTS (moments); k++) {
      if (g_str_equal (specs[i]->name, moments[k].name))
        expected = moments[k].flags;
    }
    n_others += expected == GST_PARAM_MUTABLE_READY;
    fail_unless ((specs[i]->flags & mask) == expected, "%s", specs[i]->name);
    fail_unless (g_param_spec_get_blurb (specs[i]) != NULL);
  }
  fail_unless (n_others >= 9);
  g_free (specs);
  gst_object_unref (element);
}

GST_END_TEST;

static const gchar *names[] = {
  "lambda", "window", "overlap", "crop-ratio", "join", "interpolation",
  "output-size", "threads", "motion-model", "bypass", "post-messages",
  "motion-in", "motion-out", "rolling-shutter", "region", "mask"
};

GST_START_TEST (every_property_reads_back_its_value)
{
  GstElement *element = gst_element_factory_make ("l1l2stab", NULL);
  static const gchar *values[] = {
    "2.25", "60", "20", "0.75", "blend", "lanczos", "crop", "3", "affine",
    "true", "true", "a.motion", "b.motion", "mixture",
    "10%,0,80%,50%", "a.pgm"
  };
  guint i;

  for (i = 0; i < G_N_ELEMENTS (names); i++) {
    GParamSpec *spec = g_object_class_find_property
        (G_OBJECT_GET_CLASS (element), names[i]);
    GValue value = G_VALUE_INIT;
    gchar *text;

    fail_unless (spec && (spec->flags & G_PARAM_READWRITE)
        == G_PARAM_READWRITE);
    gst_util_set_object_arg (G_OBJECT (element), names[i], values[i]);
    g_value_init (&value, spec->value_type);
    g_object_get_property (G_OBJECT (element), names[i], &value);
    text = G_VALUE_HOLDS_STRING (&value) ? g_value_dup_string (&value)
        : gst_value_serialize (&value);
    fail_unless_equals_string (text, values[i]);
    g_free (text);
    g_value_unset (&value);
  }
  gst_object_unref (element);
}

GST_END_TEST;

/* Takes the error from the bus and checks that its text has all of the words. */
static void
assert_error_says (GstBus * bus, const gchar * const *words)
{
  GstMessage *message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  GError *error = NULL;

  fail_unless (message != NULL, "no error was posted");
  gst_message_parse_error (message, &error, NULL);
  fail_unless (g_error_matches (error, GST_LIBRARY_ERROR,
          GST_LIBRARY_ERROR_SETTINGS));
  for (; *words; words++)
    fail_unless (strstr (error->message, *words) != NULL,
        "\"%s\" does not say %s", error->message, *words);
  g_clear_error (&error);
  gst_message_unref (message);
}

static const struct
{
  const gchar *description;
  const gchar *words[5];
} contradictions[] = {
  {"l1l2stab window=20 overlap=20", {"overlap is 20", "window=20", "3 to 19"}},
  {"l1l2stab window=20 overlap=2", {"overlap is 2", "3 to 19"}},
  {"l1l2stab window=20 overlap=11 join=blend",
      {"overlap is 11", "join=blend", "3 to 10"}},
  {"l1l2stab window=5 join=blend", {"window is 5", "join=blend", "at least 6"}},
  {"l1l2stab window=20 overlap=20 output-size=crop", {"overlap is 20"}},
};

GST_START_TEST (a_contradiction_fails_at_the_start_and_says_what_to_change)
{
  GstElement *element =
      gst_parse_launch (contradictions[__i__].description, NULL);
  GstBus *bus = gst_bus_new ();

  gst_element_set_bus (element, bus);
  fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  assert_error_says (bus, contradictions[__i__].words);
  gst_element_set_state (element, GST_STATE_NULL);
  gst_element_set_bus (element, NULL);
  gst_object_unref (bus);
  gst_object_unref (element);
}

GST_END_TEST;

GST_START_TEST (a_contradiction_while_running_fails_at_the_next_caps)
{
  static const gchar *words[] = { "overlap is 9", "3 to 7", NULL };
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", 8, NULL);
  GstCaps *caps = gst_caps_from_string ("video/x-raw, format=I420, width=96, "
      "height=48, framerate=25/1");
  GstBus *bus = gst_element_get_bus (h->element);

  g_object_set (h->element, "overlap", 9, NULL);
  stab_push_frames (h, 0, 8);
  stab_pull_frames (h, 0, 1);
  gst_harness_push_event (h, gst_event_new_caps (caps));
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 7);
  assert_error_says (bus, words);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new (h, 8)),
      GST_FLOW_NOT_NEGOTIATED);
  gst_object_unref (bus);
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_change_while_running_waits_for_the_next_caps)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", 8, NULL);

  g_object_set (h->element, "window", 4, NULL);
  stab_push_frames (h, 0, 9);
  stab_pull_frames (h, 0, 2);
  gst_harness_set_src_caps_str (h, "video/x-raw, format=NV12, width=64, "
      "height=48, framerate=25/1");
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 7);
  stab_push_frames (h, 9, 4);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 8);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (settings_may_be_changed_from_another_thread)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", 4, NULL);
  GValue value = G_VALUE_INIT;
  GstHarnessThread *thread;
  guint i;

  g_value_init (&value, G_TYPE_DOUBLE);
  g_value_set_double (&value, 0.25);
  thread = gst_harness_stress_property_start (h, "lambda", &value);
  for (i = 0; i < 200; i++) {
    GstBuffer *buffer = stab_frame_new (h, i);

    if (i % 20 == 0)
      GST_BUFFER_FLAG_SET (buffer, GST_BUFFER_FLAG_DISCONT);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  gst_harness_stress_thread_stop (thread);
  fail_unless_equals_int (gst_harness_buffers_received (h), 200);
  g_value_unset (&value);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
settings_suite (void)
{
  Suite *s = suite_create ("settings");
  TCase *tc = tcase_create ("settings");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, the_defaults_are_the_librarys);
  tcase_add_loop_test (tc, the_ranges_are_the_librarys, 0,
      G_N_ELEMENTS (numbers));
  tcase_add_test (tc, a_value_out_of_range_is_refused);
  tcase_add_test (tc, flags_say_which_properties_can_change_while_playing);
  tcase_add_test (tc, every_property_reads_back_its_value);
  tcase_add_loop_test (tc,
      a_contradiction_fails_at_the_start_and_says_what_to_change, 0,
      G_N_ELEMENTS (contradictions));
  tcase_add_test (tc, a_contradiction_while_running_fails_at_the_next_caps);
  tcase_add_test (tc, a_change_while_running_waits_for_the_next_caps);
  tcase_add_test (tc, settings_may_be_changed_from_another_thread);
  return s;
}

GST_CHECK_MAIN (settings);
