/* SPDX-License-Identifier: MIT */
/* The element "l1l2stab": a GstBaseTransform that delays the video by a window of frames. */
#ifndef GST_L1L2_STAB_H
#define GST_L1L2_STAB_H

#include <gst/base/gstbasetransform.h>
#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_L1L2_STAB (gst_l1l2_stab_get_type ())
G_DECLARE_FINAL_TYPE (GstL1L2Stab, gst_l1l2_stab, GST, L1L2_STAB,
    GstBaseTransform)

GST_ELEMENT_REGISTER_DECLARE (l1l2stab);

G_END_DECLS

#endif
