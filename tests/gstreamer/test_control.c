/* SPDX-License-Identifier: MIT */
/* lambda and crop-ratio during playback, set by the application or controlled by stream time. The reference is the
 * library with the same values for the same frames. */
#include <gst/controller/gstdirectcontrolbinding.h>
#include <gst/controller/gstinterpolationcontrolsource.h>

#include "stabnoise.h"

#define WINDOW 6
#define N_FRAMES 24
#define CHANGED 12              /* the first frame that comes in after a change */

/* The values of each frame. */
typedef struct
{
  gdouble lambda[N_FRAMES], crop_ratio[N_FRAMES];
} Settings;

static void
init_settings (Settings * settings, gdouble lambda_then, gdouble crop_ratio_then)
{
  guint i;

  for (i = 0; i < N_FRAMES; i++) {
    settings->lambda[i] = i < CHANGED ? 0.5 : lambda_then;
    settings->crop_ratio[i] = i < CHANGED ? 0.9 : crop_ratio_then;
  }
}

static void
pull_from_library (L1L2Stab * stab, gint width, gint height, GPtrArray * out)
{
  guint8 *pixels = g_malloc (width * height);
  L1L2StabFrame frame = { 0 };

  frame.data[0] = pixels;
  frame.stride[0] = width;
  fail_unless_equals_int (l1l2stab_pull (stab, &frame, NULL), L1L2STAB_OK);
  g_ptr_array_add (out, g_bytes_new_take (pixels, width * height));
}

/* The frames that the library renders, as GBytes. */
static GPtrArray *
run_library (const Settings * settings, L1L2StabOutputSize size)
{
  GPtrArray *out = g_ptr_array_new_with_free_func ((GDestroyNotify)
      g_bytes_unref);
  guint8 *inputs = g_malloc (N_FRAMES * NOISE_WIDTH * NOISE_HEIGHT);
  L1L2StabConfig config;
  L1L2Stab *stab = NULL;
  gint width, height;
  guint i;

  stab_noise_config (&config, WINDOW);
  config.output_size = size;
  fail_unless_equals_int (l1l2stab_create (&stab, &config), L1L2STAB_OK);
  l1l2stab_config_output_size (&config, &width, &height);
  for (i = 0; i < N_FRAMES; i++) {
    L1L2StabFrame frame = { 0 };

    frame.data[0] = inputs + i * NOISE_WIDTH * NOISE_HEIGHT;
    frame.stride[0] = NOISE_WIDTH;
    stab_noise_fill (frame.data[0], i);
    if (settings->lambda[i] != (i ? settings->lambda[i - 1] : config.lambda))
      l1l2stab_set_lambda (stab, settings->lambda[i]);
    if (settings->crop_ratio[i] != (i ? settings->crop_ratio[i - 1]
            : config.crop_ratio))
      l1l2stab_set_crop_ratio (stab, settings->crop_ratio[i]);
    fail_unless_equals_int (l1l2stab_push (stab, &frame), L1L2STAB_OK);
    if (i >= WINDOW - 1)
      pull_from_library (stab, width, height, out);
  }
  l1l2stab_finish (stab);
  while (out->len < N_FRAMES)
    pull_from_library (stab, width, height, out);
  l1l2stab_free (&stab);
  g_free (inputs);
  return out;
}

static GstHarness *
noise_harness_new (L1L2StabOutputSize size)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);

  g_object_set (h->element, "output-size", size, NULL);
  gst_harness_set_src_caps_str (h, NOISE_CAPS);
  return h;
}

/* The frames that the element renders, as GBytes. Their timestamps start at `base`. Before each frame its values are
 * set, unless `settings` is NULL. */
static GPtrArray *
run_element (GstHarness * h, const Settings * settings, GstClockTime base)
{
  GPtrArray *out = g_ptr_array_new_with_free_func ((GDestroyNotify)
      g_bytes_unref);
  GstBuffer *buffer;
  guint i;

  for (i = 0; i < N_FRAMES; i++) {
    buffer = stab_noise_new (i);
    GST_BUFFER_PTS (buffer) += base;
    if (settings)
      g_object_set (h->element, "lambda", settings->lambda[i], "crop-ratio",
          settings->crop_ratio[i], NULL);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  while ((buffer = gst_harness_try_pull (h)) != NULL) {
    GstMapInfo map;

    fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READ));
    g_ptr_array_add (out, g_bytes_new (map.data, map.size));
    gst_buffer_unmap (buffer, &map);
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_int (out->len, N_FRAMES);
  return out;
}

