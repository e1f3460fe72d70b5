/* SPDX-License-Identifier: MIT */
/* The custom meta "GstL1L2StabMeta" of each output frame: which point of the source frame each point of the picture
 * shows. Programs read it in any language, without a header, by gst_buffer_get_custom_meta() and
 * gst_custom_meta_get_structure(). docs/control.md lists its fields. */
#ifndef GST_L1L2_STAB_META_H
#define GST_L1L2_STAB_META_H

#include <gst/video/video.h>

#include "gstl1l2stabmap.h"

G_BEGIN_DECLS

#define GST_L1L2_STAB_META_NAME "GstL1L2StabMeta"

/* Registers the meta. To be called before the first frame. */
void gst_l1l2_stab_meta_register (void);

/* Adds the meta to an output frame. `frame`: the number of the frame since the element was started. */
void gst_l1l2_stab_meta_add (GstBuffer * output, guint64 frame,
    const GstL1L2StabMap * map, const GstVideoInfo * in_info,
    const GstVideoInfo * out_info);

/* Adds who gave each pixel to the meta of an output frame, which must be there: one byte a pixel, row by row. */
void gst_l1l2_stab_meta_set_border_map (GstBuffer * output,
    GstBuffer * border_map);

/* Sets a field to a matrix, as an array of nine doubles, row by row. */
void gst_l1l2_stab_meta_set_matrix (GstStructure * structure,
    const gchar * field, const gdouble matrix[9]);

G_END_DECLS

#endif
