/* SPDX-License-Identifier: MIT */
/* Negotiation: the pad templates, and the caps of one pad that follow from those of the other. */
#ifndef GST_L1L2_STAB_CAPS_H
#define GST_L1L2_STAB_CAPS_H

#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

/* Smallest and largest width and height of the input, pixels. */
#define GST_L1L2_STAB_MIN_SIZE 16
#define GST_L1L2_STAB_MAX_SIZE 16384

/* The highest frame rate that the library accepts. A higher one in the caps is a clock's rate, such as 90000/1, from a
 * demuxer that does not know the frame rate. It is taken as a variable rate. */
#define GST_L1L2_STAB_MAX_FRAME_RATE 1000

void gst_l1l2_stab_caps_add_templates (GstElementClass * klass);

/* The caps of the other pad, if `caps` are those of the pad of this direction. `filter` may be NULL. */
GstCaps *gst_l1l2_stab_caps_transform (const L1L2StabConfig * settings,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter);

/* The library's name of a format; L1L2STAB_FORMAT_UNKNOWN if it is not accepted. */
L1L2StabFormat gst_l1l2_stab_caps_format (GstVideoFormat format);

G_END_DECLS

#endif
