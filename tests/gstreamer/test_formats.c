/* SPDX-License-Identifier: MIT */
/* The planes of every format, compared with a warp in floating point that takes the layout of each format from
 * GStreamer. It uses the maps that the library reports of the same frames. */
#include <math.h>

#include <l1l2stab/l1l2stab.h>

#include "stabharness.h"

#define WINDOW 4
#define N_FRAMES 5              /* the last frame but one is compared */
#define TILE 256
#define MAX_SAMPLES 8000       /* of a component that are compared */

static const struct
{
  const gchar *name;
  L1L2StabFormat format;
  gboolean big;                 /* also at 1080p: one of each layout and depth */
} formats[] = {
#define SMALL(name) {#name, L1L2STAB_FORMAT_##name, FALSE}
#define BIG(name) {#name, L1L2STAB_FORMAT_##name, TRUE}
  BIG (GRAY8), BIG (I420), SMALL (YV12), BIG (NV12), SMALL (NV21), BIG (Y42B),
  BIG (Y444), {"BGRx", L1L2STAB_FORMAT_BGRX, FALSE},
  {"RGBx", L1L2STAB_FORMAT_RGBX, FALSE}, SMALL (BGRA), BIG (RGBA), BIG (BGR),
  SMALL (RGB), BIG (A420), SMALL (AV12), BIG (NV16), SMALL (NV61), SMALL (NV24),
  BIG (Y41B), {"xRGB", L1L2STAB_FORMAT_XRGB, FALSE},
  {"xBGR", L1L2STAB_FORMAT_XBGR, FALSE}, SMALL (ARGB), SMALL (ABGR),
  SMALL (AYUV), SMALL (VUYA), SMALL (GBR), SMALL (GBRA), BIG (YUY2),
  BIG (UYVY), SMALL (YVYU), SMALL (VYUY), BIG (GRAY16_LE), BIG (I420_10LE),
  SMALL (I420_12LE), BIG (I422_10LE), BIG (I422_12LE), SMALL (Y444_10LE),
  SMALL (Y444_12LE), SMALL (Y444_16LE), SMALL (A420_10LE), SMALL (A422_10LE),
  SMALL (A444_10LE), SMALL (GBR_10LE), SMALL (GBR_12LE), SMALL (GBRA_10LE),
  SMALL (GBRA_12LE), BIG (P010_10LE), SMALL (P012_LE), BIG (P016_LE),
  BIG (ARGB64_LE), SMALL (RGBA64_LE), SMALL (BGRA64_LE), SMALL (ABGR64_LE),
  SMALL (AYUV64)
};

static const struct
{
  const gchar *caps;
  L1L2StabChromaSite site;
  gboolean left, top;           /* chroma is on the left column, the top row */
} sites[] = {
  {"mpeg2", L1L2STAB_CHROMA_SITE_LEFT, TRUE, FALSE},
  {"jpeg", L1L2STAB_CHROMA_SITE_CENTER, FALSE, FALSE},
  {"cosited", L1L2STAB_CHROMA_SITE_TOP_LEFT, TRUE, TRUE},
};

static guint
level_at (const GstVideoFrame * frame, guint c, gint x, gint y)
{
  const guint8 *at = stab_frame_component (frame, c, x, y);

  if (GST_VIDEO_FRAME_COMP_DEPTH (frame, c) == 8)
    return at[0];
  return GST_READ_UINT16_LE (at)
      >> GST_VIDEO_FORMAT_INFO_SHIFT (frame->info.finfo, c);
}

static gint
max_level (const GstVideoFrame * frame, guint c)
{
  return (1 << GST_VIDEO_FRAME_COMP_DEPTH (frame, c)) - 1;
}

/* Smooth noise, 0 .. 1, that repeats. */
static void
fill_tile (gfloat tile[TILE][TILE], guint32 seed)
{
  GRand *rand = g_rand_new_with_seed (seed);
  gfloat node[TILE / 8][TILE / 8];
  gint x, y;

  for (y = 0; y < TILE / 8; y++)
    for (x = 0; x < TILE / 8; x++)
      node[y][x] = g_rand_double (rand);
  for (y = 0; y < TILE; y++) {
    for (x = 0; x < TILE; x++) {
      const gfloat a = (x % 8) / 8.0f, b = (y % 8) / 8.0f;
      const gint x0 = x / 8, x1 = (x / 8 + 1) % (TILE / 8);
      const gint y0 = y / 8, y1 = (y / 8 + 1) % (TILE / 8);

      tile[y][x] = (1 - b) * ((1 - a) * node[y0][x0] + a * node[y0][x1])
          + b * ((1 - a) * node[y1][x0] + a * node[y1][x1]);
    }
  }
  g_rand_free (rand);
}

