/* SPDX-License-Identifier: MIT */
/* Translation between GStreamer's terms and the library's: caps, frames, results, log messages. No state of its own
 * but the reason of the last failure. */
#ifndef GST_L1L2_STAB_GLUE_H
#define GST_L1L2_STAB_GLUE_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

GST_DEBUG_CATEGORY_EXTERN (gst_l1l2_stab_debug);

/* The other end of an L1L2StabLogger. It lives at least as long as the instance that logs to it. */
typedef struct
{
  GstObject *object;            /* the messages' origin; not owned */
  gchar *reason;                /* the first message of L1L2STAB_LOG_ERROR, or NULL */
} GstL1L2StabLog;

/* Sends the library's messages to the debug category, at its threshold of now, and keeps the reason of a failure. An
 * earlier one is forgotten. */
void gst_l1l2_stab_glue_logger (L1L2StabLogger * logger, GstL1L2StabLog * log);

/* As gst_video_info_from_caps(), but the chroma site is what the caps say, or UNKNOWN: 1.22 puts a guess in its place
 * when the caps have no colorimetry. */
gboolean gst_l1l2_stab_glue_parse_caps (GstVideoInfo * info,
    const GstCaps * caps);

/* Fills format, size, frame rate and chroma site, and nothing else. */
void gst_l1l2_stab_glue_config (L1L2StabConfig * config,
    const GstVideoInfo * info);

/* Where the frame is in the stream, by its segment; NONE where that is not told. */
GstClockTime gst_l1l2_stab_glue_stream_time (const GstSegment * segment,
    GstBuffer * frame);

/* The planes of a mapped frame. */
void gst_l1l2_stab_glue_planes (L1L2StabFrame * frame,
    const GstVideoFrame * video);

/* A flow state is GST_FLOW_OK. An error is posted by `element`, with the reason that was logged, and is
 * GST_FLOW_ERROR. */
GstFlowReturn gst_l1l2_stab_glue_flow (GstElement * element,
    L1L2StabResult result, const GstL1L2StabLog * log);

G_END_DECLS

#endif
