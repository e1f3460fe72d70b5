/* SPDX-License-Identifier: MIT */
/* Reads a motion file: parses and checks its lines when the element starts, then finds the motion of each frame. */
#include "gstl1l2stabmotionfiles.h"

#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "gstl1l2stabconvert.h"
#include "gstl1l2stabmatrix.h"
#include "gstl1l2stabreport.h"

/* time path-start model quality tracks inliers a b x c d y */
#define N_FIELDS 12

/* The largest distance between the time of a frame and that of its line, if the file has no frame rate. */
#define ASSUMED_TOLERANCE (10 * GST_MSECOND)

/* A day of video has some 300 MB. */
#define MAX_FILE_SIZE (1024 * 1024 * 1024)

/* The motions that the library accepts: see L1L2StabFrame. */
#define MAX_STEP 10.0           /* diagonals */
#define MAX_STRETCH 2.0

struct _GstL1L2StabMotionReader
{
  GstElement *element;          /* not owned */
  gchar *name;
  gint width, height;           /* of the frames, pixels; 0: the file has no size */
  gint fps_n, fps_d;            /* 0/x: the file has no frame rate */
  GArray *lines;                /* of GstL1L2StabMotion, in the order of their times */
  gboolean is_timed;
  gdouble diagonal;             /* of the frames that are read now, pixels */

  /* The frame that was asked for last. */
  gint last;                    /* its line; -1: there was none */
  GstClockTime last_time;       /* its stream time */
  gboolean is_backward;         /* playback goes backward: the line of the frame before it is a later one */
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
  for (*model = L1L2STAB_MOTION_SOURCE_NONE; *model <= L1L2STAB_MOTION_SOURCE_ALIGNMENT;
      (*model)++) {
    if (g_str_equal (text, gst_l1l2_stab_report_model_name (*model)))
      return TRUE;
  }
  return FALSE;
}

static const gchar *
parse_time (const gchar * text, GstClockTime * time)
{
  GError *error = NULL;
  gboolean is_large;

  *time = GST_CLOCK_TIME_NONE;
  if (g_str_equal (text, "-")
      || g_ascii_string_to_unsigned (text, 10, 0, G_MAXINT64, time, &error))
    return NULL;
  is_large = g_error_matches (error, G_NUMBER_PARSER_ERROR,
      G_NUMBER_PARSER_ERROR_OUT_OF_BOUNDS);
  g_error_free (error);
  return is_large ? "has a time of more than 2^63 - 1 nanoseconds"
      : "begins with neither a time in nanoseconds nor -";
}

/* The six numbers of an affine map that keeps the orientation and can be inverted. */
static const gchar *
parse_motion (gchar ** fields, gdouble F[9])
{
  gdouble determinant;
  guint i;

  for (i = 0; i < 6; i++) {
    if (!parse_double (fields[i], &F[i]))
      return "has a motion that is not of six numbers";
  }
  F[6] = F[7] = 0;
  F[8] = 1;
  determinant = F[0] * F[4] - F[1] * F[3];
  if (!isfinite (determinant))
    return "has a motion whose determinant is too large";
  if (determinant <= 0)
    return "has a motion that cannot be inverted, or mirrors";
  return NULL;
}

/* Parses the fields of a frame. Returns what is wrong with them, or NULL. */
static const gchar *
parse_frame (gchar ** fields, GstL1L2StabMotion * line)
{
  const gchar *fault;

  if (g_strv_length (fields) < N_FIELDS)
    return "has fewer than 12 fields";
  fault = parse_time (fields[0], &line->time);
  if (fault)
    return fault;
  if (!parse_int (fields[1], 0, 1, &line->starts_path))
    return "has a path-start that is neither 0 nor 1";
  if (!parse_model (fields[2], &line->model))
    return "has a model that is not known";
  if (!parse_double (fields[3], &line->quality)
      || !parse_int (fields[4], 0, G_MAXINT, &line->tracks)
      || !parse_int (fields[5], 0, G_MAXINT, &line->inliers))
    return "has a quality, tracks or inliers that are not numbers";
  if (line->quality < 0 || line->quality > 1)
    return "has a quality that is not between 0 and 1";
  if (line->inliers > line->tracks)
    return "has more inliers than tracks";
  return parse_motion (fields + 6, line->F);
}