/* The first frame in which the two runs differ; N_FRAMES: none. */
static guint
first_difference (GPtrArray * a, GPtrArray * b)
{
  guint i;

  for (i = 0; i < N_FRAMES; i++)
    if (!g_bytes_equal (g_ptr_array_index (a, i), g_ptr_array_index (b, i)))
      break;
  return i;
}

static const struct
{
  gdouble lambda, crop_ratio;
  L1L2StabOutputSize size;
} changes[] = {
  {100, 0.9, L1L2STAB_OUTPUT_SIZE_INPUT},
  {0.5, 0.6, L1L2STAB_OUTPUT_SIZE_INPUT},
  {0.5, 0.6, L1L2STAB_OUTPUT_SIZE_CROP},
  {2, 0.99, L1L2STAB_OUTPUT_SIZE_CROP},
};

GST_START_TEST (a_change_while_playing_applies_to_frames_that_come_in_later)
{
  const L1L2StabOutputSize size = changes[__i__].size;
  GstHarness *plain_h = noise_harness_new (size);
  GstHarness *changed_h = noise_harness_new (size);
  GPtrArray *plain, *changed, *expected;
  Settings settings;
  guint changed_at;

  init_settings (&settings, changes[__i__].lambda, changes[__i__].crop_ratio);
  plain = run_element (plain_h, NULL, 0);
  changed = run_element (changed_h, &settings, 0);
  expected = run_library (&settings, size);

  /* Held frames that share a window with a later frame can differ too. */
  changed_at = first_difference (changed, plain);
  fail_unless (changed_at > CHANGED - WINDOW && changed_at <= CHANGED + 1,
      "frame %u is the first to differ", changed_at);
  fail_unless_equals_int (first_difference (changed, expected), N_FRAMES);

  g_ptr_array_unref (plain);
  g_ptr_array_unref (changed);
  g_ptr_array_unref (expected);
  stab_harness_free (plain_h);
  stab_harness_free (changed_h);
}

GST_END_TEST;

/* From 0.95 down to 0.55 over the frames. */
static GstControlSource *
slope_new (void)
{
  GstControlSource *source = gst_interpolation_control_source_new ();
  GstTimedValueControlSource *timed =
      GST_TIMED_VALUE_CONTROL_SOURCE (source);

  g_object_set (source, "mode", GST_INTERPOLATION_MODE_LINEAR, NULL);
  gst_timed_value_control_source_set (timed, 0, 0.95);
  gst_timed_value_control_source_set (timed, N_FRAMES * FRAME_DURATION, 0.55);
  return source;
}

/* The timestamps of the frames are far behind the slope, but their stream times start with it. */
static GPtrArray *
run_controlled (GstControlSource * source, L1L2StabOutputSize size)
{
  const GstClockTime base = 100 * GST_SECOND;
  GstHarness *h = noise_harness_new (size);
  GstSegment segment;
  GPtrArray *out;

  fail_unless (gst_object_add_control_binding (GST_OBJECT (h->element),
          gst_direct_control_binding_new_absolute (GST_OBJECT (h->element),
              "crop-ratio", source)));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = base;
  segment.time = 0;
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  out = run_element (h, NULL, base);
  stab_harness_free (h);
  return out;
}

GST_START_TEST (a_controller_drives_crop_ratio_by_stream_time)
{
  const L1L2StabOutputSize size = __i__;
  GstControlSource *source = slope_new ();
  GPtrArray *one, *two, *expected;
  Settings settings;
  guint i;

  init_settings (&settings, 0.5, 0.9);
  for (i = 0; i < N_FRAMES; i++)
    fail_unless (gst_control_source_get_value (source, i * FRAME_DURATION,
            &settings.crop_ratio[i]));
  fail_unless (settings.crop_ratio[0] > settings.crop_ratio[N_FRAMES - 1] + 0.3);

  one = run_controlled (source, size);
  two = run_controlled (source, size);
  expected = run_library (&settings, size);
  fail_unless_equals_int (first_difference (one, two), N_FRAMES);
  fail_unless_equals_int (first_difference (one, expected), N_FRAMES);

  g_ptr_array_unref (one);
  g_ptr_array_unref (two);
  g_ptr_array_unref (expected);
  gst_object_unref (source);
}

