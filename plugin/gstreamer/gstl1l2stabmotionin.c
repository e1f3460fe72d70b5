/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabmotion.h"

#include <math.h>
#include <stdlib.h>

#include "gstl1l2stabreport.h"

/* time path-start model quality tracks inliers a b x c d y */
#define N_FIELDS 12

/* Between a frame's time and its line's, where the file does not tell its frame rate. */
#define ASSUMED_TOLERANCE (10 * GST_MSECOND)

struct _GstL1L2StabMotionIn
{
  GstElement *element;          /* not owned */
  gchar *name;
  gint width, height;           /* of its frames; 0: it did not say */
  gint fps_n, fps_d;
  GArray *lines;                /* GstL1L2StabMotion, in the order of their times */
  gboolean is_timed;
  gint last;                    /* the line that was asked for last; -1: none */
};

static gboolean
parse_int (const gchar * text, gint least, gint most, gint * value)
{
  gint64 number;

  if (!g_ascii_string_to_signed (text, 10, least, most, &number, NULL))
    return FALSE;
  *value = (gint) number;
  return TRUE;
}

static gboolean
parse_double (const gchar * text, gdouble * value)
{
  gchar *end;

  *value = g_ascii_strtod (text, &end);
  return end != text && *end == '\0' && isfinite (*value);
}

static gboolean
parse_model (const gchar * text, L1L2StabMotionSource * model)
{
  for (*model = L1L2STAB_MOTION_SOURCE_NONE; *model <= L1L2STAB_MOTION_SOURCE_AFFINE;
      (*model)++) {
    if (g_str_equal (text, gst_l1l2_stab_report_model_name (*model)))
      return TRUE;
  }
  return FALSE;
}

/* What is wrong with the fields of a frame's line, or NULL. */
static const gchar *
parse_frame (gchar ** fields, GstL1L2StabMotion * line)
{
  const gchar *time = fields[0];
  guint i;

  if (g_strv_length (fields) < N_FIELDS)
    return "has fewer than 12 fields";
  line->time = GST_CLOCK_TIME_NONE;
  if (!g_str_equal (time, "-")
      && !g_ascii_string_to_unsigned (time, 10, 0, G_MAXINT64, &line->time,
          NULL))
    return "begins with neither a time in nanoseconds nor -";
  if (!parse_int (fields[1], 0, 1, &line->starts_path))
    return "has a path-start that is neither 0 nor 1";
  if (!parse_model (fields[2], &line->model))
    return "has a model that is not known";
  if (!parse_double (fields[3], &line->quality)
      || !parse_int (fields[4], 0, G_MAXINT, &line->tracks)
      || !parse_int (fields[5], 0, G_MAXINT, &line->inliers))
    return "has a quality, tracks or inliers that are no numbers";
  for (i = 0; i < 6; i++) {
    if (!parse_double (fields[6 + i], &line->F[i]))
      return "has a motion that is not of six numbers";
  }
  line->F[6] = line->F[7] = 0;
  line->F[8] = 1;
  if (line->F[0] * line->F[4] - line->F[1] * line->F[3] <= 0)
    return "has a motion that cannot be inverted, or mirrors";
  return NULL;
}

static const gchar *
add_frame (GstL1L2StabMotionIn * in, gchar ** fields)
{
  GstL1L2StabMotion line = { 0 };
  const gchar *fault = parse_frame (fields, &line);
  const gboolean is_timed = GST_CLOCK_TIME_IS_VALID (line.time);

  if (fault)
    return fault;
  if (in->lines->len == 0)
    in->is_timed = is_timed;
  if (is_timed != in->is_timed)
    return "has a time and others have none, or the other way round";
  if (is_timed && in->lines->len > 0 && line.time <= g_array_index (in->lines,
          GstL1L2StabMotion, in->lines->len - 1).time)
    return "is not later than the line before it";
  g_array_append_val (in->lines, line);
  return NULL;
}