static void
draw_component (GstVideoFrame * frame, guint c, guint index)
{
  static gfloat tiles[GST_VIDEO_MAX_COMPONENTS][TILE][TILE];
  gfloat (*tile)[TILE] = tiles[c];
  const gdouble angle = 0.02 * sin (1.7 * index);
  const gdouble left = 3000 + 5 * sin (2.1 * index);
  const gdouble top = 3000 + 4 * cos (1.3 * index);
  const gint max = max_level (frame, c);
  const gint shift = GST_VIDEO_FORMAT_INFO_SHIFT (frame->info.finfo, c);
  gint x, y;

  if (index == 0)
    fill_tile (tile, c);
  for (y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT (frame, c); y++) {
    for (x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH (frame, c); x++) {
      const gint u = left + cos (angle) * x - sin (angle) * y;
      const gint v = top + sin (angle) * x + cos (angle) * y;
      const guint level = lrintf (tile[v % TILE][u % TILE] * max);
      guint8 *at = stab_frame_component (frame, c, x, y);

      if (max > 255)
        GST_WRITE_UINT16_LE (at, level << shift);
      else
        *at = level;
    }
  }
}

/* A frame with padded rows and separate planes, described by a video meta. */
static GstBuffer *
frame_new (const GstVideoInfo * info, guint index)
{
  gsize offset[GST_VIDEO_MAX_PLANES] = { 0, };
  gint stride[GST_VIDEO_MAX_PLANES] = { 0, };
  gsize size = 32;
  GstVideoFrame frame;
  GstBuffer *buffer;
  guint i;

  for (i = 0; i < GST_VIDEO_INFO_N_PLANES (info); i++) {
    offset[i] = size;
    stride[i] = GST_VIDEO_INFO_PLANE_STRIDE (info, i) + 20;
    size += stride[i] * GST_VIDEO_INFO_HEIGHT (info) + 48;
  }
  buffer = gst_buffer_new_allocate (NULL, size, NULL);
  gst_buffer_memset (buffer, 0, 0xff, size);
  gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_INFO_FORMAT (info), GST_VIDEO_INFO_WIDTH (info),
      GST_VIDEO_INFO_HEIGHT (info), GST_VIDEO_INFO_N_PLANES (info), offset,
      stride);
  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_WRITE));
  for (i = 0; i < GST_VIDEO_FRAME_N_COMPONENTS (&frame); i++)
    draw_component (&frame, i, index);
  gst_video_frame_unmap (&frame);
  GST_BUFFER_PTS (buffer) = index * FRAME_DURATION;
  return buffer;
}

/* The map of the frame that is compared, from output pixels to source pixels. */
static void
ask_the_library (const GstVideoInfo * info, L1L2StabFormat format,
    L1L2StabChromaSite site, GstBuffer * frames[N_FRAMES], gdouble map[9])
{
  GstVideoFrame inputs[N_FRAMES];
  L1L2StabConfig config;
  L1L2Stab *stab = NULL;
  L1L2StabInfo reported;
  guint i, p;

  l1l2stab_config_init (&config, sizeof (config));
  config.format = format;
  config.width = GST_VIDEO_INFO_WIDTH (info);
  config.height = GST_VIDEO_INFO_HEIGHT (info);
  config.window = WINDOW;
  config.frame_rate = 25;
  config.chroma_site = site;
  fail_unless_equals_int (l1l2stab_create (&stab, &config), L1L2STAB_OK);
  for (i = 0; i < N_FRAMES; i++) {
    L1L2StabFrame frame;

    memset (&frame, 0, sizeof (frame));
    if (i >= WINDOW)
      fail_unless_equals_int (l1l2stab_pull (stab, NULL, &reported), L1L2STAB_OK);
    fail_unless (gst_video_frame_map (&inputs[i], info, frames[i],
            GST_MAP_READ));
    for (p = 0; p < GST_VIDEO_FRAME_N_PLANES (&inputs[i]); p++) {
      frame.data[p] = GST_VIDEO_FRAME_PLANE_DATA (&inputs[i], p);
      frame.stride[p] = GST_VIDEO_FRAME_PLANE_STRIDE (&inputs[i], p);
    }
    fail_unless_equals_int (l1l2stab_push (stab, &frame), L1L2STAB_OK);
  }
  fail_unless_equals_int (l1l2stab_finish (stab), L1L2STAB_OK);
  for (i = N_FRAMES - WINDOW; i < N_FRAMES - 1; i++)
    fail_unless_equals_int (l1l2stab_pull (stab, NULL, &reported), L1L2STAB_OK);
  memcpy (map, reported.warp, sizeof (reported.warp));
  l1l2stab_free (&stab);
  for (i = 0; i < N_FRAMES; i++)
    gst_video_frame_unmap (&inputs[i]);
}

