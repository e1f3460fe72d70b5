/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabenums.h"

#include <l1l2stab/l1l2stab.h>

GType
gst_l1l2_stab_join_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_JOIN_CONTINUOUS,
          "The next window goes on from the frames already given out",
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
    {L1L2STAB_INTERPOLATION_BILINEAR, "2x2 pixels: fast and soft", "bilinear"},
    {L1L2STAB_INTERPOLATION_BICUBIC, "4x4 pixels", "bicubic"},
    {L1L2STAB_INTERPOLATION_LANCZOS, "6x6 pixels: sharp and slow", "lanczos"},
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
        "As the input: the crop window is zoomed to fill it", "input"},
    {L1L2STAB_OUTPUT_SIZE_CROP,
        "The crop window's own size, in even numbers: no zoom", "crop"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabOutputSize", values));
  return type;
}

GType
gst_l1l2_stab_motion_model_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {L1L2STAB_MOTION_MODEL_TRANSLATION, "The camera moves the picture",
        "translation"},
    {L1L2STAB_MOTION_MODEL_SIMILARITY, "It moves, turns and zooms it",
        "similarity"},
    {L1L2STAB_MOTION_MODEL_AFFINE, "It also shears it", "affine"},
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
    {L1L2STAB_ROLLING_SHUTTER_NONE, "Nothing is done about it", "none"},
    {L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY,
        "One homography for each frame: the wobble between frames",
        "homography"},
    {L1L2STAB_ROLLING_SHUTTER_MIXTURE,
        "A homography for each row: the skew within a frame, too", "mixture"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstL1L2StabRollingShutter", values));
  return type;
}
