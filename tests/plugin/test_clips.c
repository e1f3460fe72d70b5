/* SPDX-License-Identifier: MIT */
/*
 * Real video: every clip of a folder through the README's pipeline. CLIPS_DIR
 * names the folder, by default shared/clips beside the checkout; where there
 * is none the test is skipped (exit status 77).
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
} Frames;

static void
take_frame (GstElement * sink, GstBuffer * buffer, GstPad * pad,
    Frames * frames)
{
  GstCaps *caps = gst_pad_get_current_caps (pad);
  const GstStructure *s = gst_caps_get_structure (caps, 0);

  gst_structure_get_int (s, "width", &frames->width);
  gst_structure_get_int (s, "height", &frames->height);
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

static Frames
frames_of (const gchar * path)
{
  Frames frames = { g_array_new (FALSE, FALSE, sizeof (GstClockTime)), 0, 0 };
  GstElement *pipeline =
      gst_parse_launch ("filesrc name=src ! decodebin ! video/x-raw ! "
      "fakesink name=sink signal-handoffs=true", NULL);
  GstElement *src = gst_bin_get_by_name (GST_BIN (pipeline), "src");
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");

  g_object_set (src, "location", path, NULL);
  g_signal_connect (sink, "handoff", G_CALLBACK (take_frame), &frames);
  run_to_end (pipeline, path);
  gst_object_unref (src);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  return frames;
}

GST_START_TEST (the_readmes_pipeline_keeps_every_frame_size_and_timestamp)
{
  const gchar *in = g_ptr_array_index (clips, __i__);
  gchar *dir = g_dir_make_tmp ("l1l2stab-clips-XXXXXX", NULL);
  gchar *out = g_build_filename (dir, "out.mp4", NULL);
  GstElement *pipeline =
      gst_parse_launch ("filesrc name=src ! decodebin ! l1l2stab lambda=0.5 ! "
      "x264enc ! mp4mux ! filesink name=sink", NULL);
  GstElement *src = gst_bin_get_by_name (GST_BIN (pipeline), "src");
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  Frames before, after;

  g_object_set (src, "location", in, NULL);
  g_object_set (sink, "location", out, NULL);
  run_to_end (pipeline, in);
  gst_object_unref (src);
  gst_object_unref (sink);
  gst_object_unref (pipeline);

  before = frames_of (in);
  after = frames_of (out);
  fail_unless (before.pts->len > 0, "%s: no frames", in);
  fail_unless_equals_int (after.pts->len, before.pts->len);
  fail_unless_equals_int (after.width, before.width);
  fail_unless_equals_int (after.height, before.height);
  for (guint i = 0; i < before.pts->len; i++) {
    /* From the first frame on: containers start where they like, and
     * count in ticks of a millisecond or less. */
    const GstClockTimeDiff a = g_array_index (before.pts, GstClockTime, i) -
        g_array_index (before.pts, GstClockTime, 0);
    const GstClockTimeDiff b = g_array_index (after.pts, GstClockTime, i) -
        g_array_index (after.pts, GstClockTime, 0);
    fail_unless (ABS (a - b) <= GST_MSECOND,
        "%s, frame %u: %" G_GINT64_FORMAT " ns in, %" G_GINT64_FORMAT " ns out",
        in, i, a, b);
  }
  g_array_unref (before.pts);
  g_array_unref (after.pts);
  g_remove (out);
  g_rmdir (dir);
  g_free (out);
  g_free (dir);
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
  for (gint k = 0; k < 4; k++) {        /* an affine map: four corners decide for all pixels */
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
  L1L2StabConfig cfg;
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
      GstVideoFrame *mapped = g_new0 (GstVideoFrame, 1);
      L1L2StabFrame frame = {.pts = 0};

      gst_video_info_from_caps (&video, gst_sample_get_caps (sample));
      fail_unless (gst_video_frame_map (mapped, &video,
              gst_sample_get_buffer (sample), GST_MAP_READ));
      gst_sample_unref (sample);
      if (!s) {
        l1l2stab_config_init (&cfg, sizeof cfg);
        cfg.format = L1L2STAB_FORMAT_GRAY8;
        cfg.width = video.width;
        cfg.height = video.height;
        cfg.frame_rate = (gdouble) video.fps_n / video.fps_d;
        fail_unless_equals_int (l1l2stab_create (&s, &cfg), L1L2STAB_OK);
      }
      frame.data[0] = GST_VIDEO_FRAME_PLANE_DATA (mapped, 0);
      frame.stride[0] = GST_VIDEO_FRAME_PLANE_STRIDE (mapped, 0);
      frame.opaque = mapped;
      frame.release = unmap_frame;
      fail_unless_equals_int (l1l2stab_push (s, &frame), L1L2STAB_OK);
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
  tcase_add_loop_test (tcase,
      the_readmes_pipeline_keeps_every_frame_size_and_timestamp, 0, clips->len);
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
  g_ptr_array_sort (clips, compare_names);
}

int
main (int argc, char **argv)
{
  const gchar *folder = g_getenv ("CLIPS_DIR");
  gint failed;

  gst_check_init (&argc, &argv);
  clips = g_ptr_array_new_with_free_func (g_free);
  find_clips (folder);
  if (clips->len == 0) {
    g_print ("skipped: no clips in %s\n", folder);
    return 77;
  }
  failed = gst_check_run_suite (clips_suite (), "clips", __FILE__);
  g_ptr_array_unref (clips);
  return failed;
}