static const gchar *
add_frame (GstL1L2StabMotionReader * reader, gchar ** fields)
{
  GstL1L2StabMotion line = { 0 };
  const gchar *fault = parse_frame (fields, &line);
  const gboolean is_timed = GST_CLOCK_TIME_IS_VALID (line.time);

  if (fault)
    return fault;
  if (reader->lines->len == 0)
    reader->is_timed = is_timed;
  if (is_timed != reader->is_timed)
    return "has a time and others have none, or the other way round";
  if (is_timed && reader->lines->len > 0 && line.time < g_array_index (reader->lines,
          GstL1L2StabMotion, reader->lines->len - 1).time)
    return "is earlier than the line before it";
  g_array_append_val (reader->lines, line);
  return NULL;
}

/* Parses a line after the first. Returns what is wrong with it, or NULL. A line that begins with an unknown word is
 * skipped: a later version may add some. */
static const gchar *
parse_line (GstL1L2StabMotionReader * reader, gchar ** fields)
{
  const guint n = g_strv_length (fields);
  gchar *slash;

  if (n == 0 || fields[0][0] == '#')
    return NULL;
  if (g_str_equal (fields[0], "size"))
    return n == 3 && parse_int (fields[1], 1, G_MAXINT, &reader->width)
        && parse_int (fields[2], 1, G_MAXINT, &reader->height) ? NULL :
        "has no size such as: size 1920 1080";
  if (g_str_equal (fields[0], "framerate")) {
    slash = n == 2 ? strchr (fields[1], '/') : NULL;
    if (slash)
      *slash = '\0';
    return slash && parse_int (fields[1], 0, G_MAXINT, &reader->fps_n)
        && parse_int (slash + 1, 1, G_MAXINT, &reader->fps_d) ? NULL :
        "has no rate such as: framerate 30000/1001";
  }
  if (g_ascii_isalpha (fields[0][0]))
    return NULL;
  return add_frame (reader, fields);
}

