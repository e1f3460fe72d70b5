/* SPDX-License-Identifier: MIT */
/*
 * Real video: every clip of some folders through the README's pipeline.
 * CLIPS_DIR names the folders, separated by colons, by default shared/clips
 * and shared/clips-hard beside the checkout; where there is none the test is
 * skipped (exit status 77).
 */
#include <gst/app/gstappsink.h>
#include <gst/check/gstcheck.h>
#include <gst/video/video.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include <l1l2stab/l1l2stab.h>

static GPtrArray *clips; /* paths */

typedef struct
{
  GArray *pts;
  gint width, height;
  gint fps_n, fps_d;
} Frames;

static void
take_frame (GstElement * sink, GstBuffer * buffer, GstPad * pad,
    Frames * frames)
{
  GstCaps *caps = gst_pad_get_current_caps (pad);
  const GstStructure *s = gst_caps_get_structure (caps, 0);

  gst_structure_get_int (s, "width", &frames->width);
  gst_structure_get_int (s, "height", &frames->height);
  gst_structure_get_fraction (s, "framerate", &frames->fps_n, &frames->fps_d);
  g_array_append_val (frames->pts, GST_BUFFER_PTS (buffer));
  gst_caps_unref (caps);
}

static void
run_to_end (GstElement * pipeline, const gchar * what)
{
  GstBus *bus = gst_element_get_bus (pipeline);
  GstMessage *message;

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, 300 * GST_SECOND,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless (message != NULL, "%s: no end within five minutes", what);
  if (GST_MESSAGE_TYPE (message) == GST_MESSAGE_ERROR) {
    GError *error = NULL;
    gst_message_parse_error (message, &error, NULL);
    fail ("%s: %s", what, error->message);
  }
  gst_message_unref (message);
  gst_object_unref (bus);
  gst_element_set_state (pipeline, GST_STATE_NULL);
}

/* The frames that a fakesink at the end of the pipeline gets. */
static Frames
frames_at_the_end (const gchar * path, const gchar * elements)
{
  Frames frames = { g_array_new (FALSE, FALSE, sizeof (GstClockTime)), 0, 0,
    0, 1
  };
  gchar *launch = g_strdup_printf ("filesrc name=src ! decodebin ! %s ! "
      "fakesink name=sink signal-handoffs=true", elements);
  GstElement *pipeline = gst_parse_launch (launch, NULL);
  GstElement *src = gst_bin_get_by_name (GST_BIN (pipeline), "src");
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");

  g_object_set (src, "location", path, NULL);
  g_signal_connect (sink, "handoff", G_CALLBACK (take_frame), &frames);
  run_to_end (pipeline, path);
  gst_object_unref (src);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  g_free (launch);
  return frames;
}

/* The frames that a player gets from the file that the pipeline writes: they are muxed, and decoded again. */
static Frames
frames_of_file (const gchar * path, const gchar * elements)
{
  gchar *dir = g_dir_make_tmp ("l1l2stab-clips-XXXXXX", NULL);
  gchar *out = g_build_filename (dir, "out.mp4", NULL);
  gchar *launch = g_strdup_printf ("filesrc name=src ! decodebin ! %s ! "
      "mp4mux ! filesink name=sink", elements);
  GstElement *pipeline = gst_parse_launch (launch, NULL);
  GstElement *src = gst_bin_get_by_name (GST_BIN (pipeline), "src");
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  Frames frames;

  g_object_set (src, "location", path, NULL);
  g_object_set (sink, "location", out, NULL);
  run_to_end (pipeline, path);
  gst_object_unref (src);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  g_free (launch);
  frames = frames_at_the_end (out, "video/x-raw");
  g_remove (out);
  g_rmdir (dir);
  g_free (out);
  g_free (dir);
  return frames;
}

static void
assert_same (const gchar * what, Frames * before, Frames * after)
{
  fail_unless (before->pts->len > 0, "%s: no frames", what);
  fail_unless_equals_int (after->pts->len, before->pts->len);
  fail_unless_equals_int (after->width, before->width);
  fail_unless_equals_int (after->height, before->height);
  for (guint i = 0; i < before->pts->len; i++)
    fail_unless_equals_clocktime (g_array_index (after->pts, GstClockTime, i),
        g_array_index (before->pts, GstClockTime, i));
  g_array_unref (before->pts);
  g_array_unref (after->pts);
}

