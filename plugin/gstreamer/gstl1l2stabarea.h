/* SPDX-License-Identifier: MIT */
/* What is measured: the properties region and mask, from their texts to the config of the library. They are read when
 * the element starts; pixels become parts of the frame when its size is known. */
#ifndef GST_L1L2_STAB_AREA_H
#define GST_L1L2_STAB_AREA_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

#include "gstl1l2stabpgm.h"

G_BEGIN_DECLS

typedef struct
{
  gchar *region_text;           /* as the user wrote it; NULL: the whole frame */
  gdouble region[4];            /* x, y, width, height: pixels, or ... */
  gboolean is_percent[4];       /* ... hundredths of the frame's side */
  GstL1L2StabPgm mask;          /* without pixels: there is none */
} GstL1L2StabArea;

/* Parses the text of `region` and reads the file `mask`. Each may be NULL. FALSE: `element` has posted an error. */
gboolean gst_l1l2_stab_area_open (GstL1L2StabArea * area, GstElement * element,
    const gchar * region, const gchar * mask);
void gst_l1l2_stab_area_close (GstL1L2StabArea * area);

/* Sets region and mask of a config for these frames. The mask belongs to the area. FALSE: the region does not fit the
 * frames, and `element` has posted an error. */
gboolean gst_l1l2_stab_area_apply (const GstL1L2StabArea * area,
    GstElement * element, const GstVideoInfo * info, L1L2StabConfig * config);

G_END_DECLS

#endif
