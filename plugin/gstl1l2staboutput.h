/* SPDX-License-Identifier: MIT */
/* How frames and events leave: what is ready in the normal flow, all at once before something that they must precede.
 * The base class pushes nothing itself: it knows only the first way, and marks a wrong frame when a discontinuity comes
 * in while others are held. */
#ifndef GST_L1L2_STAB_OUTPUT_H
#define GST_L1L2_STAB_OUTPUT_H

#include <gst/base/gstbasetransform.h>

#include "gstl1l2stabstream.h"

G_BEGIN_DECLS

/* Pushes the frames that are ready, and the events whose turn it is. */
GstFlowReturn gst_l1l2_stab_output_push_ready (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

/* Pushes all that is held, frames and events, up to the first flow return that is not OK; what is left of the frames
 * is dropped. The stream is as new. */
GstFlowReturn gst_l1l2_stab_output_drain (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

/* Drops all that is held, but keeps sticky events on the pad: they outlive a flush. */
void gst_l1l2_stab_output_flush (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

/* The position of the frames that went out means nothing in the segment that comes. */
void gst_l1l2_stab_output_new_segment (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

/* Where playback is after the last frame that went out: the frames that are held are not played yet. FALSE: none did
 * in this segment. */
gboolean gst_l1l2_stab_output_query_position (GstBaseTransform * trans,
    GstL1L2StabStream * stream, GstQuery * query);

G_END_DECLS

#endif