GST_START_TEST (every_frame_comes_out_with_its_timestamp)
{
  const gchar *in = g_ptr_array_index (clips, __i__);
  Frames before = frames_at_the_end (in, "video/x-raw");
  Frames after = frames_at_the_end (in, "l1l2stab lambda=0.5");

  assert_same (in, &before, &after);
}

GST_END_TEST;

/* What gives a clip the frame rate that the element gives it: a clock's rate becomes a variable one. */
static const gchar *
rate_setter (const gchar * path)
{
  Frames frames = frames_at_the_end (path, "video/x-raw");
  const gboolean is_clock =
      gst_util_fraction_compare (frames.fps_n, frames.fps_d, 1000, 1) > 0;

  g_array_unref (frames.pts);
  return is_clock ? "capssetter caps=video/x-raw,framerate=0/1 ! " : "";
}

/* Compares with the same file made without the element, from the same caps, because encoder and muxer themselves lose
 * some frames of unusual clips, and round times. */
GST_START_TEST (the_readmes_pipeline_makes_a_file_that_plays_like_its_input)
{
  const gchar *in = g_ptr_array_index (clips, __i__);
  gchar *reference = g_strconcat (rate_setter (in),
      "x264enc speed-preset=ultrafast", NULL);
  Frames before = frames_of_file (in, reference);
  Frames after = frames_of_file (in, "l1l2stab lambda=0.5 ! x264enc speed-preset=ultrafast");

  g_free (reference);
  assert_same (in, &before, &after);
}

GST_END_TEST;

/* Sum of squares of the second difference of the corner path, from inter-frame maps. */
typedef struct
{
  gdouble last[8], sum;
  guint steps;
} Jitter;

static void
add_step (Jitter * jitter, const gdouble m[9], gdouble half_w, gdouble half_h)
{
  for (gint k = 0; k < 4; k++) {
    const gdouble x = k & 1 ? half_w : -half_w, y = k & 2 ? half_h : -half_h;
    const gdouble v[2] = { m[0] * x + m[1] * y + m[2] - x,
      m[3] * x + m[4] * y + m[5] - y
    };
    for (gint a = 0; a < 2; a++) {
      const gdouble d = v[a] - jitter->last[2 * k + a];
      if (jitter->steps > 0)
        jitter->sum += d * d;
      jitter->last[2 * k + a] = v[a];
    }
  }
  jitter->steps++;
}

static void
check_info (const L1L2StabInfo * info, gdouble half_w, gdouble half_h,
    Jitter jitter[2])
{
  for (gint k = 0; k < 4; k++) {        /* the map is affine: if the four corners are inside, all pixels are */
    const gdouble x = k & 1 ? half_w : -half_w, y = k & 2 ? half_h : -half_h;
    const gdouble *m = info->warp;
    fail_unless (fabs (m[0] * x + m[1] * y + m[2]) <= half_w + 1e-9);
    fail_unless (fabs (m[3] * x + m[4] * y + m[5]) <= half_h + 1e-9);
  }
  if (info->path_index == 0)
    return;
  add_step (&jitter[0], info->F, half_w, half_h);
  add_step (&jitter[1], info->S, half_w, half_h);
}

static void
unmap_frame (gpointer frame)
{
  gst_video_frame_unmap (frame);
  g_free (frame);
}

static L1L2Stab *
stabilizer_for (const GstVideoInfo * video)
{
  L1L2StabConfig cfg;
  L1L2Stab *s;

  l1l2stab_config_init (&cfg, sizeof cfg);
  cfg.format = L1L2STAB_FORMAT_GRAY8;
  cfg.width = video->width;
  cfg.height = video->height;
  /* Some files give the rate of their clock, 90000, as the frame rate. */
  cfg.frame_rate = (gdouble) video->fps_n / video->fps_d;
  if (cfg.frame_rate > 1000.0)
    cfg.frame_rate = 0.0;
  fail_unless_equals_int (l1l2stab_create (&s, &cfg), L1L2STAB_OK);
  return s;
}

