/* SPDX-License-Identifier: MIT */
/* GLib types for the enumerations of the library that properties use, with the names that a user types. */
#ifndef GST_L1L2_STAB_ENUMS_H
#define GST_L1L2_STAB_ENUMS_H

#include <glib-object.h>

G_BEGIN_DECLS

#define GST_TYPE_L1L2_STAB_JOIN (gst_l1l2_stab_join_get_type ())
GType gst_l1l2_stab_join_get_type (void);

#define GST_TYPE_L1L2_STAB_INTERPOLATION \
  (gst_l1l2_stab_interpolation_get_type ())
GType gst_l1l2_stab_interpolation_get_type (void);

#define GST_TYPE_L1L2_STAB_OUTPUT_SIZE (gst_l1l2_stab_output_size_get_type ())
GType gst_l1l2_stab_output_size_get_type (void);

#define GST_TYPE_L1L2_STAB_BORDER (gst_l1l2_stab_border_get_type ())
GType gst_l1l2_stab_border_get_type (void);

#define GST_TYPE_L1L2_STAB_MOTION_MODEL (gst_l1l2_stab_motion_model_get_type ())
GType gst_l1l2_stab_motion_model_get_type (void);

#define GST_TYPE_L1L2_STAB_ROLLING_SHUTTER \
  (gst_l1l2_stab_rolling_shutter_get_type ())
GType gst_l1l2_stab_rolling_shutter_get_type (void);

G_END_DECLS

#endif
