/* SPDX-License-Identifier: MIT */
/* The motion of the frames as a text file, written by one run and read by another: docs/motion-file.md. */
#ifndef GST_L1L2_STAB_MOTION_H
#define GST_L1L2_STAB_MOTION_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

#define GST_L1L2_STAB_MOTION_MAGIC "l1l2stab-motion 1"

/* A line of the file. */
typedef struct
{
  GstClockTime time;            /* stream time; NONE: frames come in the order of the lines */
  gboolean starts_path;
  L1L2StabMotionSource model;
  gdouble quality;
  gint tracks, inliers;
  gdouble F[9];                 /* this frame to the one before it; pixels, origin at the centre */
} GstL1L2StabMotion;

typedef struct _GstL1L2StabMotionIn GstL1L2StabMotionIn;
typedef struct _GstL1L2StabMotionOut GstL1L2StabMotionOut;

typedef struct
{
  GstL1L2StabMotionIn *in;      /* NULL: motions are measured */
  GstL1L2StabMotionOut *out;    /* NULL: they are not written */
} GstL1L2StabMotionFiles;

/* Opens the files of these names, each of which may be NULL. FALSE: an error was posted by `element`. */
gboolean gst_l1l2_stab_motion_open (GstL1L2StabMotionFiles * files,
    GstElement * element, const gchar * in, const gchar * out);
void gst_l1l2_stab_motion_close (GstL1L2StabMotionFiles * files);

/* Frames like these are to come. FALSE: the file is of others, and an error was posted. */
gboolean gst_l1l2_stab_motion_begin (GstL1L2StabMotionFiles * files,
    const GstVideoInfo * info);

/* The stream goes on elsewhere: nothing is left of what was before. */
void gst_l1l2_stab_motion_flush (GstL1L2StabMotionFiles * files);

/* Gives the frame that goes in at this stream time its motion, if there is a file; it points into *motion. FALSE: an
 * error was posted. */
gboolean gst_l1l2_stab_motion_read (GstL1L2StabMotionFiles * files,
    GstClockTime time, GstL1L2StabMotion * motion, L1L2StabFrame * frame);

/* Writes the frame that goes out at this stream time, if there is a file. What is known of a motion that was read goes
 * into *info. FALSE: an error was posted. */
gboolean gst_l1l2_stab_motion_write (GstL1L2StabMotionFiles * files,
    GstClockTime time, const GstL1L2StabMotion * motion, L1L2StabInfo * info);

/* --- each by itself --- */

/* NULL: an error was posted by `element`. */
GstL1L2StabMotionIn *gst_l1l2_stab_motion_in_open (GstElement * element,
    const gchar * name);
void gst_l1l2_stab_motion_in_close (GstL1L2StabMotionIn * in);

/* Frames like these are to come. FALSE: the file is of others, and an error was posted. */
gboolean gst_l1l2_stab_motion_in_check (GstL1L2StabMotionIn * in,
    const GstVideoInfo * info);

/* The motion of the frame at this stream time, from the frame that was asked for last: over frames that were left out,
 * too, and backward. FALSE: the file has none, and an error was posted. */
gboolean gst_l1l2_stab_motion_in_next (GstL1L2StabMotionIn * in,
    GstClockTime stream_time, GstL1L2StabMotion * motion);

/* The frames that come next are not those that follow. */
void gst_l1l2_stab_motion_in_flush (GstL1L2StabMotionIn * in);

/* NULL: an error was posted by `element`. */
GstL1L2StabMotionOut *gst_l1l2_stab_motion_out_open (GstElement * element,
    const gchar * name);

/* FALSE: an error was posted: the file is not complete. */
gboolean gst_l1l2_stab_motion_out_close (GstL1L2StabMotionOut * out);

/* Frames like these are to come. A file is of one size: from a second one on nothing is written, with a warning. */
void gst_l1l2_stab_motion_out_begin (GstL1L2StabMotionOut * out,
    const GstVideoInfo * info);

/* The frame that goes out at this stream time. One that is not later than the one before it is not written. FALSE: an
 * error was posted. */
gboolean gst_l1l2_stab_motion_out_write (GstL1L2StabMotionOut * out,
    GstClockTime stream_time, const L1L2StabInfo * info);

/* All that went out before is not part of what comes: the file begins anew. */
gboolean gst_l1l2_stab_motion_out_flush (GstL1L2StabMotionOut * out);

G_END_DECLS

#endif