static void
push_sample (L1L2Stab * s, const GstVideoInfo * video, GstSample * sample)
{
  GstVideoFrame *mapped = g_new0 (GstVideoFrame, 1);
  L1L2StabFrame frame = {.opaque = mapped,.release = unmap_frame };

  fail_unless (gst_video_frame_map (mapped, video,
          gst_sample_get_buffer (sample), GST_MAP_READ));
  frame.data[0] = GST_VIDEO_FRAME_PLANE_DATA (mapped, 0);
  frame.stride[0] = GST_VIDEO_FRAME_PLANE_STRIDE (mapped, 0);
  fail_unless_equals_int (l1l2stab_push (s, &frame), L1L2STAB_OK);
}

GST_START_TEST (no_clip_gets_shakier_and_no_pixel_is_from_outside)
{
  const gchar *in = g_ptr_array_index (clips, __i__);
  GstElement *pipeline =
      gst_parse_launch ("filesrc name=src ! decodebin ! videoconvert ! "
      "video/x-raw,format=GRAY8 ! appsink name=sink sync=false", NULL);
  GstElement *src = gst_bin_get_by_name (GST_BIN (pipeline), "src");
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  GstSample *sample;
  GstVideoInfo video;
  L1L2Stab *s = NULL;
  L1L2StabInfo info;
  L1L2StabResult result = L1L2STAB_OK;
  Jitter jitter[2] = { {{0}, 0.0, 0}, {{0}, 0.0, 0} };
  gdouble before, after;

  g_object_set (src, "location", in, NULL);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  do {
    sample = gst_app_sink_pull_sample (GST_APP_SINK (sink));
    if (sample) {
      gst_video_info_from_caps (&video, gst_sample_get_caps (sample));
      s = s ? s : stabilizer_for (&video);
      push_sample (s, &video, sample);
      gst_sample_unref (sample);
    } else {
      fail_unless (s != NULL, "%s: no frames", in);
      l1l2stab_finish (s);
    }
    while ((result = l1l2stab_pull (s, NULL, &info)) == L1L2STAB_OK)
      check_info (&info, video.width / 2.0, video.height / 2.0, jitter);
  } while (result == L1L2STAB_AGAIN);
  fail_unless_equals_int (result, L1L2STAB_EOS);

  before = sqrt (jitter[0].sum / jitter[0].steps);
  after = sqrt (jitter[1].sum / jitter[1].steps);
  g_print ("%-28s shake %6.2f px before, %5.2f px after\n",
      strrchr (in, '/') + 1, before, after);
  fail_unless (after <= before, "%s: %g px before, %g px after", in, before,
      after);
  l1l2stab_free (&s);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (src);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

static Suite *
clips_suite (void)
{
  Suite *suite = suite_create ("clips");
  TCase *tcase = tcase_create ("clips");

  tcase_set_timeout (tcase, 600);
  tcase_add_loop_test (tcase, every_frame_comes_out_with_its_timestamp, 0,
      clips->len);
  tcase_add_loop_test (tcase,
      the_readmes_pipeline_makes_a_file_that_plays_like_its_input, 0,
      clips->len);
  tcase_add_loop_test (tcase, no_clip_gets_shakier_and_no_pixel_is_from_outside,
      0, clips->len);
  suite_add_tcase (suite, tcase);
  return suite;
}

static gint
compare_names (gconstpointer a, gconstpointer b)
{
  return strcmp (*(gchar * const *) a, *(gchar * const *) b);
}

static void
find_clips (const gchar * folder)
{
  GDir *dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir)))
    if (!g_str_has_suffix (name, ".tsv"))
      g_ptr_array_add (clips, g_build_filename (folder, name, NULL));
  if (dir)
    g_dir_close (dir);
}

int
main (int argc, char **argv)
{
  gchar **folders = g_strsplit (g_getenv ("CLIPS_DIR"), ":", -1);
  gint failed, i;

  gst_check_init (&argc, &argv);
  clips = g_ptr_array_new_with_free_func (g_free);
  for (i = 0; folders[i]; i++)
    find_clips (folders[i]);
  g_strfreev (folders);
  g_ptr_array_sort (clips, compare_names);
  if (clips->len == 0) {
    g_print ("skipped: no clips in %s\n", g_getenv ("CLIPS_DIR"));
    return 77;
  }
  failed = gst_check_run_suite (clips_suite (), "clips", __FILE__);
  g_ptr_array_unref (clips);
  return failed;
}