/* Keys's cubic with a = -0.75. */
static gdouble
weigh (gdouble x)
{
  const gdouble t = fabs (x), a = -0.75;

  if (t >= 2)
    return 0;
  return t < 1 ? (a + 2) * t * t * t - (a + 3) * t * t + 1
      : a * t * t * t - 5 * a * t * t + 8 * a * t - 4 * a;
}

/* A component interpolated between its samples. Outside the frame its edge is repeated. */
static gdouble
interpolate (const GstVideoFrame * frame, guint c, gdouble x, gdouble y)
{
  const gint width = GST_VIDEO_FRAME_COMP_WIDTH (frame, c);
  const gint height = GST_VIDEO_FRAME_COMP_HEIGHT (frame, c);
  const gint left = floor (x) - 1, top = floor (y) - 1;
  gdouble sum = 0;
  gint i, j;

  for (j = 0; j < 4; j++) {
    for (i = 0; i < 4; i++)
      sum += weigh (left + i - x) * weigh (top + j - y)
          * level_at (frame, c, CLAMP (left + i, 0, width - 1),
          CLAMP (top + j, 0, height - 1));
  }
  return CLAMP (sum, 0, max_level (frame, c));
}

/* The positions of a component's samples in the frame, along one axis. */
typedef struct
{
  gdouble first, step;          /* pixels */
} Axis;

static Axis
axis_of (gint log2_sub, gboolean cosited)
{
  Axis axis = { 0.5, 1 << log2_sub };

  if (!cosited)
    axis.first *= axis.step;
  return axis;
}

/* Component c of `in`, warped, near sample (u, v) of the output. */
static gdouble
reference (const GstVideoFrame * in, guint c, guint site, const gdouble map[9],
    gdouble u, gdouble v)
{
  const GstVideoFormatInfo *format = in->info.finfo;
  const Axis ax = axis_of (GST_VIDEO_FORMAT_INFO_W_SUB (format, c),
      sites[site].left);
  const Axis ay = axis_of (GST_VIDEO_FORMAT_INFO_H_SUB (format, c),
      sites[site].top);
  const gdouble half_width = GST_VIDEO_FRAME_WIDTH (in) / 2.0;
  const gdouble half_height = GST_VIDEO_FRAME_HEIGHT (in) / 2.0;
  const gdouble x = ax.first + ax.step * u - half_width;
  const gdouble y = ay.first + ay.step * v - half_height;

  return interpolate (in, c,
      (map[0] * x + map[1] * y + map[2] + half_width - ax.first) / ax.step,
      (map[3] * x + map[4] * y + map[5] + half_height - ay.first) / ay.step);
}

