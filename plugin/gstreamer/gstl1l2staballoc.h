/* SPDX-License-Identifier: MIT */
/* Allocation: which pools are offered and used, and when a frame is copied because upstream cannot spare a window of
 * buffers. */
#ifndef GST_L1L2_STAB_ALLOC_H
#define GST_L1L2_STAB_ALLOC_H

#include <gst/gst.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

/* Answers an allocation query of upstream: offers a pool without a limit, and GstVideoMeta. */
void gst_l1l2_stab_alloc_propose (GstQuery * query);

/* Completes the answer of downstream, so that there always is a pool for the output. */
void gst_l1l2_stab_alloc_decide (GstQuery * query);

/* True if the frame must be copied: upstream would run out of buffers if `window` of them were held, or the memory is
 * of a kind that must go back soon. */
gboolean gst_l1l2_stab_alloc_is_scarce (GstBuffer * buffer, guint window);

/* A new, active pool for copies; NULL if that fails. */
GstBufferPool *gst_l1l2_stab_alloc_own_pool (const GstVideoInfo * info);

/* Like gst_video_frame_map(), but fails if a plane reaches beyond its memory: GStreamer 1.22 believes the offsets and
 * strides of a video meta, and maps only the first memory of a plane that lies in two. */
gboolean gst_l1l2_stab_alloc_map (GstVideoFrame * frame,
    const GstVideoInfo * info, GstBuffer * buffer, GstMapFlags flags);

/* A copy of the pixels, without metadata, from `own_pool`; NULL if that fails. */
GstBuffer *gst_l1l2_stab_alloc_copy (GstBufferPool * own_pool,
    GstBuffer * buffer, const GstVideoInfo * info);

G_END_DECLS

#endif
