/* SPDX-License-Identifier: MIT */
/* Which metas of an input frame are copied to its output frame, and how regions of interest follow the picture. */
#ifndef GST_L1L2_STAB_COPY_META_H
#define GST_L1L2_STAB_COPY_META_H

#include <gst/gst.h>
#include <gst/video/video.h>

#include "gstl1l2stabmap.h"

G_BEGIN_DECLS

/* True if this meta is copied. */
gboolean gst_l1l2_stab_copy_meta_keeps (const GstMeta * meta);

/* Maps the regions of interest that were copied from the source frame to the output frame. Regions that are outside the
 * picture are removed. */
void gst_l1l2_stab_copy_meta_map_regions (GstBuffer * output,
    const GstL1L2StabMap * map, const GstVideoInfo * out_info);

G_END_DECLS

#endif