/* What is wrong with a line after the first, or NULL. Words that a later version may add are passed over. */
static const gchar *
parse_line (GstL1L2StabMotionIn * in, gchar ** fields)
{
  const guint n = g_strv_length (fields);
  gchar *slash;

  if (n == 0 || fields[0][0] == '#')
    return NULL;
  if (g_str_equal (fields[0], "size"))
    return n == 3 && parse_int (fields[1], 1, G_MAXINT, &in->width)
        && parse_int (fields[2], 1, G_MAXINT, &in->height) ? NULL :
        "has no size such as: size 1920 1080";
  if (g_str_equal (fields[0], "framerate")) {
    slash = n == 2 ? strchr (fields[1], '/') : NULL;
    if (slash)
      *slash = '\0';
    return slash && parse_int (fields[1], 0, G_MAXINT, &in->fps_n)
        && parse_int (slash + 1, 1, G_MAXINT, &in->fps_d) ? NULL :
        "has no rate such as: framerate 30000/1001";
  }
  if (g_ascii_isalpha (fields[0][0]))
    return NULL;
  return add_frame (in, fields);
}

static gboolean
fail (GstL1L2StabMotionIn * in, guint number, const gchar * fault)
{
  GST_ELEMENT_ERROR (in->element, RESOURCE, READ,
      ("motion-in: line %u of %s %s.", number, in->name, fault), (NULL));
  return FALSE;
}

static gchar **
split (gchar * text)
{
  GPtrArray *fields = g_ptr_array_new ();
  gchar *field, *rest = text;

  while ((field = strtok_r (rest, " \t\r", &rest)) != NULL)
    g_ptr_array_add (fields, field);
  g_ptr_array_add (fields, NULL);
  return (gchar **) g_ptr_array_free (fields, FALSE);
}

static gboolean
parse (GstL1L2StabMotionIn * in, gchar * text)
{
  gchar **lines = g_strsplit (text, "\n", -1);
  const gchar *fault = NULL;
  guint i = 0;

  if (!lines[0]
      || !g_str_equal (g_strchomp (lines[0]), GST_L1L2_STAB_MOTION_MAGIC))
    fault = "is not \"" GST_L1L2_STAB_MOTION_MAGIC "\"";
  while (!fault && lines[++i]) {
    gchar **fields = split (lines[i]);

    fault = parse_line (in, fields);
    g_free (fields);
  }
  g_strfreev (lines);
  return !fault || fail (in, i + 1, fault);
}

GstL1L2StabMotionIn *
gst_l1l2_stab_motion_in_open (GstElement * element, const gchar * name)
{
  GstL1L2StabMotionIn *in;
  GError *error = NULL;
  gchar *text;

  if (!g_file_get_contents (name, &text, NULL, &error)) {
    GST_ELEMENT_ERROR (element, RESOURCE, OPEN_READ,
        ("motion-in: %s", error->message), (NULL));
    g_error_free (error);
    return NULL;
  }
  in = g_new0 (GstL1L2StabMotionIn, 1);
  in->element = element;
  in->name = g_strdup (name);
  in->lines = g_array_new (FALSE, FALSE, sizeof (GstL1L2StabMotion));
  in->last = -1;
  if (!parse (in, text))
    g_clear_pointer (&in, gst_l1l2_stab_motion_in_close);
  g_free (text);
  return in;
}

void
gst_l1l2_stab_motion_in_close (GstL1L2StabMotionIn * in)
{
  g_array_unref (in->lines);
  g_free (in->name);
  g_free (in);
}

/* By their time frames are found at any rate. */
gboolean
gst_l1l2_stab_motion_in_check (GstL1L2StabMotionIn * in,
    const GstVideoInfo * info)
{
  const gint width = GST_VIDEO_INFO_WIDTH (info);
  const gint height = GST_VIDEO_INFO_HEIGHT (info);
  const gint fps_n = GST_VIDEO_INFO_FPS_N (info);
  const gint fps_d = GST_VIDEO_INFO_FPS_D (info);

  if (in->width && (in->width != width || in->height != height)) {
    GST_ELEMENT_ERROR (in->element, RESOURCE, READ,
        ("motion-in: %s is of frames of %dx%d pixels; these are of %dx%d.",
            in->name, in->width, in->height, width, height), (NULL));
    return FALSE;
  }
  if (!in->is_timed && in->fps_n && fps_n
      && gst_util_fraction_compare (in->fps_n, in->fps_d, fps_n, fps_d)) {
    GST_ELEMENT_ERROR (in->element, RESOURCE, READ,
        ("motion-in: %s is of %d/%d frames a second, without times; these are "
            "%d/%d.", in->name, in->fps_n, in->fps_d, fps_n, fps_d), (NULL));
    return FALSE;
  }
  return TRUE;
}