/* The power of the error, and the displacement (samples) that explains it best by least squares. */
static void
compare_component (const GstVideoFrame * in, const GstVideoFrame * out, guint c,
    guint site, const gdouble map[9])
{
  const gint width = GST_VIDEO_FRAME_COMP_WIDTH (out, c);
  const gint height = GST_VIDEO_FRAME_COMP_HEIGHT (out, c);
  const gint step = 1 + (gint) sqrt (width * height / MAX_SAMPLES);
  const gdouble max = max_level (out, c), h = 0.05;
  gdouble squares = 0, xx = 0, xy = 0, yy = 0, ex = 0, ey = 0, n = 0, psnr, d;
  gint u, v;

  for (v = 0; v < height; v += step) {
    for (u = 0; u < width; u += step, n++) {
      const gint got = level_at (out, c, u, v);
      const gdouble error = got - reference (in, c, site, map, u, v);
      const gdouble gx = (reference (in, c, site, map, u + h, v)
          - reference (in, c, site, map, u - h, v)) / (2 * h);
      const gdouble gy = (reference (in, c, site, map, u, v + h)
          - reference (in, c, site, map, u, v - h)) / (2 * h);

      fail_unless (got <= max);
      squares += error * error;
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
      ex += error * gx;
      ey += error * gy;
    }
  }
  psnr = 10 * log10 (max * max * n / squares);
  d = hypot (ex * yy - ey * xy, ey * xx - ex * xy) / (xx * yy - xy * xy);
  GST_INFO ("%s component %u: PSNR %.1f dB, displaced by %.4f samples",
      out->info.finfo->name, c, psnr, d);
  fail_unless (psnr >= 55, "%s %dx%d component %u: %f dB",
      out->info.finfo->name, width, height, c, psnr);
  fail_unless (d <= 0.005, "%s %dx%d component %u: displaced by %f samples",
      out->info.finfo->name, width, height, c, d);
}

static void
compare_format (guint f, guint site, gint width, gint height)
{
  gchar *text = g_strdup_printf ("video/x-raw, format=%s, width=%d, height=%d, "
      "framerate=25/1, chroma-site=%s", formats[f].name, width, height,
      sites[site].caps);
  GstHarness *h = stab_harness_new (text, "window", WINDOW, NULL);
  GstCaps *caps = gst_caps_from_string (text);
  GstBuffer *frames[N_FRAMES], *output = NULL;
  GstVideoFrame in, out;
  GstVideoInfo info;
  gdouble map[9];
  guint c, i;

  fail_unless (gst_video_info_from_caps (&info, caps));
  for (i = 0; i < N_FRAMES; i++)
    frames[i] = frame_new (&info, i);
  ask_the_library (&info, formats[f].format, sites[site].site, frames, map);
  fail_unless (map[0] > 0.85 && map[0] < 0.95 && map[1] != 0, "map: %f %f",
      map[0], map[1]);
  for (i = 0; i < N_FRAMES; i++)
    gst_harness_push (h, gst_buffer_ref (frames[i]));
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < N_FRAMES - 1; i++) {
    gst_clear_buffer (&output);
    output = gst_harness_try_pull (h);
    fail_unless (output != NULL);
  }

  fail_unless (gst_video_frame_map (&in, &info, frames[N_FRAMES - 2],
          GST_MAP_READ));
  fail_unless (gst_video_frame_map (&out, &info, output, GST_MAP_READ));
  for (c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS (&out); c++)
    compare_component (&in, &out, c, site, map);
  gst_video_frame_unmap (&in);
  gst_video_frame_unmap (&out);
  for (i = 0; i < N_FRAMES; i++)
    gst_buffer_unref (frames[i]);
  gst_buffer_unref (output);
  gst_caps_unref (caps);
  stab_harness_free (h);
  g_free (text);
}

GST_START_TEST (every_format_follows_a_floating_point_warp)
{
  compare_format (__i__, __i__ % G_N_ELEMENTS (sites), 160, 120);
}

GST_END_TEST;

GST_START_TEST (odd_sizes_follow_a_floating_point_warp)
{
  compare_format (__i__, (__i__ + 1) % G_N_ELEMENTS (sites), 161, 121);
}

GST_END_TEST;

GST_START_TEST (full_hd_follows_a_floating_point_warp)
{
  if (formats[__i__].big)
    compare_format (__i__, 0, 1920, 1080);
}

GST_END_TEST;

static Suite *
formats_suite (void)
{
  Suite *s = suite_create ("formats");
  TCase *tc = tcase_create ("formats");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, every_format_follows_a_floating_point_warp, 0,
      G_N_ELEMENTS (formats));
  tcase_add_loop_test (tc, odd_sizes_follow_a_floating_point_warp, 0,
      G_N_ELEMENTS (formats));
  tcase_add_loop_test (tc, full_hd_follows_a_floating_point_warp, 0,
      G_N_ELEMENTS (formats));
  return s;
}

GST_CHECK_MAIN (formats);
