/* SPDX-License-Identifier: MIT */
/* Whole pipelines, with the elements that users combine with l1l2stab. */
#include <glib/gstdio.h>

#include "stabharness.h"

#define N_FRAMES 45
/* If plugins of other packages are missing, all pipelines but the live one are skipped. */
static const gchar *const needed[] = {
  "x264enc", "mp4mux", "qtdemux", "h264parse", "decodebin", "avdec_h264",
  "avenc_aac", "avdec_aac", NULL
};

static gchar *folder;
static gchar *silent_file, *sound_file, *out_file;

/* Builds the pipeline from the format, whose %s are file names, and runs it to its end. */
static void
run (const gchar * format, ...)
G_GNUC_PRINTF (1, 2);

     static void run (const gchar * format, ...)
{
  GError *error = NULL;
  GstElement *pipeline;
  gchar *description;
  va_list args;

  va_start (args, format);
  description = g_strdup_vprintf (format, args);
  va_end (args);
  pipeline = gst_parse_launch (description, &error);
  fail_unless (error == NULL, "%s: %s", description,
      error ? error->message : "");

  stab_play_to_end (pipeline, description);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  g_free (description);
}

static void
make_files (void)
{
  folder = g_dir_make_tmp ("l1l2stab-XXXXXX", NULL);
  silent_file = g_build_filename (folder, "silent.mp4", NULL);
  sound_file = g_build_filename (folder, "sound.mp4", NULL);
  out_file = g_build_filename (folder, "out.mp4", NULL);
  run ("videotestsrc num-buffers=%d pattern=ball ! video/x-raw, format=I420, "
      "width=160, height=120, framerate=30000/1001 ! x264enc ! mp4mux ! "
      "filesink location=%s", N_FRAMES, silent_file);
  run ("videotestsrc num-buffers=%d ! video/x-raw, format=I420, width=160, "
      "height=120, framerate=15/1 ! x264enc ! mp4mux name=mux ! "
      "filesink location=%s audiotestsrc num-buffers=130 ! audioconvert ! "
      "avenc_aac ! mux.", N_FRAMES, sound_file);
}

static void
remove_files (void)
{
  g_remove (silent_file);
  g_remove (sound_file);
  g_remove (out_file);
  g_rmdir (folder);
  g_free (silent_file);
  g_free (sound_file);
  g_free (out_file);
  g_free (folder);
}

static void
note_time (GstElement * sink, GstBuffer * buffer, GstPad * pad,
    gpointer user_data)
{
  const GstClockTime time = GST_BUFFER_PTS (buffer);

  g_array_append_val ((GArray *) user_data, time);
}

/* The timestamps of a file's frames. */
static GArray *
times_of (const gchar * file)
{
  GArray *times = g_array_new (FALSE, FALSE, sizeof (GstClockTime));
  gchar *description = g_strdup_printf ("filesrc location=%s ! qtdemux ! "
      "h264parse ! avdec_h264 ! fakesink name=sink signal-handoffs=true", file);
  GstElement *pipeline = gst_parse_launch (description, NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");

  g_signal_connect (sink, "handoff", G_CALLBACK (note_time), times);
  stab_play_to_end (pipeline, description);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  g_free (description);
  return times;
}

static void
assert_same_times (const gchar * file, const gchar * other)
{
  GArray *a = times_of (file), *b = times_of (other);
  guint i;

  fail_unless_equals_int (a->len, N_FRAMES);
  fail_unless_equals_int (b->len, N_FRAMES);
  for (i = 0; i < a->len; i++)
    fail_unless_equals_uint64 (g_array_index (a, GstClockTime, i),
        g_array_index (b, GstClockTime, i));
  g_array_unref (a);
  g_array_unref (b);
}

static const gchar *settings[] = {
  "lambda=0.5", "window=10", "window=20 join=blend interpolation=bilinear"
};

GST_START_TEST (a_file_keeps_its_frames_and_their_times)
{
  run ("filesrc location=%s ! decodebin ! l1l2stab %s ! x264enc ! mp4mux ! "
      "filesink location=%s", silent_file, settings[__i__], out_file);
  assert_same_times (silent_file, out_file);
}

GST_END_TEST;

GST_START_TEST (a_file_with_audio_plays_to_its_end)
{
  run ("filesrc location=%s ! decodebin name=in "
      "in. ! queue ! l1l2stab window=40 ! x264enc ! queue ! mp4mux name=out ! "
      "filesink location=%s in. ! queue max-size-time=0 max-size-bytes=0 "
      "max-size-buffers=0 ! audioconvert ! avenc_aac ! out.", sound_file,
      out_file);
  assert_same_times (sound_file, out_file);
}

GST_END_TEST;

GST_START_TEST (output_size_crop_can_be_encoded)
{
  run ("filesrc location=%s ! decodebin ! l1l2stab window=10 output-size=crop "
      "! video/x-raw, width=144, height=108 ! x264enc ! mp4mux ! "
      "filesink location=%s", silent_file, out_file);
  assert_same_times (silent_file, out_file);
}

GST_END_TEST;

GST_START_TEST (two_files_in_a_row_are_two_streams)
{
  run ("concat name=c ! l1l2stab window=20 ! fakesink "
      "filesrc location=%s ! decodebin ! c. "
      "filesrc location=%s ! decodebin ! c.", silent_file, silent_file);
}

GST_END_TEST;

GST_START_TEST (a_live_source_runs)
{
  run ("videotestsrc is-live=true num-buffers=20 ! video/x-raw, width=64, "
      "height=48, framerate=60/1 ! l1l2stab window=10 ! fakesink sync=true");
}

GST_END_TEST;

static Suite *
pipelines_suite (void)
{
  Suite *s = suite_create ("pipelines");
  TCase *live = tcase_create ("live");
  TCase *files = tcase_create ("files");

  suite_add_tcase (s, live);
  tcase_add_test (live, a_live_source_runs);

  suite_add_tcase (s, files);
  if (stab_have_elements (needed)) {
    /* Made anew for each test, because each test is a process of its own and threads do not survive a fork. */
    tcase_add_checked_fixture (files, make_files, remove_files);
    tcase_add_loop_test (files, a_file_keeps_its_frames_and_their_times, 0,
        G_N_ELEMENTS (settings));
    tcase_add_test (files, a_file_with_audio_plays_to_its_end);
    tcase_add_test (files, output_size_crop_can_be_encoded);
    tcase_add_test (files, two_files_in_a_row_are_two_streams);
  }
  return s;
}

GST_CHECK_MAIN (pipelines);
