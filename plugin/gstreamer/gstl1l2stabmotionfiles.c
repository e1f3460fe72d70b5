/* SPDX-License-Identifier: MIT */
/* The two motion files of the element together: which of them is open, and what a frame gets from them. */
#include "gstl1l2stabmotionfiles.h"

#include <glib/gstdio.h>

/* Also by two names of one file, such as a link. */
static gboolean
is_same_file (const gchar * one, const gchar * other)
{
  GStatBuf a, b;

  return g_strcmp0 (one, other) == 0
      || (g_stat (one, &a) == 0 && g_stat (other, &b) == 0
      && a.st_dev == b.st_dev && a.st_ino == b.st_ino);
}

gboolean
gst_l1l2_stab_motion_files_open (GstL1L2StabMotionFiles * files,
    GstElement * element, const gchar * in, const gchar * out)
{
  gst_l1l2_stab_motion_files_close (files);
  if (in && out && is_same_file (in, out)) {
    GST_ELEMENT_ERROR (element, RESOURCE, OPEN_WRITE,
        ("motion-in and motion-out are both %s, but must be two files.", in), (NULL));
    return FALSE;
  }
  if (in)
    files->in = gst_l1l2_stab_motion_reader_open (element, in);
  /* Opening motion-out empties it, so motion-in is opened first: its errors stop the run. */
  if (out && (files->in || !in))
    files->out = gst_l1l2_stab_motion_writer_open (element, out);
  if ((!in || files->in) && (!out || files->out))
    return TRUE;
  gst_l1l2_stab_motion_files_close (files);
  return FALSE;
}

void
gst_l1l2_stab_motion_files_close (GstL1L2StabMotionFiles * files)
{
  g_clear_pointer (&files->in, gst_l1l2_stab_motion_reader_close);
  g_clear_pointer (&files->out, gst_l1l2_stab_motion_writer_close);
}

gboolean
gst_l1l2_stab_motion_files_begin (GstL1L2StabMotionFiles * files,
    const GstVideoInfo * info)
{
  if (files->out)
    gst_l1l2_stab_motion_writer_begin (files->out, info);
  return !files->in || gst_l1l2_stab_motion_reader_check (files->in, info);
}

void
gst_l1l2_stab_motion_files_flush (GstL1L2StabMotionFiles * files)
{
  if (files->in)
    gst_l1l2_stab_motion_reader_flush (files->in);
  if (files->out)
    gst_l1l2_stab_motion_writer_flush (files->out);
}

gboolean
gst_l1l2_stab_motion_files_read (GstL1L2StabMotionFiles * files, GstClockTime time,
    GstL1L2StabMotion * motion, L1L2StabFrame * frame)
{
  if (!files->in)
    return TRUE;
  if (!gst_l1l2_stab_motion_reader_next (files->in, time, motion))
    return FALSE;
  frame->motion = motion->F;
  if (motion->starts_path)
    frame->flags |= L1L2STAB_FRAME_DISCONT;
  return TRUE;
}

/* A frame that starts a path for another reason has no motion, although the file has one. */
gboolean
gst_l1l2_stab_motion_files_write (GstL1L2StabMotionFiles * files, GstClockTime time,
    const GstL1L2StabMotion * motion, L1L2StabInfo * info)
{
  if (files->in && !(info->flags & L1L2STAB_INFO_PATH_START)) {
    info->model = motion->model;
    info->quality = motion->quality;
    info->tracks = motion->tracks;
    info->inliers = motion->inliers;
    if (info->model == L1L2STAB_MOTION_SOURCE_IDENTITY
        || info->model == L1L2STAB_MOTION_SOURCE_PREDICTED)
      info->flags |= L1L2STAB_INFO_MOTION_LOST;
  }
  return !files->out
      || gst_l1l2_stab_motion_writer_write (files->out, time, info);
}
