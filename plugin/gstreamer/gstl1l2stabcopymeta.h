/* SPDX-License-Identifier: MIT */
/* Which of a frame's metas go with it into the output. What is bound to a place in the picture moves with it. */
#ifndef GST_L1L2_STAB_COPY_META_H
#define GST_L1L2_STAB_COPY_META_H

#include <gst/gst.h>
#include <gst/video/video.h>

#include "gstl1l2stabmap.h"

G_BEGIN_DECLS

/* Is this meta to be copied? */
gboolean gst_l1l2_stab_copy_meta_keeps (const GstMeta * meta);

/* Regions of interest, copied from the source, become the boxes around what they enclosed; those that are out of the
 * picture go. */
void gst_l1l2_stab_copy_meta_map_regions (GstBuffer * output,
    const GstL1L2StabMap * map, const GstVideoInfo * out_info);

G_END_DECLS

#endif
