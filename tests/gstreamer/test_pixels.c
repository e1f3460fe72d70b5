/* SPDX-License-Identifier: MIT */
/* The output frames equal those that the library renders from the same frames with the same settings. */
#include <l1l2stab/l1l2stab.h>

#include "stabharness.h"

#define WINDOW 6
#define N_FRAMES (2 * WINDOW + 3)
#define WIDTH 161
#define HEIGHT 121

static const struct
{
  const gchar *name;
  L1L2StabFormat format;
} formats[] = {
  {"GRAY8", L1L2STAB_FORMAT_GRAY8},
  {"I420", L1L2STAB_FORMAT_I420},
  {"YV12", L1L2STAB_FORMAT_YV12},
  {"NV12", L1L2STAB_FORMAT_NV12},
  {"NV21", L1L2STAB_FORMAT_NV21},
  {"Y42B", L1L2STAB_FORMAT_Y42B},
  {"Y444", L1L2STAB_FORMAT_Y444},
  {"BGRx", L1L2STAB_FORMAT_BGRX},
  {"RGBx", L1L2STAB_FORMAT_RGBX},
  {"BGRA", L1L2STAB_FORMAT_BGRA},
  {"RGBA", L1L2STAB_FORMAT_RGBA},
  {"BGR", L1L2STAB_FORMAT_BGR},
  {"RGB", L1L2STAB_FORMAT_RGB},
};

#define LEFT L1L2STAB_CHROMA_SITE_LEFT
#define CENTER L1L2STAB_CHROMA_SITE_CENTER
#define TOP_LEFT L1L2STAB_CHROMA_SITE_TOP_LEFT
#define CONTINUOUS L1L2STAB_JOIN_CONTINUOUS
#define BLEND L1L2STAB_JOIN_BLEND
#define BILINEAR L1L2STAB_INTERPOLATION_BILINEAR
#define BICUBIC L1L2STAB_INTERPOLATION_BICUBIC
#define LANCZOS L1L2STAB_INTERPOLATION_LANCZOS
#define INPUT L1L2STAB_OUTPUT_SIZE_INPUT
#define CROP L1L2STAB_OUTPUT_SIZE_CROP

/* A setting as a property of the element and as a field of the library's config. */
typedef struct
{
  const gchar *caps, *properties;
  gdouble frame_rate;
  L1L2StabChromaSite site;
  gdouble lambda, crop_ratio;
  gint overlap;
  L1L2StabJoin join;
  L1L2StabInterpolation interpolation;
  L1L2StabOutputSize size;
} Setting;

static const Setting settings[] = {
  {"framerate=0/1", "lambda=100", 0, LEFT, 100, 0.9, 0, CONTINUOUS, BICUBIC,
      INPUT},
  {"framerate=240/1", "lambda=100", 240, LEFT, 100, 0.9, 0, CONTINUOUS, BICUBIC,
      INPUT},
  {"framerate=25/1, chroma-site=mpeg2", "",
      25, LEFT, 0.5, 0.9, 0, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1, chroma-site=mpeg2, colorimetry=bt709", "",
      25, LEFT, 0.5, 0.9, 0, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1, chroma-site=jpeg", "",
      25, CENTER, 0.5, 0.9, 0, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1, chroma-site=cosited", "",
      25, TOP_LEFT, 0.5, 0.9, 0, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1", "lambda=100",
      25, LEFT, 100, 0.9, 0, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1", "crop-ratio=0.7",
      25, LEFT, 0.5, 0.7, 0, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1", "overlap=5",
      25, LEFT, 0.5, 0.9, 5, CONTINUOUS, BICUBIC, INPUT},
  {"framerate=25/1", "join=blend overlap=3",
      25, LEFT, 0.5, 0.9, 3, BLEND, BICUBIC, INPUT},
  {"framerate=25/1", "interpolation=bilinear",
      25, LEFT, 0.5, 0.9, 0, CONTINUOUS, BILINEAR, INPUT},
  {"framerate=25/1", "interpolation=lanczos",
      25, LEFT, 0.5, 0.9, 0, CONTINUOUS, LANCZOS, INPUT},
  {"framerate=25/1", "output-size=crop",
      25, LEFT, 0.5, 0.9, 0, CONTINUOUS, BICUBIC, CROP},
};

