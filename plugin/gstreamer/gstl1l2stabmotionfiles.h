/* SPDX-License-Identifier: MIT */
/* Motion files: text files with the camera motion of each frame, which one run writes and another reads. The format
 * is in docs/motion-file.md. */
#ifndef GST_L1L2_STAB_MOTION_FILES_H
#define GST_L1L2_STAB_MOTION_FILES_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

#define GST_L1L2_STAB_MOTION_MAGIC "l1l2stab-motion 1"

/* A line of the file: the motion of one frame. */
typedef struct
{
  GstClockTime time;            /* stream time; NONE: the frames come in the order of the lines */
  gboolean starts_path;
  L1L2StabMotionSource model;
  gdouble quality;
  gint tracks, inliers;
  gdouble F[9];                 /* from this frame to the one before it; pixels, origin at the center */
} GstL1L2StabMotion;

typedef struct _GstL1L2StabMotionReader GstL1L2StabMotionReader;
typedef struct _GstL1L2StabMotionWriter GstL1L2StabMotionWriter;

typedef struct
{
  GstL1L2StabMotionReader *in;      /* NULL: the motion is measured */
  GstL1L2StabMotionWriter *out;    /* NULL: the motion is not written */
} GstL1L2StabMotionFiles;

/* Opens the files of these names. Each may be NULL. FALSE: `element` has posted an error. */
gboolean gst_l1l2_stab_motion_files_open (GstL1L2StabMotionFiles * files,
    GstElement * element, const gchar * in, const gchar * out);
void gst_l1l2_stab_motion_files_close (GstL1L2StabMotionFiles * files);

/* Tells the files which frames come next. FALSE: motion-in is for other frames, and an error was posted. */
gboolean gst_l1l2_stab_motion_files_begin (GstL1L2StabMotionFiles * files,
    const GstVideoInfo * info);

/* After a flushing seek: the frames that come next do not follow those before. */
void gst_l1l2_stab_motion_files_flush (GstL1L2StabMotionFiles * files);

/* If there is a motion-in, sets the motion of the frame that comes in at this stream time; frame->motion then points
 * into *motion. FALSE: an error was posted. */
gboolean gst_l1l2_stab_motion_files_read (GstL1L2StabMotionFiles * files,
    GstClockTime time, GstL1L2StabMotion * motion, L1L2StabFrame * frame);

/* If there is a motion-out, writes the frame that goes out at this stream time. If the motion was read, the source,
 * quality, tracks and inliers of *info are set to those of the file. FALSE: an error was posted. */
gboolean gst_l1l2_stab_motion_files_write (GstL1L2StabMotionFiles * files,
    GstClockTime time, const GstL1L2StabMotion * motion, L1L2StabInfo * info);

/* --- the reader --- */

/* NULL: `element` has posted an error. */
GstL1L2StabMotionReader *gst_l1l2_stab_motion_reader_open (GstElement * element,
    const gchar * name);
void gst_l1l2_stab_motion_reader_close (GstL1L2StabMotionReader * in);

/* Checks that the file is for frames like these. FALSE: it is not, and an error was posted. */
gboolean gst_l1l2_stab_motion_reader_check (GstL1L2StabMotionReader * in,
    const GstVideoInfo * info);

/* The motion from the frame at this stream time to the frame that was asked for before. Frames may be skipped, and the
 * stream may run backward. Frames with the same timestamp take the lines with that time in their order. FALSE: the file
 * has no line for the frame, and an error was posted. */
gboolean gst_l1l2_stab_motion_reader_next (GstL1L2StabMotionReader * in,
    GstClockTime stream_time, GstL1L2StabMotion * motion);

/* The frames that come next do not follow those before. */
void gst_l1l2_stab_motion_reader_flush (GstL1L2StabMotionReader * in);

/* --- the writer --- */

/* NULL: `element` has posted an error. */
GstL1L2StabMotionWriter *gst_l1l2_stab_motion_writer_open (GstElement * element,
    const gchar * name);

/* FALSE: the file is not complete, and an error was posted. */
gboolean gst_l1l2_stab_motion_writer_close (GstL1L2StabMotionWriter * out);

/* Tells the writer which frames come next. A file holds frames of one size: if the size changes, a warning is posted
 * and nothing more is written. */
void gst_l1l2_stab_motion_writer_begin (GstL1L2StabMotionWriter * out,
    const GstVideoInfo * info);

/* Writes the frame that goes out at this stream time. A frame that is earlier than the last line, because the stream
 * has gone back, is not written again. FALSE: an error was posted. */
gboolean gst_l1l2_stab_motion_writer_write (GstL1L2StabMotionWriter * out,
    GstClockTime stream_time, const L1L2StabInfo * info);

/* Empties the file. FALSE: an error was posted. */
gboolean gst_l1l2_stab_motion_writer_flush (GstL1L2StabMotionWriter * out);

G_END_DECLS

#endif
