/* SPDX-License-Identifier: MIT */
/* A folder for motion files, a clip with a cut, and the element between them. */
#ifndef MOTION_FIXTURE_H
#define MOTION_FIXTURE_H

#include <glib/gstdio.h>

#include "stabnoise.h"

#define WINDOW 6
#define N_FRAMES 30
#define CUT 17                  /* another scene begins */

static gchar *folder;          /* for the files of one test */

static inline void
make_folder (void)
{
  folder = g_dir_make_tmp ("l1l2stab-motion-XXXXXX", NULL);
  fail_unless (folder != NULL);
}

static inline void
remove_folder (void)
{
  static const gchar *names[] = { "a", "b", "in" };
  guint i;

  for (i = 0; i < G_N_ELEMENTS (names); i++) {
    gchar *path = g_build_filename (folder, names[i], NULL);

    g_remove (path);
    g_free (path);
  }
  fail_unless_equals_int (g_rmdir (folder), 0);
  g_free (folder);
}

/* The element in state NULL, with these motion files. */
static inline GstHarness *
harness_new (const gchar * in, const gchar * out)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  gchar *in_path = in ? g_build_filename (folder, in, NULL) : NULL;
  gchar *out_path = out ? g_build_filename (folder, out, NULL) : NULL;

  gst_element_set_state (h->element, GST_STATE_NULL);
  g_object_set (h->element, "motion-in", in_path, "motion-out", out_path,
      "post-messages", TRUE, NULL);
  g_free (in_path);
  g_free (out_path);
  return h;
}

static inline void
play (GstHarness * h)
{
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PLAYING), GST_STATE_CHANGE_SUCCESS);
  gst_harness_set_src_caps_str (h, NOISE_CAPS);
}

static inline gchar *
contents (const gchar * name)
{
  gchar *path = g_build_filename (folder, name, NULL);
  gchar *text = NULL;

  fail_unless (g_file_get_contents (path, &text, NULL, NULL), "%s", path);
  g_free (path);
  return text;
}

static inline void
write_file (const gchar * name, const gchar * text)
{
  gchar *path = g_build_filename (folder, name, NULL);

  fail_unless (g_file_set_contents (path, text, -1, NULL));
  g_free (path);
}

/* Frame `index` of the clip, with the timestamp of frame `timestamp`. */
static inline void
push_frame_at (GstHarness * h, guint index, guint timestamp)
{
  GstBuffer *buffer = stab_noise_new (index < CUT ? index : index + 1000);

  GST_BUFFER_PTS (buffer) = timestamp * FRAME_DURATION;
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
}

static inline void
push_frame (GstHarness * h, guint index)
{
  push_frame_at (h, index, index);
}

static inline void
assert_error_says (GstHarness * h, gint code, const gchar * words)
{
  GstMessage *message = stab_harness_message (h, GST_MESSAGE_ERROR);
  GError *error = NULL;

  fail_unless (message != NULL, "no error was posted");
  gst_message_parse_error (message, &error, NULL);
  fail_unless (g_error_matches (error, GST_RESOURCE_ERROR, code));
  fail_unless (strstr (error->message, words) != NULL,
      "\"%s\" does not say \"%s\"", error->message, words);
  g_clear_error (&error);
  gst_message_unref (message);
}

#endif