static void
init_config (L1L2StabConfig * config, const Setting * setting,
    L1L2StabFormat format)
{
  l1l2stab_config_init (config, sizeof (*config));
  config->format = format;
  config->width = WIDTH;
  config->height = HEIGHT;
  config->window = WINDOW;
  config->frame_rate = setting->frame_rate;
  config->chroma_site = setting->site;
  config->lambda = setting->lambda;
  config->crop_ratio = setting->crop_ratio;
  config->overlap = setting->overlap;
  config->join = setting->join;
  config->interpolation = setting->interpolation;
  config->output_size = setting->size;
}

/* Cells of noise, different in each component, that jump while they pan. */
static GstBuffer *
noise_frame_new (const GstVideoInfo * info, guint index)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, info->size, NULL);
  const gint shift_x = index * 3 + (index * 5) % 7, shift_y = (index * 3) % 5;
  GstVideoFrame frame;
  guint p;
  gint x, y;

  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_WRITE));
  for (p = 0; p < GST_VIDEO_FRAME_N_PLANES (&frame); p++) {
    const gint step = GST_VIDEO_FRAME_COMP_PSTRIDE (&frame, p);

    for (y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT (&frame, p); y++) {
      guint8 *row = (guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&frame, p)
          + y * GST_VIDEO_FRAME_PLANE_STRIDE (&frame, p);

      for (x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH (&frame, p) * step; x++) {
        const guint32 cell = (x / step + shift_x) / 8 * 73856093u
            ^ (y + shift_y) / 8 * 19349663u ^ (p + x % step) * 83492791u;

        row[x] = cell * 2654435761u >> 24;
      }
    }
  }
  gst_video_frame_unmap (&frame);
  GST_BUFFER_PTS (buffer) = info->fps_n == 0 ? index * FRAME_DURATION :
      gst_util_uint64_scale (index, GST_SECOND * info->fps_d, info->fps_n);
  return buffer;
}

static void
set_planes (L1L2StabFrame * frame, const GstVideoFrame * video)
{
  guint p;

  memset (frame, 0, sizeof (*frame));
  for (p = 0; p < GST_VIDEO_FRAME_N_PLANES (video); p++) {
    frame->data[p] = GST_VIDEO_FRAME_PLANE_DATA (video, p);
    frame->stride[p] = GST_VIDEO_FRAME_PLANE_STRIDE (video, p);
  }
}

static void
assert_same_pixels (const GstVideoFrame * a, const GstVideoFrame * b)
{
  const GstVideoFormat format = GST_VIDEO_FRAME_FORMAT (a);
  const gboolean has_padding = format == GST_VIDEO_FORMAT_BGRx
      || format == GST_VIDEO_FORMAT_RGBx;
  guint p;
  gint x, y;

  for (p = 0; p < GST_VIDEO_FRAME_N_PLANES (a); p++) {
    const gint step = GST_VIDEO_FRAME_COMP_PSTRIDE (a, p);

    for (y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT (a, p); y++) {
      const guint8 *row_a = (const guint8 *) GST_VIDEO_FRAME_PLANE_DATA (a, p)
          + y * GST_VIDEO_FRAME_PLANE_STRIDE (a, p);
      const guint8 *row_b = (const guint8 *) GST_VIDEO_FRAME_PLANE_DATA (b, p)
          + y * GST_VIDEO_FRAME_PLANE_STRIDE (b, p);

      for (x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH (a, p) * step; x++) {
        if (row_a[x] != row_b[x] && !(has_padding && x % 4 == 3))
          fail ("plane %u, byte %d of row %d: %d, the library's is %d", p, x,
              y, row_a[x], row_b[x]);
      }
    }
  }
}

