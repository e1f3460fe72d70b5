/* SPDX-License-Identifier: MIT */
/* How frames and events leave: one by one in the normal flow, all at once before something that they must precede.
 * The base class knows only the first way. */
#ifndef GST_L1L2_STAB_OUTPUT_H
#define GST_L1L2_STAB_OUTPUT_H

#include <gst/base/gstbasetransform.h>

#include "gstl1l2stabstream.h"

G_BEGIN_DECLS

/* The next frame that is ready, rendered; NULL: none. The events that come before it are pushed. */
GstFlowReturn gst_l1l2_stab_output_next (GstBaseTransform * trans,
    GstL1L2StabStream * stream, GstBuffer ** output);

/* Pushes the frames that are ready. */
GstFlowReturn gst_l1l2_stab_output_push_ready (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

/* Pushes all that is held, frames and events, up to the first flow return that is not OK; what is left of the frames
 * is dropped. The stream is as new. */
GstFlowReturn gst_l1l2_stab_output_drain (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

/* Drops all that is held, but keeps sticky events on the pad: they outlive a flush. */
void gst_l1l2_stab_output_flush (GstBaseTransform * trans,
    GstL1L2StabStream * stream);

G_END_DECLS

#endif