GST_END_TEST;

static gint
output_width (GstHarness * h)
{
  GstCaps *caps = gst_pad_get_current_caps (h->sinkpad);
  gint width = 0;

  gst_structure_get_int (gst_caps_get_structure (caps, 0), "width", &width);
  gst_caps_unref (caps);
  return width;
}

GST_START_TEST (with_output_size_crop_the_size_waits_for_new_caps)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstCaps *caps = gst_caps_from_string (SMALL_CAPS);
  GString *line;

  g_object_set (h->element, "output-size", L1L2STAB_OUTPUT_SIZE_CROP, NULL);
  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  stab_push_frames (h, 0, WINDOW);
  stab_pull_frames (h, 0, 1);
  line = stab_record_new (h);
  g_object_set (h->element, "crop-ratio", 0.5, NULL);
  gst_harness_push_upstream_event (h, gst_event_new_reconfigure ());
  stab_push_frames (h, WINDOW, 1);
  gst_harness_push_event (h, gst_event_new_caps (caps));
  stab_push_frames (h, WINDOW + 1, 1);
  stab_pull_frames (h, 1, 2);
  fail_if (strstr (line->str, "caps"), "%s", line->str);
  fail_unless_equals_int (output_width (h), 56);

  gst_harness_set_src_caps_str (h, "video/x-raw, format=I420, width=96, "
      "height=48, framerate=25/1");
  stab_push_frames (h, WINDOW + 2, WINDOW);
  fail_unless_equals_int (output_width (h), 48);
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

static GstHarnessThread *
stress (GstHarness * h, const gchar * name, gdouble number)
{
  GValue value = G_VALUE_INIT;
  GstHarnessThread *thread;

  g_value_init (&value, G_TYPE_DOUBLE);
  g_value_set_double (&value, number);
  thread = gst_harness_stress_property_start (h, name, &value);
  g_value_unset (&value);
  return thread;
}

GST_START_TEST (threads_that_change_both_lose_no_frame)
{
  static const gchar *caps[] = { SMALL_CAPS,
    "video/x-raw, format=I420, width=96, height=48, framerate=25/1"
  };
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstHarnessThread *threads[4];
  guint i;

  g_object_set (h->element, "output-size", L1L2STAB_OUTPUT_SIZE_CROP, NULL);
  threads[0] = stress (h, "lambda", 0.1);
  threads[1] = stress (h, "lambda", 2);
  threads[2] = stress (h, "crop-ratio", 0.5);
  threads[3] = stress (h, "crop-ratio", 0.99);
  /* With new caps the size could change between the negotiation and the opening of the library. */
  for (i = 0; i < 400; i++) {
    if (i % 10 == 0)
      gst_harness_set_src_caps_str (h, caps[i / 10 % 2]);
    stab_push_frames (h, i, 1);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < G_N_ELEMENTS (threads); i++)
    gst_harness_stress_thread_stop (threads[i]);
  fail_unless_equals_int (gst_harness_buffers_received (h), 400);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
control_suite (void)
{
  Suite *s = suite_create ("control");
  TCase *tc = tcase_create ("control");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      a_change_while_playing_applies_to_frames_that_come_in_later, 0,
      G_N_ELEMENTS (changes));
  tcase_add_loop_test (tc, a_controller_drives_crop_ratio_by_stream_time,
      L1L2STAB_OUTPUT_SIZE_INPUT, L1L2STAB_OUTPUT_SIZE_CROP + 1);
  tcase_add_test (tc, with_output_size_crop_the_size_waits_for_new_caps);
  tcase_add_test (tc, threads_that_change_both_lose_no_frame);
  return s;
}

GST_CHECK_MAIN (control);
