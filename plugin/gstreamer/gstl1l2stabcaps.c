/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabcaps.h"

#include "gstl1l2stabformats.h"

#define FIRST_NAME(gst, ours) #gst
#define NEXT_NAME(gst, ours) ", " #gst
#define FORMATS "{ " GST_L1L2_STAB_FORMATS (FIRST_NAME, NEXT_NAME) " }"
#define SIDE_RANGE(least) \
    "(int) [ " G_STRINGIFY (least) ", " \
    G_STRINGIFY (GST_L1L2_STAB_MAX_SIZE) " ]"
#define RAW_VIDEO(least) \
    "video/x-raw, format = (string) " FORMATS \
    ", width = " SIDE_RANGE (least) ", height = " SIDE_RANGE (least) \
    ", framerate = " GST_VIDEO_FPS_RANGE

/* Caps without interlace-mode and multiview-mode are progressive and mono. They intersect with these. */
static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (RAW_VIDEO (GST_L1L2_STAB_MIN_SIZE)
        ", interlace-mode = (string) progressive"
        ", multiview-mode = (string) mono"));

/* The output can be smaller than the smallest input. The two fields are left out, so that they are not added to caps
 * that came without them. */
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (RAW_VIDEO (1)));

void
gst_l1l2_stab_caps_add_templates (GstElementClass * klass)
{
  gst_element_class_add_static_pad_template (klass, &sink_template);
  gst_element_class_add_static_pad_template (klass, &src_template);
}

static void
set_size_range (GstStructure * structure, gint least)
{
  gst_structure_set (structure,
      "width", GST_TYPE_INT_RANGE, least, GST_L1L2_STAB_MAX_SIZE,
      "height", GST_TYPE_INT_RANGE, least, GST_L1L2_STAB_MAX_SIZE, NULL);
}

/* The size of the output follows from that of the input, but not the other way round: several input sizes are rounded
 * to the same output size. */
static void
transform_size (GstStructure * structure, const L1L2StabConfig * settings,
    GstPadDirection direction)
{
  L1L2StabConfig config = *settings;
  gint width, height;

  if (direction == GST_PAD_SRC) {
    set_size_range (structure, GST_L1L2_STAB_MIN_SIZE);
    return;
  }
  config.format = L1L2STAB_FORMAT_GRAY8;        /* the size does not depend on it */
  if (gst_structure_get_int (structure, "width", &config.width)
      && gst_structure_get_int (structure, "height", &config.height)
      && l1l2stab_config_output_size (&config, &width, &height) == L1L2STAB_OK)
    gst_structure_set (structure, "width", G_TYPE_INT, width,
        "height", G_TYPE_INT, height, NULL);
  else
    set_size_range (structure, 1);
}

/* A demuxer that does not know the frame rate may put the clock's rate into the caps, such as 90000/1. */
static gboolean
is_no_frame_rate (const GValue * rate)
{
  return rate && GST_VALUE_HOLDS_FRACTION (rate)
      && gst_util_fraction_compare (gst_value_get_fraction_numerator (rate),
      gst_value_get_fraction_denominator (rate),
      GST_L1L2_STAB_MAX_FRAME_RATE, 1) > 0;
}

static gboolean
may_be_variable (const GValue * rate)
{
  GValue variable = G_VALUE_INIT;
  gboolean may;

  g_value_init (&variable, GST_TYPE_FRACTION);
  gst_value_set_fraction (&variable, 0, 1);
  may = rate && gst_value_intersect (NULL, &variable, rate);
  g_value_unset (&variable);
  return may;
}

/* Such a rate goes out as 0/1, a variable one: an encoder that took it for true would keep next to nothing of each
 * frame. The frames have their own times. So where a variable rate goes out, such a rate may come in. */
static GstCaps *
transform_rate (GstCaps * caps, GstPadDirection direction)
{
  guint i, n = gst_caps_get_size (caps);

  for (i = 0; i < n; i++) {
    GstStructure *structure = gst_caps_get_structure (caps, i);
    const GValue *rate = gst_structure_get_value (structure, "framerate");

    if (direction == GST_PAD_SINK && is_no_frame_rate (rate)) {
      caps = gst_caps_make_writable (caps);
      gst_structure_set (gst_caps_get_structure (caps, i),
          "framerate", GST_TYPE_FRACTION, 0, 1, NULL);
    } else if (direction == GST_PAD_SRC && may_be_variable (rate)) {
      structure = gst_structure_copy (structure);
      gst_structure_set (structure, "framerate", GST_TYPE_FRACTION_RANGE,
          GST_L1L2_STAB_MAX_FRAME_RATE, 1, G_MAXINT, 1, NULL);
      caps = gst_caps_make_writable (caps);
      gst_caps_append_structure_full (caps, structure, gst_caps_features_copy
          (gst_caps_get_features (caps, i)));
    }
  }
  return caps;
}

GstCaps *
gst_l1l2_stab_caps_transform (const L1L2StabConfig * settings,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter)
{
  GstCaps *other, *filtered;
  guint i;

  if (settings->output_size == L1L2STAB_OUTPUT_SIZE_CROP) {
    other = gst_caps_copy (caps);
    for (i = 0; i < gst_caps_get_size (other); i++)
      transform_size (gst_caps_get_structure (other, i), settings, direction);
  } else {
    other = gst_caps_ref (caps);
  }
  other = transform_rate (other, direction);

  if (!filter)
    return other;
  filtered = gst_caps_intersect_full (filter, other, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref (other);
  return filtered;
}

L1L2StabFormat
gst_l1l2_stab_caps_format (GstVideoFormat format)
{
  switch (format) {
#define CASE(gst, ours) \
    case GST_VIDEO_FORMAT_##gst: \
      return L1L2STAB_FORMAT_##ours;
      GST_L1L2_STAB_FORMATS (CASE, CASE)
#undef CASE
    default:
      return L1L2STAB_FORMAT_UNKNOWN;
  }
}
