/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabmeta.h"

void
gst_l1l2_stab_meta_set_matrix (GstStructure * structure, const gchar * field,
    const gdouble matrix[9])
{
  GValue array = G_VALUE_INIT;
  guint i;

  gst_value_array_init (&array, 9);
  for (i = 0; i < 9; i++) {
    GValue number = G_VALUE_INIT;

    g_value_init (&number, G_TYPE_DOUBLE);
    g_value_set_double (&number, matrix[i]);
    gst_value_array_append_and_take_value (&array, &number);
  }
  gst_structure_take_value (structure, field, &array);
}

static void
get_matrix (const GstStructure * structure, const gchar * field,
    gdouble matrix[9])
{
  const GValue *array = gst_structure_get_value (structure, field);
  guint i;

  for (i = 0; i < 9; i++)
    matrix[i] = g_value_get_double (gst_value_array_get_value (array, i));
}

static gboolean
copy_field (GQuark field, const GValue * value, gpointer structure)
{
  gst_structure_id_set_value (structure, field, value);
  return TRUE;
}

/* Adjusts the maps to a picture that was scaled. */
static void
scale (GstStructure * structure, const GstVideoMetaTransform * sizes)
{
  const gint width = GST_VIDEO_INFO_WIDTH (sizes->out_info);
  const gint height = GST_VIDEO_INFO_HEIGHT (sizes->out_info);
  const gdouble factors[3] = {
    (gdouble) width / GST_VIDEO_INFO_WIDTH (sizes->in_info),
    (gdouble) height / GST_VIDEO_INFO_HEIGHT (sizes->in_info), 1
  };
  gdouble to_source[9], from_source[9];
  guint i;

  get_matrix (structure, "to-source", to_source);
  get_matrix (structure, "from-source", from_source);
  for (i = 0; i < 9; i++) {
    to_source[i] /= factors[i % 3];
    from_source[i] *= factors[i / 3];
  }
  gst_l1l2_stab_meta_set_matrix (structure, "to-source", to_source);
  gst_l1l2_stab_meta_set_matrix (structure, "from-source", from_source);
  gst_structure_set (structure, "width", G_TYPE_INT, width,
      "height", G_TYPE_INT, height, NULL);
  gst_structure_remove_field (structure, "border-map");
}

static gboolean
transform (GstBuffer * output, GstCustomMeta * meta, GstBuffer * input,
    GQuark type, gpointer data, gpointer user_data)
{
  const gboolean scaled = GST_VIDEO_META_TRANSFORM_IS_SCALE (type);
  GstCustomMeta *copy;
  GstStructure *structure;

  if (!scaled && !GST_META_TRANSFORM_IS_COPY (type))
    return FALSE;
  copy = gst_buffer_add_custom_meta (output, GST_L1L2_STAB_META_NAME);
  structure = gst_custom_meta_get_structure (copy);
  gst_structure_foreach (gst_custom_meta_get_structure (meta), copy_field,
      structure);
  if (scaled)
    scale (structure, data);
  return TRUE;
}

/* The tags have two effects: an element that scales calls transform(), and one that crops, rotates or mirrors drops the
 * meta. */
void
gst_l1l2_stab_meta_register (void)
{
  static const gchar *tags[] = { GST_META_TAG_VIDEO_STR,
    GST_META_TAG_VIDEO_SIZE_STR, GST_META_TAG_VIDEO_ORIENTATION_STR, NULL
  };

  gst_meta_register_custom (GST_L1L2_STAB_META_NAME, tags, transform, NULL,
      NULL);
}

void
gst_l1l2_stab_meta_add (GstBuffer * output, guint64 frame,
    const GstL1L2StabMap * map, const GstVideoInfo * in_info,
    const GstVideoInfo * out_info)
{
  GstCustomMeta *meta =
      gst_buffer_add_custom_meta (output, GST_L1L2_STAB_META_NAME);
  GstStructure *structure = gst_custom_meta_get_structure (meta);

  gst_structure_set (structure, "frame", G_TYPE_UINT64, frame,
      "width", G_TYPE_INT, GST_VIDEO_INFO_WIDTH (out_info),
      "height", G_TYPE_INT, GST_VIDEO_INFO_HEIGHT (out_info),
      "source-width", G_TYPE_INT, GST_VIDEO_INFO_WIDTH (in_info),
      "source-height", G_TYPE_INT, GST_VIDEO_INFO_HEIGHT (in_info), NULL);
  gst_l1l2_stab_meta_set_matrix (structure, "to-source", map->to_source);
  gst_l1l2_stab_meta_set_matrix (structure, "from-source", map->to_output);
}

void
gst_l1l2_stab_meta_set_border_map (GstBuffer * output, GstBuffer * border_map)
{
  GstCustomMeta *meta =
      gst_buffer_get_custom_meta (output, GST_L1L2_STAB_META_NAME);

  gst_structure_set (gst_custom_meta_get_structure (meta), "border-map",
      GST_TYPE_BUFFER, border_map, NULL);
}
