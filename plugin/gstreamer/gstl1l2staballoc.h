/* SPDX-License-Identifier: MIT */
/* Where buffers come from, when a window of them is held back. Upstream is offered a pool without a limit; whoever has
 * one with a limit keeps its own and is copied. */
#ifndef GST_L1L2_STAB_ALLOC_H
#define GST_L1L2_STAB_ALLOC_H

#include <gst/gst.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

/* Answers upstream's query: a pool that grows as it is needed, and GstVideoMeta. */
void gst_l1l2_stab_alloc_propose (GstQuery * query);

/* Completes downstream's answer, so that there is a pool in any case. */
void gst_l1l2_stab_alloc_decide (GstQuery * query);

/* Would holding `window` of its like starve upstream, or is it memory of a kind that is not to be held? */
gboolean gst_l1l2_stab_alloc_is_scarce (GstBuffer * buffer, guint window);

/* An active pool of frames of our own; NULL when that fails. */
GstBufferPool *gst_l1l2_stab_alloc_own_pool (const GstVideoInfo * info);

/* A copy from `own_pool`, the pixels alone; NULL when that fails. */
GstBuffer *gst_l1l2_stab_alloc_copy (GstBufferPool * own_pool,
    GstBuffer * buffer, const GstVideoInfo * info);

G_END_DECLS

#endif
