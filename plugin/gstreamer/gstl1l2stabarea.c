/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabarea.h"

#include <math.h>

/* The least part of the frame's width, and of its height, that a region has. It is the library's limit. */
#define LEAST_PARTS 8

/* A number, with a percent sign or without, and blanks around it. */
static gboolean
parse_value (const gchar * text, gdouble * value, gboolean * is_percent)
{
  gchar *end;

  *value = g_ascii_strtod (text, &end);
  if (end == text || !isfinite (*value))
    return FALSE;
  *is_percent = *end == '%';
  if (*is_percent)
    end++;
  while (g_ascii_isspace (*end))
    end++;
  return *end == '\0';
}

static gboolean
parse_region (GstL1L2StabArea * area, GstElement * element, const gchar * text)
{
  gchar **values = g_strsplit (text, ",", 5);
  gboolean ok = g_strv_length (values) == 4;
  guint i;

  for (i = 0; ok && i < 4; i++)
    ok = parse_value (values[i], &area->region[i], &area->is_percent[i]);
  g_strfreev (values);
  if (ok)
    area->region_text = g_strdup (text);
  else
    GST_ELEMENT_ERROR (element, LIBRARY, SETTINGS,
        ("region is \"%s\": give x,y,width,height as four numbers, in pixels of the frame or with %% signs in parts of "
            "it, such as region=10%%,0,80%%,50%%.", text), (NULL));
  return ok;
}

static gboolean
read_mask (GstL1L2StabArea * area, GstElement * element, const gchar * name)
{
  gchar *fault;

  switch (gst_l1l2_stab_pgm_read (&area->mask, name, &fault)) {
    case GST_L1L2_STAB_PGM_OK:
      return TRUE;
    case GST_L1L2_STAB_PGM_CANNOT_OPEN:
      GST_ELEMENT_ERROR (element, RESOURCE, OPEN_READ,
          ("mask: %s %s.", name, fault), (NULL));
      break;
    case GST_L1L2_STAB_PGM_BAD:
      GST_ELEMENT_ERROR (element, RESOURCE, READ,
          ("mask: %s %s. Write the mask as a binary PGM of 8 or 16 bits: white is measured, black is not.", name,
              fault), (NULL));
      break;
  }
  g_free (fault);
  return FALSE;
}

gboolean
gst_l1l2_stab_area_open (GstL1L2StabArea * area, GstElement * element,
    const gchar * region, const gchar * mask)
{
  gst_l1l2_stab_area_close (area);
  if ((!region || parse_region (area, element, region))
      && (!mask || read_mask (area, element, mask)))
    return TRUE;
  gst_l1l2_stab_area_close (area);
  return FALSE;
}

void
gst_l1l2_stab_area_close (GstL1L2StabArea * area)
{
  g_clear_pointer (&area->region_text, g_free);
  gst_l1l2_stab_pgm_clear (&area->mask);
}

/* What is wrong with a part of the frame, or NULL. */
static const gchar *
check_part (const gdouble part[4])
{
  const gdouble rounding = 1e-9;
  guint i;

  for (i = 0; i < 2; i++) {
    if (!(part[i] >= 0 && part[i] + part[i + 2] <= 1 + rounding))
      return "reaches beyond the frame";
    if (!(part[i + 2] >= 1.0 / LEAST_PARTS - rounding))
      return i == 0 ? "is too narrow for the frame" : "is too low for the frame";
  }
  return NULL;
}

gboolean
gst_l1l2_stab_area_apply (const GstL1L2StabArea * area, GstElement * element,
    const GstVideoInfo * info, L1L2StabConfig * config)
{
  const gint side[2] = { GST_VIDEO_INFO_WIDTH (info), GST_VIDEO_INFO_HEIGHT (info) };
  const gchar *fault = NULL;
  guint i;

  config->mask = area->mask.pixels;
  config->mask_stride = config->mask_width = area->mask.width;
  config->mask_height = area->mask.height;
  if (!area->region_text)
    return TRUE;
  for (i = 0; i < 4; i++)
    config->region[i] = area->region[i] / (area->is_percent[i] ? 100 : side[i % 2]);
  fault = check_part (config->region);
  if (fault)
    GST_ELEMENT_ERROR (element, LIBRARY, SETTINGS,
        ("region=%s %s, which has %dx%d pixels. Give x,y,width,height within the frame, width and height at least 1/%d "
            "of its sides, or use %% signs for frames of every size.",
            area->region_text, fault, side[0], side[1], LEAST_PARTS), (NULL));
  return !fault;
}
