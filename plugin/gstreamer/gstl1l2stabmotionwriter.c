/* SPDX-License-Identifier: MIT */
/* Writes a motion file, one line for each frame that goes out. */
#include "gstl1l2stabmotionfiles.h"

#include <errno.h>
#include <glib/gstdio.h>

#include "gstl1l2stabreport.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug
GST_DEBUG_CATEGORY_EXTERN (gst_l1l2_stab_debug);

struct _GstL1L2StabMotionWriter
{
  GstElement *element;          /* not owned */
  gchar *name;
  FILE *file;                   /* NULL: an error was posted */
  GstVideoInfo info;            /* of the frames in the file */
  gboolean has_header;
  gboolean has_ended;           /* frames of another size came: nothing more is written */
  gboolean is_timed;            /* the first frame had a stream time, so every line has one */
  GstClockTime written;         /* stream time of the last line */
  GstClockTime previous;        /* stream time of the last frame, written or not */
};

static gboolean
fail (GstL1L2StabMotionWriter * writer)
{
  const gint error = errno;

  GST_ELEMENT_ERROR (writer->element, RESOURCE, WRITE,
      ("motion-out: %s cannot be written: %s", writer->name, g_strerror (error)),
      (NULL));
  if (writer->file)
    fclose (writer->file);
  writer->file = NULL;
  return FALSE;
}

GstL1L2StabMotionWriter *
gst_l1l2_stab_motion_writer_open (GstElement * element, const gchar * name)
{
  FILE *file = g_fopen (name, "w");
  GstL1L2StabMotionWriter *writer;

  if (!file) {
    const gint error = errno;

    GST_ELEMENT_ERROR (element, RESOURCE, OPEN_WRITE,
        ("motion-out: %s cannot be opened: %s", name, g_strerror (error)),
        (NULL));
    return NULL;
  }
  writer = g_new0 (GstL1L2StabMotionWriter, 1);
  writer->element = element;
  writer->name = g_strdup (name);
  writer->file = file;
  return writer;
}

gboolean
gst_l1l2_stab_motion_writer_close (GstL1L2StabMotionWriter * writer)
{
  gboolean ok = TRUE;

  if (writer->file) {
    const gint result = fclose (writer->file);

    writer->file = NULL;
    ok = result == 0 || fail (writer);
  }
  g_free (writer->name);
  g_free (writer);
  return ok;
}

void
gst_l1l2_stab_motion_writer_begin (GstL1L2StabMotionWriter * writer,
    const GstVideoInfo * info)
{
  if (!writer->has_header) {
    writer->info = *info;
  } else if (GST_VIDEO_INFO_WIDTH (&writer->info) != GST_VIDEO_INFO_WIDTH (info)
      || GST_VIDEO_INFO_HEIGHT (&writer->info) != GST_VIDEO_INFO_HEIGHT (info)) {
    if (!writer->has_ended)
      GST_ELEMENT_WARNING (writer->element, STREAM, FORMAT,
          ("motion-out: the size of the frames changes, so %s ends here.",
              writer->name), (NULL));
    writer->has_ended = TRUE;
  }
}

static void
append_header (GString * text, const GstVideoInfo * info)
{
  g_string_append_printf (text, GST_L1L2_STAB_MOTION_MAGIC "\n"
      "size %d %d\nframerate %d/%d\n"
      "# time-ns path-start model quality tracks inliers  "
      "F: frame t to t-1, px from the center, [a b x; c d y]\n",
      GST_VIDEO_INFO_WIDTH (info), GST_VIDEO_INFO_HEIGHT (info),
      GST_VIDEO_INFO_FPS_N (info), GST_VIDEO_INFO_FPS_D (info));
}

/* With a decimal point in every locale, and enough digits to read back the same bits. */
static void
append_number (GString * text, gdouble number)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];

  g_string_append_c (text, ' ');
  g_string_append (text, g_ascii_dtostr (digits, sizeof (digits), number));
}

/* The largest time of a file is 2^63 - 1. */
static gboolean
has_file_time (GstClockTime time)
{
  return time <= G_MAXINT64;
}

static void
append_frame (GString * text, GstClockTime time, const L1L2StabInfo * info)
{
  guint i;

  if (has_file_time (time))
    g_string_append_printf (text, "%" G_GUINT64_FORMAT, time);
  else
    g_string_append_c (text, '-');
  g_string_append_printf (text, " %d %s",
      (info->flags & L1L2STAB_INFO_PATH_START) != 0,
      gst_l1l2_stab_report_model_name (info->model));
  append_number (text, info->quality);
  g_string_append_printf (text, " %d %d", info->tracks, info->inliers);
  for (i = 0; i < 6; i++)
    append_number (text, info->F[i]);
  g_string_append_c (text, '\n');
}

/* False for a frame that is already in the file because the stream has gone back (a loop, reverse playback). Frames
 * that follow each other with one timestamp are different frames. Also false for a frame that a reader could not find:
 * one without a usable time in a file with times, or one with a time in a file without. */
static gboolean
belongs_in_file (const GstL1L2StabMotionWriter * writer, GstClockTime time)
{
  if (!writer->has_header)
    return TRUE;
  if (!writer->is_timed || !has_file_time (time))
    return writer->is_timed == has_file_time (time);
  return time > writer->written
      || (time == writer->written && time == writer->previous);
}

gboolean
gst_l1l2_stab_motion_writer_write (GstL1L2StabMotionWriter * writer,
    GstClockTime stream_time, const L1L2StabInfo * info)
{
  const gboolean belongs = belongs_in_file (writer, stream_time);
  GString *text;
  gsize written;
  gboolean ok;

  if (!writer->file)
    return FALSE;
  writer->previous = stream_time;
  if (writer->has_ended || !belongs)
    return TRUE;
  text = g_string_new (NULL);
  if (!writer->has_header) {
    append_header (text, &writer->info);
    writer->is_timed = has_file_time (stream_time);
  }
  writer->has_header = TRUE;
  append_frame (text, stream_time, info);
  /* After every line, so that the file is complete up to the last frame out even after a crash. */
  written = fwrite (text->str, 1, text->len, writer->file);
  ok = (written == text->len && fflush (writer->file) == 0) || fail (writer);
  g_string_free (text, TRUE);
  writer->written = stream_time;
  return ok;
}

gboolean
gst_l1l2_stab_motion_writer_flush (GstL1L2StabMotionWriter * writer)
{
  if (!writer->file)
    return FALSE;
  writer->has_header = writer->has_ended = FALSE;
  writer->file = g_freopen (writer->name, "w", writer->file);
  return writer->file || fail (writer);
}
