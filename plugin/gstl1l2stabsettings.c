/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabsettings.h"

enum
{
  PROP_0,
  PROP_LAMBDA,
  PROP_WINDOW,
  PROP_OVERLAP,
  PROP_CROP_RATIO,
  PROP_JOIN,
  PROP_INTERPOLATION,
  PROP_OUTPUT_SIZE,
  PROP_THREADS,
};

/* A change while the stream runs waits for the next caps: hence READY. */
#define SETTING_FLAGS \
  (G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_READY)

/* Each frame samples these. */
#define LIVE_FLAGS \
  (G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_CONTROLLABLE \
      | GST_PARAM_MUTABLE_PLAYING)

#define GST_TYPE_L1L2_STAB_JOIN (gst_l1l2_stab_join_get_type ())
static GType
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

#define GST_TYPE_L1L2_STAB_INTERPOLATION \
  (gst_l1l2_stab_interpolation_get_type ())
static GType
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

#define GST_TYPE_L1L2_STAB_OUTPUT_SIZE (gst_l1l2_stab_output_size_get_type ())
static GType
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

static void
install_enums (GObjectClass * klass, const L1L2StabConfig * defaults)
{
  g_object_class_install_property (klass, PROP_JOIN,
      g_param_spec_enum ("join", "Join",
          "How the paths of two windows are joined; blend needs an overlap of "
          "at most half the window", GST_TYPE_L1L2_STAB_JOIN, defaults->join,
          SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_INTERPOLATION,
      g_param_spec_enum ("interpolation", "Interpolation",
          "How pixels are interpolated: sharpness against time",
          GST_TYPE_L1L2_STAB_INTERPOLATION, defaults->interpolation,
          SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_OUTPUT_SIZE,
      g_param_spec_enum ("output-size", "Output size",
          "Size of the output: the input's, or what crop-ratio leaves of it",
          GST_TYPE_L1L2_STAB_OUTPUT_SIZE, defaults->output_size,
          SETTING_FLAGS));

  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_JOIN, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_INTERPOLATION, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_OUTPUT_SIZE, 0);
}

void
gst_l1l2_stab_settings_install (GObjectClass * klass)
{
  L1L2StabConfig defaults;

  l1l2stab_config_init (&defaults, sizeof (defaults));

  g_object_class_install_property (klass, PROP_LAMBDA,
      g_param_spec_double ("lambda", "Lambda",
          "Pull towards the shaken path, per frame diagonal: 0.1 smooths most, "
          "2 follows the shake; means the same at every size and frame rate. "
          "A change applies to the frames that come in from then on",
          0, 1000, defaults.lambda, LIVE_FLAGS));
  g_object_class_install_property (klass, PROP_WINDOW,
      g_param_spec_int ("window", "Window",
          "Frames that are looked at together; as many are held back, which is "
          "the latency", 4, 900, defaults.window, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_OVERLAP,
      g_param_spec_int ("overlap", "Overlap",
          "Frames that a window shares with the next, from 3 to less than the "
          "window: more is steadier and costs time (0 = chosen by join)",
          0, 899, defaults.overlap, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_CROP_RATIO,
      g_param_spec_double ("crop-ratio", "Crop ratio",
          "Part of each side that is kept: less leaves more room to move. "
          "A change applies to the frames that come in from then on, by at most "
          "0.005 a frame; output-size=crop keeps its size until the next caps",
          0.5, 0.99, defaults.crop_ratio, LIVE_FLAGS));
  install_enums (klass, &defaults);
  g_object_class_install_property (klass, PROP_THREADS,
      g_param_spec_int ("threads", "Threads",
          "Threads that render a frame (0 = as many as there are cores)",
          0, 64, defaults.threads, SETTING_FLAGS));
}

void
gst_l1l2_stab_settings_init (GstL1L2StabSettings * settings,
    GstObject * object)
{
  memset (settings, 0, sizeof (*settings));
  settings->object = object;
  l1l2stab_config_init (&settings->wanted, sizeof (settings->wanted));
}

static gboolean
set_field (L1L2StabConfig * config, guint id, const GValue * value)
{
  switch (id) {
    case PROP_LAMBDA:
      config->lambda = g_value_get_double (value);
      return TRUE;
    case PROP_WINDOW:
      config->window = g_value_get_int (value);
      return TRUE;
    case PROP_OVERLAP:
      config->overlap = g_value_get_int (value);
      return TRUE;
    case PROP_CROP_RATIO:
      config->crop_ratio = g_value_get_double (value);
      return TRUE;
    case PROP_JOIN:
      config->join = g_value_get_enum (value);
      return TRUE;
    case PROP_INTERPOLATION:
      config->interpolation = g_value_get_enum (value);
      return TRUE;
    case PROP_OUTPUT_SIZE:
      config->output_size = g_value_get_enum (value);
      return TRUE;
    case PROP_THREADS:
      config->threads = g_value_get_int (value);
      return TRUE;
    default:
      return FALSE;
  }
}

static gboolean
get_field (const L1L2StabConfig * config, guint id, GValue * value)
{
  switch (id) {
    case PROP_LAMBDA:
      g_value_set_double (value, config->lambda);
      return TRUE;
    case PROP_WINDOW:
      g_value_set_int (value, config->window);
      return TRUE;
    case PROP_OVERLAP:
      g_value_set_int (value, config->overlap);
      return TRUE;
    case PROP_CROP_RATIO:
      g_value_set_double (value, config->crop_ratio);
      return TRUE;
    case PROP_JOIN:
      g_value_set_enum (value, config->join);
      return TRUE;
    case PROP_INTERPOLATION:
      g_value_set_enum (value, config->interpolation);
      return TRUE;
    case PROP_OUTPUT_SIZE:
      g_value_set_enum (value, config->output_size);
      return TRUE;
    case PROP_THREADS:
      g_value_set_int (value, config->threads);
      return TRUE;
    default:
      return FALSE;
  }
}

gboolean
gst_l1l2_stab_settings_set (GstL1L2StabSettings * settings, guint id,
    const GValue * value)
{
  gboolean known;

  GST_OBJECT_LOCK (settings->object);
  known = set_field (&settings->wanted, id, value);
  GST_OBJECT_UNLOCK (settings->object);
  return known;
}

gboolean
gst_l1l2_stab_settings_get (GstL1L2StabSettings * settings, guint id,
    GValue * value)
{
  gboolean known;

  GST_OBJECT_LOCK (settings->object);
  known = get_field (&settings->wanted, id, value);
  GST_OBJECT_UNLOCK (settings->object);
  return known;
}

/* Caps are worked out, and the library is made for them, at different moments: with properties that change in between,
 * the library would write frames of another size than the buffers have. */
void
gst_l1l2_stab_settings_adopt (GstL1L2StabSettings * settings, GstPad * pad,
    GstEvent * caps_event)
{
  GstCaps *old_caps = gst_pad_get_current_caps (pad);
  GstCaps *caps;

  gst_event_parse_caps (caps_event, &caps);
  if (!old_caps || !gst_caps_is_equal (old_caps, caps)) {
    GST_OBJECT_LOCK (settings->object);
    settings->in_use = settings->wanted;
    settings->has_caps = TRUE;
    GST_OBJECT_UNLOCK (settings->object);
  }
  gst_clear_caps (&old_caps);
}

void
gst_l1l2_stab_settings_release (GstL1L2StabSettings * settings)
{
  GST_OBJECT_LOCK (settings->object);
  settings->has_caps = FALSE;
  GST_OBJECT_UNLOCK (settings->object);
}

void
gst_l1l2_stab_settings_in_use (GstL1L2StabSettings * settings,
    L1L2StabConfig * config)
{
  GST_OBJECT_LOCK (settings->object);
  *config = settings->has_caps ? settings->in_use : settings->wanted;
  GST_OBJECT_UNLOCK (settings->object);
}

/* A control binding sets the property, which locks: the lock is taken only after it. */
void
gst_l1l2_stab_settings_sample (GstL1L2StabSettings * settings,
    const GstSegment * segment, GstBuffer * frame, gdouble * lambda,
    gdouble * crop_ratio)
{
  GstClockTime time = GST_CLOCK_TIME_NONE;

  if (segment->format == GST_FORMAT_TIME)
    time = gst_segment_to_stream_time (segment, GST_FORMAT_TIME,
        GST_BUFFER_PTS (frame));
  if (GST_CLOCK_TIME_IS_VALID (time))
    gst_object_sync_values (settings->object, time);

  GST_OBJECT_LOCK (settings->object);
  *lambda = settings->wanted.lambda;
  *crop_ratio = settings->wanted.crop_ratio;
  GST_OBJECT_UNLOCK (settings->object);
}
