/* SPDX-License-Identifier: MIT */
/* Negotiation: which video is accepted, and with which caps it comes out. */
#include "stabharness.h"

#define WINDOW 4

static const gchar *formats[] = {
  "I420", "NV12", "YV12", "NV21", "Y42B", "NV16", "NV61", "YUY2", "UYVY",
  "YVYU", "VYUY", "Y444", "NV24", "AYUV", "VUYA", "Y41B", "A420", "AV12",
  "BGRx", "RGBx", "xRGB", "xBGR", "BGRA", "RGBA", "ARGB", "ABGR", "BGR", "RGB",
  "GBR", "GBRA", "GRAY8",
#if G_BYTE_ORDER == G_LITTLE_ENDIAN
  "I420_10LE", "P010_10LE", "I420_12LE", "P012_LE", "P016_LE", "I422_10LE",
  "I422_12LE", "Y444_10LE", "Y444_12LE", "Y444_16LE", "A420_10LE", "A422_10LE",
  "A444_10LE", "GBR_10LE", "GBR_12LE", "GBRA_10LE", "GBRA_12LE", "BGRA64_LE",
  "RGBA64_LE", "ARGB64_LE", "ABGR64_LE", "ARGB64", "AYUV64", "GRAY16_LE",
#endif
};

static const struct
{
  gint width, height;
} sizes[] = {
  {16, 16}, {17, 19}, {33, 16}, {63, 47}, {64, 48}
};

static gchar *
caps_text (const gchar * format, gint width, gint height)
{
  return g_strdup_printf ("video/x-raw, format=%s, width=%d, height=%d, "
      "framerate=25/1", format, width, height);
}

GST_START_TEST (every_format_passes_unchanged_at_even_and_odd_sizes)
{
  guint i;

  for (i = 0; i < G_N_ELEMENTS (sizes); i++) {
    gchar *caps = caps_text (formats[__i__], sizes[i].width, sizes[i].height);
    GstHarness *h = stab_harness_new (caps, "window", WINDOW, NULL);

    stab_push_frames (h, 0, WINDOW + 2);
    gst_harness_push_event (h, gst_event_new_eos ());
    stab_pull_frames (h, 0, WINDOW + 2);
    stab_harness_free (h);
    g_free (caps);
  }
}

GST_END_TEST;

GST_START_TEST (a_very_wide_frame_is_accepted)
{
  GstHarness *h = stab_harness_new ("video/x-raw, format=I420, width=8192, "
      "height=64, framerate=25/1", "window", WINDOW, NULL);

  stab_push_frames (h, 0, WINDOW + 1);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, WINDOW + 1);
  stab_harness_free (h);
}

GST_END_TEST;

static gboolean
is_accepted (GstHarness * h, const gchar * text)
{
  GstCaps *caps = gst_caps_from_string (text);
  gboolean ret = gst_pad_peer_query_accept_caps (h->srcpad, caps);

  gst_caps_unref (caps);
  return ret;
}

GST_START_TEST (only_progressive_mono_linear_video_of_usable_size_is_accepted)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);

  fail_unless (is_accepted (h, SMALL_CAPS));
  fail_unless (is_accepted (h, SMALL_CAPS ", interlace-mode=progressive"));
  fail_unless (is_accepted (h, SMALL_CAPS ", multiview-mode=mono"));
  fail_if (is_accepted (h, SMALL_CAPS ", interlace-mode=interleaved"));
  fail_if (is_accepted (h, SMALL_CAPS ", interlace-mode=mixed"));
  fail_if (is_accepted (h, SMALL_CAPS ", interlace-mode=fields"));
  fail_if (is_accepted (h, "video/x-raw(format:Interlaced), format=I420, "
          "width=64, height=48, framerate=25/1, interlace-mode=alternate"));
  fail_if (is_accepted (h, SMALL_CAPS ", multiview-mode=side-by-side"));
  fail_if (is_accepted (h, SMALL_CAPS ", multiview-mode=frame-by-frame"));
  fail_if (is_accepted (h,
          "video/x-raw(memory:GLMemory), format=RGBA, width=64, height=48, "
          "framerate=25/1"));
  fail_if (is_accepted (h,
          "video/x-raw(memory:DMABuf), format=I420, width=64, height=48, "
          "framerate=25/1"));
  fail_if (is_accepted (h, "video/x-raw, format=NV12_4L4, width=64, "
          "height=48, framerate=25/1"));
  fail_if (is_accepted (h,
          "video/x-raw, format=I420, width=2, height=2, framerate=25/1"));
  fail_if (is_accepted (h,
          "video/x-raw, format=I420, width=15, height=48, framerate=25/1"));
  fail_unless (is_accepted (h,
          "video/x-raw, format=I420, width=16384, height=16, framerate=25/1"));
  fail_if (is_accepted (h,
          "video/x-raw, format=I420, width=16385, height=16, framerate=25/1"));
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (only_system_memory_is_offered)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GList *item = gst_element_class_get_pad_template_list
      (GST_ELEMENT_GET_CLASS (h->element));
  guint i;

  fail_unless_equals_int (g_list_length (item), 2);
  for (; item; item = item->next) {
    GstCaps *caps = gst_pad_template_get_caps (item->data);

    for (i = 0; i < gst_caps_get_size (caps); i++)
      fail_unless (gst_caps_features_is_equal (gst_caps_get_features (caps, i),
              GST_CAPS_FEATURES_MEMORY_SYSTEM_MEMORY));
    gst_caps_unref (caps);
  }
  stab_harness_free (h);
}

