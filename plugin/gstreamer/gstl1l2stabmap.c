/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabmap.h"

#include <math.h>

/* The least denominator of a point that is in front of the camera. */
#define HORIZON 1e-6

static void
multiply (const gdouble a[9], const gdouble b[9], gdouble out[9])
{
  guint row, column;

  for (row = 0; row < 3; row++) {
    for (column = 0; column < 3; column++)
      out[3 * row + column] = a[3 * row] * b[column]
          + a[3 * row + 1] * b[3 + column] + a[3 * row + 2] * b[6 + column];
  }
}

/* By cofactors, up to a factor, which a point's denominator takes out. The warp is near the identity and can always be
 * inverted. */
static void
invert (const gdouble m[9], gdouble out[9])
{
  out[0] = m[4] * m[8] - m[5] * m[7];
  out[1] = m[2] * m[7] - m[1] * m[8];
  out[2] = m[1] * m[5] - m[2] * m[4];
  out[3] = m[5] * m[6] - m[3] * m[8];
  out[4] = m[0] * m[8] - m[2] * m[6];
  out[5] = m[2] * m[3] - m[0] * m[5];
  out[6] = m[3] * m[7] - m[4] * m[6];
  out[7] = m[1] * m[6] - m[0] * m[7];
  out[8] = m[0] * m[4] - m[1] * m[3];
}

void
gst_l1l2_stab_map_init (GstL1L2StabMap * map, const L1L2StabInfo * info,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info)
{
  const gdouble to_centre[9] = {
    1, 0, -0.5 * GST_VIDEO_INFO_WIDTH (out_info),
    0, 1, -0.5 * GST_VIDEO_INFO_HEIGHT (out_info), 0, 0, 1
  };
  const gdouble from_centre[9] = {
    1, 0, 0.5 * GST_VIDEO_INFO_WIDTH (in_info),
    0, 1, 0.5 * GST_VIDEO_INFO_HEIGHT (in_info), 0, 0, 1
  };
  gdouble centred[9], scale;
  guint i;

  multiply (info->warp, to_centre, centred);
  multiply (from_centre, centred, map->to_source);
  invert (map->to_source, map->to_output);
  scale = map->to_output[8];
  for (i = 0; i < 9; i++)
    map->to_output[i] /= scale;
}

gboolean
gst_l1l2_stab_map_point (const gdouble matrix[9], gdouble * x, gdouble * y)
{
  const gdouble w = matrix[6] * *x + matrix[7] * *y + matrix[8];
  const gdouble u = matrix[0] * *x + matrix[1] * *y + matrix[2];
  const gdouble v = matrix[3] * *x + matrix[4] * *y + matrix[5];

  if (w < HORIZON)
    return FALSE;
  *x = u / w;
  *y = v / w;
  return TRUE;
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

    if (!gst_l1l2_stab_map_point (matrix, &x, &y))
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
