/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabmotion.h"

#include <errno.h>
#include <glib/gstdio.h>

#include "gstl1l2stabreport.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug
GST_DEBUG_CATEGORY_EXTERN (gst_l1l2_stab_debug);

struct _GstL1L2StabMotionOut
{
  GstElement *element;          /* not owned */
  gchar *name;
  FILE *file;                   /* NULL: an error was posted */
  GstVideoInfo info;            /* of the frames in it */
  gboolean has_header;
  gboolean has_ended;           /* frames of another size came */
  GstClockTime last;            /* stream time of the last line */
};

static gboolean
fail (GstL1L2StabMotionOut * out)
{
  const gint error = errno;

  GST_ELEMENT_ERROR (out->element, RESOURCE, WRITE,
      ("motion-out: %s cannot be written: %s", out->name, g_strerror (error)),
      (NULL));
  if (out->file)
    fclose (out->file);
  out->file = NULL;
  return FALSE;
}

GstL1L2StabMotionOut *
gst_l1l2_stab_motion_out_open (GstElement * element, const gchar * name)
{
  FILE *file = g_fopen (name, "w");
  GstL1L2StabMotionOut *out;

  if (!file) {
    const gint error = errno;

    GST_ELEMENT_ERROR (element, RESOURCE, OPEN_WRITE,
        ("motion-out: %s cannot be opened: %s", name, g_strerror (error)),
        (NULL));
    return NULL;
  }
  out = g_new0 (GstL1L2StabMotionOut, 1);
  out->element = element;
  out->name = g_strdup (name);
  out->file = file;
  out->last = GST_CLOCK_TIME_NONE;
  return out;
}

gboolean
gst_l1l2_stab_motion_out_close (GstL1L2StabMotionOut * out)
{
  gboolean ok = TRUE;

  if (out->file) {
    const gint result = fclose (out->file);

    out->file = NULL;
    ok = result == 0 || fail (out);
  }
  g_free (out->name);
  g_free (out);
  return ok;
}

void
gst_l1l2_stab_motion_out_begin (GstL1L2StabMotionOut * out,
    const GstVideoInfo * info)
{
  if (!out->has_header) {
    out->info = *info;
  } else if (GST_VIDEO_INFO_WIDTH (&out->info) != GST_VIDEO_INFO_WIDTH (info)
      || GST_VIDEO_INFO_HEIGHT (&out->info) != GST_VIDEO_INFO_HEIGHT (info)) {
    if (!out->has_ended)
      GST_ELEMENT_WARNING (out->element, STREAM, FORMAT,
          ("motion-out: the size of the frames changes; %s ends here",
              out->name), (NULL));
    out->has_ended = TRUE;
  }
}

static void
append_header (GString * text, const GstVideoInfo * info)
{
  g_string_append_printf (text, GST_L1L2_STAB_MOTION_MAGIC "\n"
      "size %d %d\nframerate %d/%d\n"
      "# time-ns path-start model quality tracks inliers  "
      "F: frame t to t-1, px from the centre, [a b x; c d y]\n",
      GST_VIDEO_INFO_WIDTH (info), GST_VIDEO_INFO_HEIGHT (info),
      GST_VIDEO_INFO_FPS_N (info), GST_VIDEO_INFO_FPS_D (info));
}

/* With a point in every locale, and enough digits to be read back to the bit. */
static void
append_number (GString * text, gdouble number)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];

  g_string_append_c (text, ' ');
  g_string_append (text, g_ascii_dtostr (digits, sizeof (digits), number));
}

static void
append_frame (GString * text, GstClockTime time, const L1L2StabInfo * info)
{
  guint i;

  if (GST_CLOCK_TIME_IS_VALID (time))
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

gboolean
gst_l1l2_stab_motion_out_write (GstL1L2StabMotionOut * out,
    GstClockTime stream_time, const L1L2StabInfo * info)
{
  const gboolean is_again = GST_CLOCK_TIME_IS_VALID (out->last)
      && (!GST_CLOCK_TIME_IS_VALID (stream_time) || stream_time <= out->last);
  GString *text;
  gsize written;
  gboolean ok;

  if (!out->file)
    return FALSE;
  if (out->has_ended || is_again)
    return TRUE;
  text = g_string_new (NULL);
  if (!out->has_header)
    append_header (text, &out->info);
  out->has_header = TRUE;
  append_frame (text, stream_time, info);
  /* Whoever looks, at the end or after a crash, finds every frame that went out. */
  written = fwrite (text->str, 1, text->len, out->file);
  ok = (written == text->len && fflush (out->file) == 0) || fail (out);
  g_string_free (text, TRUE);
  out->last = stream_time;
  return ok;
}

gboolean
gst_l1l2_stab_motion_out_flush (GstL1L2StabMotionOut * out)
{
  if (!out->file)
    return FALSE;
  out->has_header = out->has_ended = FALSE;
  out->last = GST_CLOCK_TIME_NONE;
  out->file = g_freopen (out->name, "w", out->file);
  return out->file || fail (out);
}
