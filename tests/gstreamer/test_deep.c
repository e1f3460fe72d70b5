/* SPDX-License-Identifier: MIT */
/* High dynamic range in 10 bits, from file to file: decoded, stabilized, encoded. */
#include <glib/gstdio.h>

#include "stabharness.h"

#define N_FRAMES 20

/* If plugins of other packages are missing, the test is skipped (exit status 77). */
static const gchar *const needed[] = {
  "x265enc", "h265parse", "avdec_h265", "matroskamux", "matroskademux",
  "capssetter", NULL
};

#define CAPS_10_BIT "video/x-raw, format=I420_10LE, width=160, height=120, " \
    "framerate=25/1"
#define CAPS_HDR CAPS_10_BIT ", colorimetry=bt2100-pq, chroma-site=mpeg2, " \
    "mastering-display-info=(string)35400:14600:8500:39850:6550:2300:15635:" \
    "16450:10000000:50, content-light-level=(string)1000:400"
#define ENCODE "x265enc speed-preset=ultrafast ! h265parse ! matroskamux"
#define DECODE "matroskademux ! h265parse ! avdec_h265"

static GstPadProbeReturn
count_buffer (GstPad * pad, GstPadProbeInfo * info, gpointer user_data)
{
  (*(guint *) user_data)++;
  return GST_PAD_PROBE_OK;
}

/* Runs to the end. Returns the caps that left the element named "look", and the number of frames that did. */
static GstCaps *
run (const gchar * description, guint * n_frames)
{
  GError *error = NULL;
  GstElement *pipeline = gst_parse_launch (description, &error);
  GstElement *look;
  GstCaps *caps;
  GstPad *pad;

  fail_unless (error == NULL, "%s", description);
  *n_frames = 0;
  look = gst_bin_get_by_name (GST_BIN (pipeline), "look");
  pad = gst_element_get_static_pad (look, "src");
  gst_pad_add_probe (pad, GST_PAD_PROBE_TYPE_BUFFER, count_buffer, n_frames,
      NULL);
  stab_play_to_end (pipeline, description);
  caps = gst_pad_get_current_caps (pad);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pad);
  gst_object_unref (look);
  gst_object_unref (pipeline);
  return caps;
}

GST_START_TEST (a_main10_file_is_stabilized_to_a_main10_file)
{
  gchar *folder, *in_file, *out_file, *text;
  GstCaps *in_caps, *caps;
  const GstStructure *s;
  guint n_frames;

  folder = g_dir_make_tmp ("l1l2stab-XXXXXX", NULL);
  in_file = g_build_filename (folder, "in.mkv", NULL);
  out_file = g_build_filename (folder, "out.mkv", NULL);

  text = g_strdup_printf ("videotestsrc num-buffers=%d pattern=ball ! "
      CAPS_10_BIT " ! capssetter replace=true caps=\"" CAPS_HDR "\" ! "
      "identity name=look ! " ENCODE " ! filesink location=%s", N_FRAMES,
      in_file);
  gst_caps_unref (run (text, &n_frames));
  g_free (text);

  text = g_strdup_printf ("filesrc location=%s ! " DECODE " name=look ! "
      "fakesink", in_file);
  in_caps = run (text, &n_frames);
  s = gst_caps_get_structure (in_caps, 0);
  fail_unless_equals_string (gst_structure_get_string (s, "format"),
      "I420_10LE");
  fail_unless (gst_structure_has_field (s, "mastering-display-info"));
  fail_unless (gst_structure_has_field (s, "content-light-level"));
  g_free (text);

  text = g_strdup_printf ("filesrc location=%s ! " DECODE " ! "
      "l1l2stab name=look window=8 ! " ENCODE " ! filesink location=%s",
      in_file, out_file);
  caps = run (text, &n_frames);
  fail_unless_equals_int (n_frames, N_FRAMES);
  fail_unless (gst_caps_is_strictly_equal (caps, in_caps), "%" GST_PTR_FORMAT,
      caps);
  gst_caps_unref (caps);
  g_free (text);

  text = g_strdup_printf ("filesrc location=%s ! " DECODE " name=look ! "
      "fakesink", out_file);
  caps = run (text, &n_frames);
  s = gst_caps_get_structure (caps, 0);
  fail_unless_equals_int (n_frames, N_FRAMES);
  fail_unless_equals_string (gst_structure_get_string (s, "format"),
      "I420_10LE");
  fail_unless_equals_string (gst_structure_get_string (s, "colorimetry"),
      "bt2100-pq");
  fail_unless (gst_structure_has_field (s, "mastering-display-info"));
  gst_caps_unref (caps);
  gst_caps_unref (in_caps);
  g_free (text);

  g_remove (in_file);
  g_remove (out_file);
  g_rmdir (folder);
  g_free (in_file);
  g_free (out_file);
  g_free (folder);
}

GST_END_TEST;

static Suite *
deep_suite (void)
{
  Suite *s = suite_create ("deep");
  TCase *tc = tcase_create ("deep");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, a_main10_file_is_stabilized_to_a_main10_file);
  return s;
}

int
main (int argc, char **argv)
{
  gst_check_init (&argc, &argv);
  if (!stab_have_elements (needed))
    return 77;
  return gst_check_run_suite (deep_suite (), "deep", __FILE__);
}