GST_END_TEST;

static const gchar *kept[] = {
  SMALL_CAPS,
  SMALL_CAPS ", interlace-mode=progressive, multiview-mode=mono, "
      "pixel-aspect-ratio=64/45, colorimetry=bt2020, chroma-site=mpeg2",
  SMALL_CAPS ", colorimetry=1:4:0:0, chroma-site=jpeg, "
      "content-light-level=(string)1000:400, mastering-display-info=(string)"
      "34000:16000:13250:34500:7500:3000:15635:16450:10000000:500",
  "video/x-raw, format=NV12, width=64, height=48, framerate=0/1, "
      "max-framerate=60/1, chroma-site=cosited",
  "video/x-raw, format=P010_10LE, width=63, height=47, framerate=60000/1001, "
      "colorimetry=bt2100-pq, chroma-site=cosited, pixel-aspect-ratio=4/3, "
      "mastering-display-info=(string)35400:14600:8500:39850:6550:2300:15635:"
      "16450:10000000:50, content-light-level=(string)1000:400",
  "video/x-raw, format=NV12, width=64, height=48, framerate=1000/1"
};

GST_START_TEST (all_fields_of_the_caps_are_kept)
{
  GstHarness *h = stab_harness_new (kept[__i__], "window", WINDOW, NULL);
  GstCaps *expected = gst_caps_from_string (kept[__i__]);
  GstCaps *caps;

  stab_push_frames (h, 0, WINDOW);
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_caps_is_strictly_equal (caps, expected), "%" GST_PTR_FORMAT,
      caps);
  gst_caps_unref (caps);
  gst_caps_unref (expected);
  stab_harness_free (h);
}

GST_END_TEST;

/* A clock's rate in place of a frame rate: an encoder would take it for true. */
GST_START_TEST (a_frame_rate_that_no_video_has_goes_out_as_variable)
{
  GstHarness *h = stab_harness_new ("video/x-raw, format=GRAY8, width=64, "
      "height=48, framerate=90000/1", "window", WINDOW, NULL);
  GstCaps *caps, *accepted, *clock_rate;
  gint fps_n, fps_d;

  stab_push_frames (h, 0, WINDOW);
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &fps_n, &fps_d) && fps_n == 0, "%" GST_PTR_FORMAT, caps);
  /* As where no rate is known: 25 frames a second are assumed. */
  fail_unless_equals_uint64 (gst_harness_query_latency (h),
      WINDOW * GST_SECOND / 25);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, WINDOW);
  gst_caps_unref (caps);
  stab_harness_free (h);

  /* A downstream element that takes variable rates only. */
  h = stab_harness_new (NULL, "window", WINDOW, NULL);
  gst_harness_set_sink_caps_str (h, "video/x-raw, format=GRAY8, width=64, "
      "height=48, framerate=0/1");
  accepted = gst_pad_peer_query_caps (h->srcpad, NULL);
  clock_rate = gst_caps_from_string ("video/x-raw, format=GRAY8, width=64, "
      "height=48, framerate=90000/1");
  fail_unless (gst_caps_can_intersect (accepted, clock_rate),
      "%" GST_PTR_FORMAT, accepted);
  gst_caps_set_simple (clock_rate, "framerate", GST_TYPE_FRACTION, 30, 1, NULL);
  fail_if (gst_caps_can_intersect (accepted, clock_rate),
      "%" GST_PTR_FORMAT, accepted);
  gst_caps_unref (clock_rate);
  gst_caps_unref (accepted);
  stab_harness_free (h);
}