static const GstL1L2StabMotion *
get_line (const GstL1L2StabMotionIn * in, gint index)
{
  return &g_array_index (in->lines, GstL1L2StabMotion, index);
}

/* The line whose time is nearest; the file has some. */
static gint
find_nearest (const GstL1L2StabMotionIn * in, GstClockTime time)
{
  gint low = 0, high = in->lines->len;

  /* The first line that is not before `time` is sought from low to high. */
  while (low < high) {
    const gint middle = low + (high - low) / 2;

    if (get_line (in, middle)->time < time)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == (gint) in->lines->len || (low > 0 && time - get_line (in,
              low - 1)->time < get_line (in, low)->time - time))
    return low - 1;
  return low;
}

/* The line of the frame at this time, or -1. */
static gint
find_line (const GstL1L2StabMotionIn * in, GstClockTime time)
{
  GstClockTime tolerance = ASSUMED_TOLERANCE;
  gint line;

  if (!in->is_timed)
    return in->last + 1 < (gint) in->lines->len ? in->last + 1 : -1;
  if (in->lines->len == 0 || !GST_CLOCK_TIME_IS_VALID (time))
    return -1;
  if (in->fps_n)
    tolerance = gst_util_uint64_scale (GST_SECOND / 2, in->fps_d, in->fps_n);
  line = find_nearest (in, time);
  return (GstClockTime) ABS (GST_CLOCK_DIFF (time, get_line (in, line)->time))
      <= tolerance ? line : -1;
}

static void
multiply (gdouble F[9], const gdouble G[9])
{
  const gdouble a = F[0], b = F[1], c = F[3], d = F[4];
  const gboolean similar = a == d && b == -c && G[0] == G[4] && G[1] == -G[3];

  F[2] += a * G[2] + b * G[5];
  F[5] += c * G[2] + d * G[5];
  F[0] = a * G[0] + b * G[3];
  F[3] = c * G[0] + d * G[3];
  /* To the bit, however the sums are rounded. */
  F[1] = similar ? -F[3] : a * G[1] + b * G[4];
  F[4] = similar ? F[0] : c * G[1] + d * G[4];
}

static void
invert (gdouble F[9])
{
  const gdouble det = F[0] * F[4] - F[1] * F[3];
  const gdouble a = F[4] / det, b = -F[1] / det;
  const gdouble c = -F[3] / det, d = F[0] / det;
  const gdouble x = -(a * F[2] + b * F[5]), y = -(c * F[2] + d * F[5]);

  F[0] = a, F[1] = b, F[2] = x;
  F[3] = c, F[4] = d, F[5] = y;
}

/* From line `from` to line `to`: what is between them, and the start of a path if there is one. */
static void
compose (const GstL1L2StabMotionIn * in, gint from, gint to,
    GstL1L2StabMotion * motion)
{
  static const gdouble identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  const gint first = MIN (from, to) + 1, last = MAX (from, to);
  gint i;

  *motion = *get_line (in, to);
  if (from < 0 || to == from + 1)
    return;
  motion->starts_path = FALSE;
  memcpy (motion->F, identity, sizeof (identity));
  for (i = first; i <= last; i++) {
    multiply (motion->F, get_line (in, i)->F);
    motion->starts_path |= get_line (in, i)->starts_path;
  }
  if (to < from)
    invert (motion->F);
}

gboolean
gst_l1l2_stab_motion_in_next (GstL1L2StabMotionIn * in,
    GstClockTime stream_time, GstL1L2StabMotion * motion)
{
  const gint line = find_line (in, stream_time);

  if (line < 0) {
    GST_ELEMENT_ERROR (in->element, RESOURCE, READ,
        ("motion-in: %s has no line for the frame at %" GST_TIME_FORMAT ".",
            in->name, GST_TIME_ARGS (stream_time)), (NULL));
    return FALSE;
  }
  compose (in, in->last, line, motion);
  in->last = line;
  return TRUE;
}

void
gst_l1l2_stab_motion_in_flush (GstL1L2StabMotionIn * in)
{
  in->last = -1;
}
