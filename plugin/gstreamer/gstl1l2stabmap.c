/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabmap.h"

#include <math.h>

#include "gstl1l2stabmatrix.h"

void
gst_l1l2_stab_map_init (GstL1L2StabMap * map, const L1L2StabInfo * info,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info)
{
  const gdouble to_center[9] = {
    1, 0, -0.5 * GST_VIDEO_INFO_WIDTH (out_info),
    0, 1, -0.5 * GST_VIDEO_INFO_HEIGHT (out_info), 0, 0, 1
  };
  const gdouble from_center[9] = {
    1, 0, 0.5 * GST_VIDEO_INFO_WIDTH (in_info),
    0, 1, 0.5 * GST_VIDEO_INFO_HEIGHT (in_info), 0, 0, 1
  };
  gdouble centered[9];

  gst_l1l2_stab_matrix_multiply (info->warp, to_center, centered);
  gst_l1l2_stab_matrix_multiply (from_center, centered, map->to_source);
  gst_l1l2_stab_matrix_invert (map->to_source, map->to_output);
}

gboolean
gst_l1l2_stab_map_box (const gdouble matrix[9], guint width, guint height,
    GstVideoRectangle * box)
{
  gdouble left = width, right = 0, top = height, bottom = 0;
  guint i;

  for (i = 0; i < 4; i++) {
    gdouble x = box->x + (i & 1 ? box->w : 0);
    gdouble y = box->y + (i & 2 ? box->h : 0);

    if (!gst_l1l2_stab_matrix_map_point (matrix, &x, &y))
      return FALSE;
    left = MIN (left, x);
    right = MAX (right, x);
    top = MIN (top, y);
    bottom = MAX (bottom, y);
  }
  box->x = rint (MAX (left, 0));
  box->y = rint (MAX (top, 0));
  box->w = rint (MIN (right, width)) - box->x;
  box->h = rint (MIN (bottom, height)) - box->y;
  return box->w > 0 && box->h > 0;
}