GST_END_TEST;

static const struct
{
  gint width, height;
  gdouble ratio;
  gint out_width, out_height;
} crops[] = {
  {64, 48, 0.9, 56, 42},
  {63, 47, 0.5, 30, 22},
  {16, 16, 0.5, 8, 8},
  {640, 360, 0.8, 512, 288},
};

GST_START_TEST (output_size_crop_gives_the_crop_windows_size_in_even_numbers)
{
  GstCaps *in = gst_caps_from_string (kept[1]);
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, "crop-ratio",
      crops[__i__].ratio, NULL);
  GstCaps *caps;
  gchar *in_text;

  gst_util_set_object_arg (G_OBJECT (h->element), "output-size", "crop");
  gst_caps_set_simple (in, "width", G_TYPE_INT, crops[__i__].width, "height",
      G_TYPE_INT, crops[__i__].height, NULL);
  in_text = gst_caps_to_string (in);
  gst_harness_set_src_caps_str (h, in_text);

  stab_push_frames (h, 0, WINDOW);
  gst_harness_push_event (h, gst_event_new_eos ());
  caps = gst_pad_get_current_caps (h->sinkpad);
  gst_caps_set_simple (in, "width", G_TYPE_INT, crops[__i__].out_width,
      "height", G_TYPE_INT, crops[__i__].out_height, NULL);
  fail_unless (gst_caps_is_strictly_equal (caps, in), "%" GST_PTR_FORMAT, caps);
  stab_pull_frames (h, 0, WINDOW);

  gst_caps_unref (caps);
  gst_caps_unref (in);
  g_free (in_text);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (upstream_is_offered_what_downstream_accepts)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstCaps *caps;
  const GstStructure *s;

  gst_harness_set_sink_caps_str (h,
      "video/x-raw, format={ I420, NV12 }, width=[ 1, 320 ]");
  caps = gst_pad_peer_query_caps (h->srcpad, NULL);
  fail_unless_equals_int (gst_caps_get_size (caps), 1);
  s = gst_caps_get_structure (caps, 0);
  fail_unless_equals_int (gst_value_list_get_size (gst_structure_get_value (s,
              "format")), 2);
  fail_unless_equals_int (gst_value_get_int_range_max (gst_structure_get_value
          (s, "width")), 320);
  fail_unless_equals_string (gst_structure_get_string (s, "interlace-mode"),
      "progressive");
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (with_output_size_crop_upstream_may_choose_any_size)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstCaps *caps;
  const GValue *width;

  gst_util_set_object_arg (G_OBJECT (h->element), "output-size", "crop");
  gst_harness_set_sink_caps_str (h,
      "video/x-raw, format=I420, width=56, height=42");
  caps = gst_pad_peer_query_caps (h->srcpad, NULL);
  width = gst_structure_get_value (gst_caps_get_structure (caps, 0), "width");
  fail_unless (GST_VALUE_HOLDS_INT_RANGE (width));
  gst_caps_unref (caps);

  fail_unless (is_accepted (h, SMALL_CAPS));
  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  stab_push_frames (h, 0, WINDOW);
  fail_unless_equals_int (gst_harness_buffers_received (h), 1);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
caps_suite (void)
{
  Suite *s = suite_create ("caps");
  TCase *tc = tcase_create ("caps");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc,
      every_format_passes_unchanged_at_even_and_odd_sizes, 0,
      G_N_ELEMENTS (formats));
  tcase_add_test (tc, a_very_wide_frame_is_accepted);
  tcase_add_test (tc,
      only_progressive_mono_linear_video_of_usable_size_is_accepted);
  tcase_add_test (tc, only_system_memory_is_offered);
  tcase_add_loop_test (tc, all_fields_of_the_caps_are_kept, 0,
      G_N_ELEMENTS (kept));
  tcase_add_test (tc, a_frame_rate_that_no_video_has_goes_out_as_variable);
  tcase_add_loop_test (tc,
      output_size_crop_gives_the_crop_windows_size_in_even_numbers, 0,
      G_N_ELEMENTS (crops));
  tcase_add_test (tc, upstream_is_offered_what_downstream_accepts);
  tcase_add_test (tc, with_output_size_crop_upstream_may_choose_any_size);
  return s;
}

GST_CHECK_MAIN (caps);
