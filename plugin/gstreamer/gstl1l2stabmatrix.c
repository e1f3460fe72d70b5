/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabmatrix.h"

#include <string.h>

/* The smallest denominator of a point in front of the camera. */
#define HORIZON 1e-6

void
gst_l1l2_stab_matrix_multiply (const gdouble a[9], const gdouble b[9],
    gdouble out[9])
{
  gdouble product[9];
  guint row, column;

  for (row = 0; row < 3; row++) {
    for (column = 0; column < 3; column++)
      product[3 * row + column] = a[3 * row] * b[column]
          + a[3 * row + 1] * b[3 + column] + a[3 * row + 2] * b[6 + column];
  }
  memcpy (out, product, sizeof (product));
}

/* By cofactors. They are divided by the last one, so the determinant cancels. */
void
gst_l1l2_stab_matrix_invert (const gdouble m[9], gdouble out[9])
{
  const gdouble scale = m[0] * m[4] - m[1] * m[3];

  out[0] = (m[4] * m[8] - m[5] * m[7]) / scale;
  out[1] = (m[2] * m[7] - m[1] * m[8]) / scale;
  out[2] = (m[1] * m[5] - m[2] * m[4]) / scale;
  out[3] = (m[5] * m[6] - m[3] * m[8]) / scale;
  out[4] = (m[0] * m[8] - m[2] * m[6]) / scale;
  out[5] = (m[2] * m[3] - m[0] * m[5]) / scale;
  out[6] = (m[3] * m[7] - m[4] * m[6]) / scale;
  out[7] = (m[1] * m[6] - m[0] * m[7]) / scale;
  out[8] = 1;
}

gboolean
gst_l1l2_stab_matrix_map_point (const gdouble m[9], gdouble * x, gdouble * y)
{
  const gdouble w = m[6] * *x + m[7] * *y + m[8];
  const gdouble u = m[0] * *x + m[1] * *y + m[2];
  const gdouble v = m[3] * *x + m[4] * *y + m[5];

  if (w < HORIZON)
    return FALSE;
  *x = u / w;
  *y = v / w;
  return TRUE;
}