static gboolean
fail (GstL1L2StabMotionReader * reader, guint number, const gchar * fault)
{
  GST_ELEMENT_ERROR (reader->element, RESOURCE, READ,
      ("motion-in: line %u of %s %s.", number, reader->name, fault), (NULL));
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
parse (GstL1L2StabMotionReader * reader, gchar * text)
{
  gchar **lines = g_strsplit (text, "\n", -1);
  const gchar *fault = NULL;
  guint i = 0;

  if (!lines[0]
      || !g_str_equal (g_strchomp (lines[0]), GST_L1L2_STAB_MOTION_MAGIC))
    fault = "is not \"" GST_L1L2_STAB_MOTION_MAGIC "\"";
  while (!fault && lines[++i]) {
    gchar **fields = split (lines[i]);

    fault = parse_line (reader, fields);
    g_free (fields);
  }
  g_strfreev (lines);
  return !fault || fail (reader, i + 1, fault);
}

/* Opening a pipe that nobody writes to would wait for ever, and a device may have no end. */
static gboolean
is_readable (GstElement * element, const gchar * name)
{
  const gchar *fault = NULL;
  GStatBuf status;

  if (g_stat (name, &status) != 0)
    return TRUE;                /* opening it will say why */
  if (!S_ISREG (status.st_mode))
    fault = "is not a regular file";
  else if (status.st_size > MAX_FILE_SIZE)
    fault = "is larger than 1 GB, and so no motion file";
  if (fault)
    GST_ELEMENT_ERROR (element, RESOURCE, READ, ("motion-in: %s %s.", name,
            fault), (NULL));
  return !fault;
}

GstL1L2StabMotionReader *
gst_l1l2_stab_motion_reader_open (GstElement * element, const gchar * name)
{
  GstL1L2StabMotionReader *reader;
  GError *error = NULL;
  gchar *text;

  if (!is_readable (element, name))
    return NULL;

  if (!g_file_get_contents (name, &text, NULL, &error)) {
    GST_ELEMENT_ERROR (element, RESOURCE, OPEN_READ,
        ("motion-in: %s", error->message), (NULL));
    g_error_free (error);
    return NULL;
  }
  reader = g_new0 (GstL1L2StabMotionReader, 1);
  reader->element = element;
  reader->name = g_strdup (name);
  reader->lines = g_array_new (FALSE, FALSE, sizeof (GstL1L2StabMotion));
  reader->last = -1;
  if (!parse (reader, text))
    g_clear_pointer (&reader, gst_l1l2_stab_motion_reader_close);
  g_free (text);
  return reader;
}

void
gst_l1l2_stab_motion_reader_close (GstL1L2StabMotionReader * reader)
{
  g_array_unref (reader->lines);
  g_free (reader->name);
  g_free (reader);
}

/* A frame rate matters only if the lines have no times. */
gboolean
gst_l1l2_stab_motion_reader_check (GstL1L2StabMotionReader * reader,
    const GstVideoInfo * info)
{
  const gint width = GST_VIDEO_INFO_WIDTH (info);
  const gint height = GST_VIDEO_INFO_HEIGHT (info);
  const gint fps_n = GST_VIDEO_INFO_FPS_N (info);
  const gint fps_d = GST_VIDEO_INFO_FPS_D (info);

  reader->diagonal = hypot (width, height);
  if (reader->width && (reader->width != width || reader->height != height)) {
    GST_ELEMENT_ERROR (reader->element, RESOURCE, READ,
        ("motion-in: %s is for frames of %dx%d pixels, but these have %dx%d.",
            reader->name, reader->width, reader->height, width, height), (NULL));
    return FALSE;
  }
  if (!reader->is_timed && reader->fps_n && fps_n
      && gst_util_fraction_compare (reader->fps_n, reader->fps_d, fps_n, fps_d)) {
    GST_ELEMENT_ERROR (reader->element, RESOURCE, READ,
        ("motion-in: %s is for %d/%d frames per second and has no times, but "
            "these are %d/%d.", reader->name, reader->fps_n, reader->fps_d, fps_n, fps_d), (NULL));
    return FALSE;
  }
  return TRUE;
}

static const GstL1L2StabMotion *
get_line (const GstL1L2StabMotionReader * reader, gint index)
{
  return &g_array_index (reader->lines, GstL1L2StabMotion, index);
}

/* The line whose time is nearest. The file must have lines. */
static gint
find_nearest (const GstL1L2StabMotionReader * reader, GstClockTime time)
{
  gint low = 0, high = reader->lines->len;

  /* A binary search for the first line that is not earlier than `time`. */
  while (low < high) {
    const gint middle = low + (high - low) / 2;

    if (get_line (reader, middle)->time < time)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == (gint) reader->lines->len || (low > 0
          && time - get_line (reader, low - 1)->time < get_line (reader,
              low)->time - time))
    return low - 1;
  return low;
}

/* Of the lines that have the same time as `line`, the one for a frame at `time`. Frames that share a timestamp take
 * these lines in turn, and the last of them again if there are more frames than lines. Playback that comes from a later
 * line takes them in reverse order. */
static gint
select_repeated (GstL1L2StabMotionReader * reader, gint line, GstClockTime time)
{
  const GstClockTime line_time = get_line (reader, line)->time;
  gint first = line, last = line;

  while (first > 0 && get_line (reader, first - 1)->time == line_time)
    first--;
  while (last + 1 < (gint) reader->lines->len
      && get_line (reader, last + 1)->time == line_time)
    last++;
  if (reader->last >= first && reader->last <= last) {
    if (time != reader->last_time)
      return reader->last;
    return CLAMP (reader->last + (reader->is_backward ? -1 : 1), first, last);
  }
  reader->is_backward = reader->last > last;
  return reader->is_backward ? last : first;
}

/* The line of the frame at this time, or -1. */
static gint
find_line (GstL1L2StabMotionReader * reader, GstClockTime time)
{
  GstClockTime tolerance = ASSUMED_TOLERANCE;
  gint line;

  if (!reader->is_timed)
    return reader->last + 1 < (gint) reader->lines->len ? reader->last + 1 : -1;
  if (reader->lines->len == 0 || !GST_CLOCK_TIME_IS_VALID (time))
    return -1;
  if (reader->fps_n)
    tolerance = gst_util_uint64_scale (GST_SECOND / 2, reader->fps_d,
        reader->fps_n);
  line = find_nearest (reader, time);
  if (gst_l1l2_stab_convert_time_distance (time, get_line (reader,
              line)->time) > tolerance)
    return -1;
  return select_repeated (reader, line, time);
}

/* F = F G. The library wants a similarity exact to the bit (a = d, b = -c), so rounding must not spoil one. */
static void
append_motion (gdouble F[9], const gdouble G[9])
{
  const gboolean is_similarity = F[0] == F[4] && F[1] == -F[3]
      && G[0] == G[4] && G[1] == -G[3];

  gst_l1l2_stab_matrix_multiply (F, G, F);
  if (is_similarity) {
    F[1] = -F[3];
    F[4] = F[0];
  }
}

/* Whether the library accepts the motion: many frames that are skipped may have moved too far. */
static gboolean
is_accepted (const GstL1L2StabMotionReader * reader, const gdouble F[9])
{
  const gdouble p = hypot (F[0] + F[4], F[3] - F[1]);
  const gdouble q = hypot (F[0] - F[4], F[3] + F[1]);

  return hypot (F[2], F[5]) <= MAX_STEP * reader->diagonal
      && (p + q) / 2 <= MAX_STRETCH && (p - q) / 2 >= 1 / MAX_STRETCH;
}

/* The motion over the lines between these two, of which `to` may be the earlier one. A path starts if one starts
 * between them, or if the frames have nothing in common any more. */
static void
compose_skipped (const GstL1L2StabMotionReader * reader, gint from, gint to,
    GstL1L2StabMotion * motion)
{
  static const gdouble identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  gdouble F[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  const gint first = MIN (from, to) + 1, last = MAX (from, to);
  gint i;

  motion->starts_path = FALSE;
  for (i = first; i <= last && !motion->starts_path; i++) {
    append_motion (F, get_line (reader, i)->F);
    motion->starts_path = get_line (reader, i)->starts_path
        || !is_accepted (reader, F);
  }
  if (motion->starts_path)
    memcpy (motion->F, identity, sizeof (identity));
  else if (to < from)
    gst_l1l2_stab_matrix_invert (F, motion->F);
  else
    memcpy (motion->F, F, sizeof (F));
  if (!is_accepted (reader, motion->F)) {       /* the inverse of a zoom may move farther than the zoom */
    motion->starts_path = TRUE;
    memcpy (motion->F, identity, sizeof (identity));
  }
}

/* The motion from the frame of line `to` to that of line `from`. */
static void
compose (const GstL1L2StabMotionReader * reader, gint from, gint to,
    GstL1L2StabMotion * motion)
{
  *motion = *get_line (reader, to);
  if (from >= 0 && to != from + 1)
    compose_skipped (reader, from, to, motion);
}

gboolean
gst_l1l2_stab_motion_reader_next (GstL1L2StabMotionReader * reader,
    GstClockTime stream_time, GstL1L2StabMotion * motion)
{
  const gint line = find_line (reader, stream_time);

  if (line < 0) {
    GST_ELEMENT_ERROR (reader->element, RESOURCE, READ,
        ("motion-in: %s has no line for the frame at %" GST_TIME_FORMAT ".",
            reader->name, GST_TIME_ARGS (stream_time)), (NULL));
    return FALSE;
  }
  compose (reader, reader->last, line, motion);
  reader->last = line;
  reader->last_time = stream_time;
  return TRUE;
}

void
gst_l1l2_stab_motion_reader_flush (GstL1L2StabMotionReader * reader)
{
  reader->last = -1;
}
