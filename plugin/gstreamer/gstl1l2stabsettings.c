/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabsettings.h"

#include "gstl1l2stabenums.h"

enum
{
  PROP_0,
  PROP_STATS = GST_L1L2_STAB_PROP_STATS,
  PROP_LAMBDA,
  PROP_CROP_RATIO,
  PROP_BYPASS,
  PROP_WINDOW,
  PROP_OVERLAP,
  PROP_JOIN,
  PROP_MOTION_MODEL,
  PROP_ROLLING_SHUTTER,
  PROP_INTERPOLATION,
  PROP_OUTPUT_SIZE,
  PROP_BORDER,
  PROP_FILL_FRAMES,
  PROP_THREADS,
  PROP_REGION,
  PROP_MASK,
  PROP_MOTION_IN,
  PROP_MOTION_OUT,
  PROP_POST_MESSAGES,
  PROP_BORDER_MAP,
};

/* A change takes effect with the next caps, and for a text or file name when the element starts. So these are changed
 * in READY. */
#define SETTING_FLAGS \
  (G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_READY)

/* Each frame reads these when it comes in or goes out ... */
#define LIVE_FLAGS \
  (G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_PLAYING)

/* ... and these can be controlled by stream time. */
#define CONTROLLABLE_FLAGS (LIVE_FLAGS | GST_PARAM_CONTROLLABLE)

static void
install_live (GObjectClass * klass, const L1L2StabConfig * defaults)
{
  g_object_class_install_property (klass, PROP_LAMBDA,
      g_param_spec_double ("lambda", "Lambda",
          "How closely the smooth path follows the camera's path; no unit. "
          "0 = smoothest, 0.1 = very smooth, 2 = follows most of the shake. A "
          "value has the same effect at every frame size and frame rate. A "
          "change applies to the frames that come in after it",
          0, 1000, defaults->lambda, CONTROLLABLE_FLAGS));
  g_object_class_install_property (klass, PROP_CROP_RATIO,
      g_param_spec_double ("crop-ratio", "Crop ratio",
          "Part of the width and of the height that is shown, from 0.5 to 0.99. "
          "A smaller value leaves more room for stabilization. A change applies "
          "to the frames that come in after it, by at most 0.005 per frame; with "
          "output-size=crop the output size stays until the next caps",
          0.5, 0.99, defaults->crop_ratio, CONTROLLABLE_FLAGS));
  g_object_class_install_property (klass, PROP_BYPASS,
      g_param_spec_boolean ("bypass", "Bypass",
          "Show whole frames without stabilization, with the same delay. A "
          "change applies to the frames that go out after it; the picture moves "
          "smoothly from one to the other within "
          G_STRINGIFY (L1L2STAB_BYPASS_FRAMES) " frames",
          FALSE, CONTROLLABLE_FLAGS));
  g_object_class_install_property (klass, PROP_POST_MESSAGES,
      g_param_spec_boolean ("post-messages", "Post messages",
          "Post an element message \"l1l2stab-frame\" for each frame that goes "
          "out, with its motion, path, warp and quality",
          FALSE, LIVE_FLAGS));
  g_object_class_install_property (klass, PROP_BORDER_MAP,
      g_param_spec_boolean ("border-map", "Border map",
          "With border=fill or extend: tell in the meta of each frame who gave "
          "each pixel, in a buffer of one byte per pixel: 0 the frame itself, "
          "128 + k the frame k frames later, 255 nobody",
          FALSE, LIVE_FLAGS));
}

