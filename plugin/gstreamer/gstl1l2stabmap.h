/* SPDX-License-Identifier: MIT */
/* Where a point of the source is in the output, and back. Pixels, origin at the picture's top left corner, x right, y
 * down: as metas and navigation events count. Matrices are 3x3, row-major. */
#ifndef GST_L1L2_STAB_MAP_H
#define GST_L1L2_STAB_MAP_H

#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

typedef struct
{
  gdouble to_source[9];         /* output to source */
  gdouble to_output[9];         /* and its inverse */
} GstL1L2StabMap;

/* Of the frame that `info` describes. */
void gst_l1l2_stab_map_init (GstL1L2StabMap * map, const L1L2StabInfo * info,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info);

/* FALSE: beyond the horizon. */
gboolean gst_l1l2_stab_map_point (const gdouble matrix[9], gdouble * x,
    gdouble * y);

/* The upright box around a box, to the nearest pixel and within width x height. FALSE: nothing of it is. */
gboolean gst_l1l2_stab_map_box (const gdouble matrix[9], guint width,
    guint height, GstVideoRectangle * box);

G_END_DECLS

#endif
