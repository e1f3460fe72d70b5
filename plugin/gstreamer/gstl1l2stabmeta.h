/* SPDX-License-Identifier: MIT */
/* A custom meta on each frame that goes out: which point of the source frame each point of its picture shows. Programs
 * need no header of ours: gst_buffer_get_custom_meta (buffer, "GstL1L2StabMeta") finds it in any language, and
 * gst_custom_meta_get_structure() has its fields; docs/control.md has them one by one. */
#ifndef GST_L1L2_STAB_META_H
#define GST_L1L2_STAB_META_H

#include <gst/video/video.h>

#include "gstl1l2stabmap.h"

G_BEGIN_DECLS

#define GST_L1L2_STAB_META_NAME "GstL1L2StabMeta"

/* Once, before the first frame. */
void gst_l1l2_stab_meta_register (void);

/* `frame`: its number since the element was started. */
void gst_l1l2_stab_meta_add (GstBuffer * output, guint64 frame,
    const GstL1L2StabMap * map, const GstVideoInfo * in_info,
    const GstVideoInfo * out_info);

/* Sets a field to a matrix: an array of nine doubles, row by row. */
void gst_l1l2_stab_meta_set_matrix (GstStructure * structure,
    const gchar * field, const gdouble matrix[9]);

G_END_DECLS

#endif
