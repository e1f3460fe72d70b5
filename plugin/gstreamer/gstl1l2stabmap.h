/* SPDX-License-Identifier: MIT */
/* Maps between the pixels of an output frame and those of its source frame. The origin is the top left corner of the
 * frame, x points right and y down, as in metas and navigation events. Matrices are those of gstl1l2stabmatrix.h. */
#ifndef GST_L1L2_STAB_MAP_H
#define GST_L1L2_STAB_MAP_H

#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

typedef struct
{
  gdouble to_source[9];         /* from a point of the output to the point of the source that it shows */
  gdouble to_output[9];         /* its inverse */
} GstL1L2StabMap;

/* Sets up the maps of the frame that `info` describes. */
void gst_l1l2_stab_map_init (GstL1L2StabMap * map, const L1L2StabInfo * info,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info);

/* Replaces a box by the upright box around its image, rounded to the nearest pixel and clipped to width x height.
 * FALSE: the clipped box is empty. */
gboolean gst_l1l2_stab_map_box (const gdouble matrix[9], guint width,
    guint height, GstVideoRectangle * box);

G_END_DECLS

#endif
