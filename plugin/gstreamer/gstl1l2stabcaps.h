/* SPDX-License-Identifier: MIT */
/* What goes in and what comes out: the pad templates, and the caps of one side seen from the other. */
#ifndef GST_L1L2_STAB_CAPS_H
#define GST_L1L2_STAB_CAPS_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

/* Pixels, either side, of the input. */
#define GST_L1L2_STAB_MIN_SIZE 16
#define GST_L1L2_STAB_MAX_SIZE 16384

void gst_l1l2_stab_caps_add_templates (GstElementClass * klass);

/* The caps on the other side of `caps`, which are those of the pad in `direction`; `filter` may be NULL. */
GstCaps *gst_l1l2_stab_caps_transform (const L1L2StabConfig * settings,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter);

/* UNKNOWN for a format that is not taken. */
L1L2StabFormat gst_l1l2_stab_caps_format (GstVideoFormat format);

G_END_DECLS

#endif
