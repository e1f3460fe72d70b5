/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabenums.h"

#include <l1l2stab/l1l2stab.h>

GType
gst_l1l2_stab_join_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_JOIN_CONTINUOUS,
          "The next window continues the path that was already emitted",
        "continuous"},
    {L1L2STAB_JOIN_BLEND,
        "The paths of two windows are averaged where they overlap", "blend"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type, g_enum_register_static ("GstL1L2StabJoin",
            values));
  return type;
}

GType
gst_l1l2_stab_interpolation_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_INTERPOLATION_BILINEAR, "Over 2x2 pixels: fastest, softest", "bilinear"},
    {L1L2STAB_INTERPOLATION_BICUBIC, "Over 4x4 pixels", "bicubic"},
    {L1L2STAB_INTERPOLATION_LANCZOS, "Over 6x6 pixels: sharpest, slowest", "lanczos"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabInterpolation", values));
  return type;
}

GType
gst_l1l2_stab_output_size_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_OUTPUT_SIZE_INPUT,
        "The size of the input: the crop window is enlarged to fill it", "input"},
    {L1L2STAB_OUTPUT_SIZE_CROP,
        "The size of the crop window, rounded to even numbers", "crop"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabOutputSize", values));
  return type;
}

GType
gst_l1l2_stab_border_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_BORDER_CROP,
        "Nothing: the crop window is shown, enlarged to the output's size", "crop"},
    {L1L2STAB_BORDER_FILL,
          "What the frames before and after show there; the rest is extended",
        "fill"},
    {L1L2STAB_BORDER_EXTEND, "The frame is mirrored at its sides and softened",
        "extend"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabBorder", values));
  return type;
}

GType
gst_l1l2_stab_motion_model_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_MOTION_MODEL_TRANSLATION, "The picture moves",
        "translation"},
    {L1L2STAB_MOTION_MODEL_SIMILARITY, "The picture moves, rotates and changes its scale",
        "similarity"},
    {L1L2STAB_MOTION_MODEL_AFFINE, "As similarity, and the picture is sheared", "affine"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabMotionModel", values));
  return type;
}

GType
gst_l1l2_stab_rolling_shutter_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_ROLLING_SHUTTER_NONE, "No correction", "none"},
    {L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY,
        "One homography per frame: corrects wobble between frames",
        "homography"},
    {L1L2STAB_ROLLING_SHUTTER_MIXTURE,
        "One homography per row: also corrects skew within a frame", "mixture"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabRollingShutter", values));
  return type;
}