/* Takes the next frame of both. */
static void
compare_next (GstHarness * h, L1L2Stab * stab)
{
  GstCaps *caps = gst_pad_get_current_caps (h->sinkpad);
  GstBuffer *output = gst_harness_try_pull (h);
  GstVideoFrame ours, theirs;
  L1L2StabFrame frame;
  GstVideoInfo info;
  GstBuffer *expected;

  fail_unless (output != NULL);
  fail_unless (gst_video_info_from_caps (&info, caps));
  expected = gst_buffer_new_allocate (NULL, info.size, NULL);
  fail_unless (gst_video_frame_map (&ours, &info, output, GST_MAP_READ));
  fail_unless (gst_video_frame_map (&theirs, &info, expected, GST_MAP_WRITE));
  set_planes (&frame, &theirs);
  fail_unless_equals_int (l1l2stab_pull (stab, &frame, NULL), L1L2STAB_OK);
  assert_same_pixels (&ours, &theirs);
  gst_video_frame_unmap (&ours);
  gst_video_frame_unmap (&theirs);
  gst_buffer_unref (output);
  gst_buffer_unref (expected);
  gst_caps_unref (caps);
}

static void
compare_all (GstHarness * h, L1L2Stab * stab, const GstVideoInfo * info)
{
  GstVideoFrame inputs[N_FRAMES];
  L1L2StabFrame frame;
  guint i;

  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = noise_frame_new (info, i);

    fail_unless (gst_video_frame_map (&inputs[i], info, buffer, GST_MAP_READ));
    set_planes (&frame, &inputs[i]);
    fail_unless_equals_int (l1l2stab_push (stab, &frame), L1L2STAB_OK);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
    if (i >= WINDOW - 1)
      compare_next (h, stab);
  }
  fail_unless_equals_int (l1l2stab_finish (stab), L1L2STAB_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < WINDOW - 1; i++)
    compare_next (h, stab);
  for (i = 0; i < N_FRAMES; i++)
    gst_video_frame_unmap (&inputs[i]);
}

static void
run (const Setting * setting, const gchar * format_name, L1L2StabFormat format)
{
  gchar *caps_text = g_strdup_printf ("video/x-raw, format=%s, width=%d, "
      "height=%d, %s", format_name, WIDTH, HEIGHT, setting->caps);
  gchar *launch = g_strdup_printf ("l1l2stab window=%d %s", WINDOW,
      setting->properties);
  GstCaps *caps = gst_caps_from_string (caps_text);
  GstHarness *h = gst_harness_new_parse (launch);
  L1L2StabConfig config;
  L1L2Stab *stab = NULL;
  GstVideoInfo info;

  init_config (&config, setting, format);
  fail_unless_equals_int (l1l2stab_create (&stab, &config), L1L2STAB_OK);
  fail_unless (gst_video_info_from_caps (&info, caps));
  gst_harness_set_src_caps (h, caps);
  compare_all (h, stab, &info);

  l1l2stab_free (&stab);
  gst_harness_teardown (h);
  g_free (caps_text);
  g_free (launch);
}

GST_START_TEST (every_format_gives_the_librarys_pixels)
{
  run (&settings[2], formats[__i__].name, formats[__i__].format);
}

GST_END_TEST;

GST_START_TEST (every_setting_gives_the_librarys_pixels)
{
  run (&settings[__i__], "I420", L1L2STAB_FORMAT_I420);
}

GST_END_TEST;

static Suite *
pixels_suite (void)
{
  Suite *s = suite_create ("pixels");
  TCase *tc = tcase_create ("pixels");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, every_format_gives_the_librarys_pixels, 0,
      G_N_ELEMENTS (formats));
  tcase_add_loop_test (tc, every_setting_gives_the_librarys_pixels, 0,
      G_N_ELEMENTS (settings));
  return s;
}

GST_CHECK_MAIN (pixels);
