/* SPDX-License-Identifier: MIT */
/* Conversions between GStreamer and the library: caps to a config, frames to planes, results to flow returns, log
 * messages to the debug category, and arithmetic on times. */
#ifndef GST_L1L2_STAB_CONVERT_H
#define GST_L1L2_STAB_CONVERT_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

GST_DEBUG_CATEGORY_EXTERN (gst_l1l2_stab_debug);

/* Receives the messages of an L1L2StabLogger. It must outlive the instance that logs to it. */
typedef struct
{
  GstObject *object;            /* origin of the messages; not owned */
  gchar *reason;                /* the first message of level L1L2STAB_LOG_ERROR, or NULL */
} GstL1L2StabLog;

/* Sends the library's messages to the debug category, with the category's present threshold, and keeps the reason of
 * a failure. The reason of an earlier failure is cleared. */
void gst_l1l2_stab_convert_logger (L1L2StabLogger * logger, GstL1L2StabLog * log);

/* Like gst_video_info_from_caps(), but the chroma site is the one in the caps, or UNKNOWN. GStreamer 1.22 guesses a
 * chroma site when the caps have no colorimetry. */
gboolean gst_l1l2_stab_convert_caps (GstVideoInfo * info,
    const GstCaps * caps);

/* Fills in format, size, frame rate and chroma site, and nothing else. */
void gst_l1l2_stab_convert_config (L1L2StabConfig * config,
    const GstVideoInfo * info);

/* The stream time of a timestamp; NONE: the segment has none for it. */
GstClockTime gst_l1l2_stab_convert_stream_time (const GstSegment * segment,
    GstClockTime timestamp);

/* The sum of two valid times, at most the largest valid time. */
GstClockTime gst_l1l2_stab_convert_add_times (GstClockTime a, GstClockTime b);

/* |a - b| of two valid times. Unlike GST_CLOCK_DIFF() it does not overflow. */
GstClockTime gst_l1l2_stab_convert_time_distance (GstClockTime a,
    GstClockTime b);

/* Sets the plane pointers and strides to those of a mapped frame. */
void gst_l1l2_stab_convert_planes (L1L2StabFrame * frame,
    const GstVideoFrame * video);

/* GST_FLOW_OK for a flow state of the library. An error is posted as a message of `element`, with the reason that was
 * logged, and gives GST_FLOW_ERROR. */
GstFlowReturn gst_l1l2_stab_convert_result (GstElement * element,
    L1L2StabResult result, const GstL1L2StabLog * log);

G_END_DECLS

#endif