static void
install_path (GObjectClass * klass, const L1L2StabConfig * defaults)
{
  g_object_class_install_property (klass, PROP_WINDOW,
      g_param_spec_int ("window", "Window",
          "Number of frames that are optimized together. As many frames are "
          "held back, so this is the latency in frames",
          4, 900, defaults->window, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_OVERLAP,
      g_param_spec_int ("overlap", "Overlap",
          "Number of frames that a window shares with the next one, from 3 to "
          "window - 1. More frames give a smoother path and take more time. "
          "0 = a default that depends on join",
          0, 899, defaults->overlap, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_JOIN,
      g_param_spec_enum ("join", "Join",
          "How the paths of two windows are joined. blend needs an overlap of "
          "at most half the window", GST_TYPE_L1L2_STAB_JOIN, defaults->join,
          SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_MOTION_MODEL,
      g_param_spec_enum ("motion-model", "Motion model",
          "The model of the camera's motion between two frames",
          GST_TYPE_L1L2_STAB_MOTION_MODEL, defaults->motion_model,
          SETTING_FLAGS));
}

static void
install_picture (GObjectClass * klass, const L1L2StabConfig * defaults)
{
  g_object_class_install_property (klass, PROP_ROLLING_SHUTTER,
      g_param_spec_enum ("rolling-shutter", "Rolling shutter",
          "How the wobble and skew of a rolling shutter are corrected. Nothing "
          "is corrected with motion-in, because a motion file does not hold what "
          "the correction needs",
          GST_TYPE_L1L2_STAB_ROLLING_SHUTTER, defaults->rolling_shutter,
          SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_INTERPOLATION,
      g_param_spec_enum ("interpolation", "Interpolation",
          "How pixels are interpolated. Sharper methods take more time",
          GST_TYPE_L1L2_STAB_INTERPOLATION, defaults->interpolation,
          SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_OUTPUT_SIZE,
      g_param_spec_enum ("output-size", "Output size",
          "Size of the output: that of the input, or that of the crop window",
          GST_TYPE_L1L2_STAB_OUTPUT_SIZE, defaults->output_size,
          SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_BORDER,
      g_param_spec_enum ("border", "Border",
          "What is shown where the stabilized frame reaches beyond the source. "
          "fill and extend show whole frames at their own scale; crop-ratio says "
          "how much room the path has. They cannot be used with output-size=crop",
          GST_TYPE_L1L2_STAB_BORDER, defaults->border, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_FILL_FRAMES,
      g_param_spec_int ("fill-frames", "Fill frames",
          "With border=fill: frames that fill the border are at most so many "
          "frames away, before or after. As many frames are held in addition to "
          "the window, without delay",
          0, 120, defaults->fill_frames, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_THREADS,
      g_param_spec_int ("threads", "Threads",
          "Number of threads that render a frame. 0 = the number of processor "
          "cores. The output does not depend on it",
          0, 64, defaults->threads, SETTING_FLAGS));
}

static void
install_area (GObjectClass * klass)
{
  g_object_class_install_property (klass, PROP_REGION,
      g_param_spec_string ("region", "Region",
          "Part of the frame in which the camera's motion is measured: "
          "x,y,width,height in pixels of the incoming frame, or with % signs in "
          "parts of it, such as 10%,0,80%,50%. It should show the background. "
          "NULL = the whole frame", NULL, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_MASK,
      g_param_spec_string ("mask", "Mask",
          "File of a gray picture, scaled to the frame: where it is darker than "
          "middle gray, nothing is measured. A binary PGM (P5) of 8 or 16 bits. "
          "NULL = no mask", NULL, SETTING_FLAGS));
}

static void
install_files (GObjectClass * klass)
{
  g_object_class_install_property (klass, PROP_MOTION_IN,
      g_param_spec_string ("motion-in", "Motion in",
          "File to read the camera's motion from, in the format that motion-out "
          "writes; the frames are then not analyzed. NULL = measure the motion",
          NULL, SETTING_FLAGS));
  g_object_class_install_property (klass, PROP_MOTION_OUT,
      g_param_spec_string ("motion-out", "Motion out",
          "Text file to which the motion of each output frame is written. An "
          "existing file is replaced. NULL = write no file",
          NULL, SETTING_FLAGS));
}

void
gst_l1l2_stab_settings_install (GObjectClass * klass)
{
  L1L2StabConfig defaults;

  l1l2stab_config_init (&defaults, sizeof (defaults));
  install_live (klass, &defaults);
  install_path (klass, &defaults);
  install_picture (klass, &defaults);
  install_area (klass);
  install_files (klass);
  g_object_class_install_property (klass, PROP_STATS,
      g_param_spec_boxed ("stats", "Statistics",
          "A structure \"l1l2stab-stats\" with the number of frames, the quality "
          "of their motion and the mean time of each stage since the element was "
          "started", GST_TYPE_STRUCTURE,
          G_PARAM_READABLE | G_PARAM_STATIC_STRINGS));

  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_JOIN, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_MOTION_MODEL, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_ROLLING_SHUTTER, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_INTERPOLATION, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_OUTPUT_SIZE, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_L1L2_STAB_BORDER, 0);
}

void
gst_l1l2_stab_settings_init (GstL1L2StabSettings * settings,
    GstObject * object)
{
  memset (settings, 0, sizeof (*settings));
  settings->object = object;
  l1l2stab_config_init (&settings->wanted, sizeof (settings->wanted));
}

void
gst_l1l2_stab_settings_clear (GstL1L2StabSettings * settings)
{
  g_clear_pointer (&settings->motion_in, g_free);
  g_clear_pointer (&settings->motion_out, g_free);
  g_clear_pointer (&settings->region, g_free);
  g_clear_pointer (&settings->mask, g_free);
}

/* The field that the property sets. Its type is that of the property's values. NULL: no such property. */
static gpointer
find_field (GstL1L2StabSettings * settings, guint id)
{
  L1L2StabConfig *config = &settings->wanted;

  switch (id) {
    case PROP_LAMBDA:
      return &config->lambda;
    case PROP_CROP_RATIO:
      return &config->crop_ratio;
    case PROP_BYPASS:
      return &settings->bypass;
    case PROP_WINDOW:
      return &config->window;
    case PROP_OVERLAP:
      return &config->overlap;
    case PROP_JOIN:
      return &config->join;
    case PROP_MOTION_MODEL:
      return &config->motion_model;
    case PROP_ROLLING_SHUTTER:
      return &config->rolling_shutter;
    case PROP_INTERPOLATION:
      return &config->interpolation;
    case PROP_OUTPUT_SIZE:
      return &config->output_size;
    case PROP_BORDER:
      return &config->border;
    case PROP_FILL_FRAMES:
      return &config->fill_frames;
    case PROP_THREADS:
      return &config->threads;
    case PROP_REGION:
      return &settings->region;
    case PROP_MASK:
      return &settings->mask;
    case PROP_MOTION_IN:
      return &settings->motion_in;
    case PROP_MOTION_OUT:
      return &settings->motion_out;
    case PROP_POST_MESSAGES:
      return &settings->post_messages;
    case PROP_BORDER_MAP:
      return &settings->border_map;
    default:
      return NULL;
  }
}

G_STATIC_ASSERT (sizeof (L1L2StabJoin) == sizeof (gint));

static void
set_field (gpointer field, const GValue * value)
{
  if (G_VALUE_HOLDS_DOUBLE (value)) {
    *(gdouble *) field = g_value_get_double (value);
  } else if (G_VALUE_HOLDS_ENUM (value)) {
    *(gint *) field = g_value_get_enum (value);
  } else if (G_VALUE_HOLDS_BOOLEAN (value)) {
    *(gboolean *) field = g_value_get_boolean (value);
  } else if (G_VALUE_HOLDS_STRING (value)) {
    const gchar *name = g_value_get_string (value);

    /* An empty text means none. */
    g_free (*(gchar **) field);
    *(gchar **) field = name && *name ? g_strdup (name) : NULL;
  } else {
    *(gint *) field = g_value_get_int (value);
  }
}

static void
get_field (gconstpointer field, GValue * value)
{
  if (G_VALUE_HOLDS_DOUBLE (value))
    g_value_set_double (value, *(const gdouble *) field);
  else if (G_VALUE_HOLDS_ENUM (value))
    g_value_set_enum (value, *(const gint *) field);
  else if (G_VALUE_HOLDS_BOOLEAN (value))
    g_value_set_boolean (value, *(const gboolean *) field);
  else if (G_VALUE_HOLDS_STRING (value))
    g_value_set_string (value, *(gchar * const *) field);
  else
    g_value_set_int (value, *(const gint *) field);
}

gboolean
gst_l1l2_stab_settings_set (GstL1L2StabSettings * settings, guint id,
    const GValue * value)
{
  gpointer field = find_field (settings, id);

  if (!field)
    return FALSE;
  GST_OBJECT_LOCK (settings->object);
  set_field (field, value);
  GST_OBJECT_UNLOCK (settings->object);
  return TRUE;
}

gboolean
gst_l1l2_stab_settings_get (GstL1L2StabSettings * settings, guint id,
    GValue * value)
{
  gpointer field = find_field (settings, id);

  if (!field)
    return FALSE;
  GST_OBJECT_LOCK (settings->object);
  get_field (field, value);
  GST_OBJECT_UNLOCK (settings->object);
  return TRUE;
}

/* Caps are negotiated at one moment and the instance of the library is made for them at another. If a property changed
 * in between, the library would write frames of another size than the buffers have. */
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

/* A control binding sets the property, which takes the object lock. So the lock must not be held yet. */
void
gst_l1l2_stab_settings_sample (GstL1L2StabSettings * settings,
    GstClockTime stream_time, gdouble * lambda, gdouble * crop_ratio)
{
  if (GST_CLOCK_TIME_IS_VALID (stream_time))
    gst_object_sync_values (settings->object, stream_time);

  GST_OBJECT_LOCK (settings->object);
  *lambda = settings->wanted.lambda;
  *crop_ratio = settings->wanted.crop_ratio;
  GST_OBJECT_UNLOCK (settings->object);
}

gboolean
gst_l1l2_stab_settings_flag (GstL1L2StabSettings * settings,
    const gboolean * flag)
{
  gboolean value;

  GST_OBJECT_LOCK (settings->object);
  value = *flag;
  GST_OBJECT_UNLOCK (settings->object);
  return value;
}

/* Only this property is updated by the controller. The other controlled properties hold the values of the last frame
 * that came in, which is a window later, and must keep them. */
gboolean
gst_l1l2_stab_settings_sample_bypass (GstL1L2StabSettings * settings,
    GstClockTime stream_time)
{
  GstControlBinding *binding =
      gst_object_get_control_binding (settings->object, "bypass");
  GValue *controlled = NULL;
  gboolean bypass;

  if (binding) {
    if (GST_CLOCK_TIME_IS_VALID (stream_time)
        && !gst_control_binding_is_disabled (binding))
      controlled = gst_control_binding_get_value (binding, stream_time);
    gst_object_unref (binding);
  }
  if (controlled) {
    bypass = g_value_get_boolean (controlled);
    g_value_unset (controlled);
    g_free (controlled);
    return bypass;
  }
  return gst_l1l2_stab_settings_flag (settings, &settings->bypass);
}

void
gst_l1l2_stab_settings_dup_files (GstL1L2StabSettings * settings,
    gchar ** motion_in, gchar ** motion_out)
{
  GST_OBJECT_LOCK (settings->object);
  *motion_in = g_strdup (settings->motion_in);
  *motion_out = g_strdup (settings->motion_out);
  GST_OBJECT_UNLOCK (settings->object);
}

void
gst_l1l2_stab_settings_dup_area (GstL1L2StabSettings * settings,
    gchar ** region, gchar ** mask)
{
  GST_OBJECT_LOCK (settings->object);
  *region = g_strdup (settings->region);
  *mask = g_strdup (settings->mask);
  GST_OBJECT_UNLOCK (settings->object);
}
