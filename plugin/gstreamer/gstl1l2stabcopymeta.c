/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabcopymeta.h"

/* A meta without a tag describes the frame as a whole. One about colors stays true, because colors are not changed. */
static gboolean
is_about_the_whole (const gchar * const *tags)
{
  for (; tags && *tags; tags++) {
    if (!g_str_equal (*tags, GST_META_TAG_VIDEO_STR)
        && !g_str_equal (*tags, GST_META_TAG_VIDEO_COLORSPACE_STR))
      return FALSE;
  }
  return TRUE;
}

/* An overlay, such as subtitles, is placed in the output picture. It has to be named here because GStreamer 1.26 gave
 * its meta tags that it did not have in 1.22. AFD and bars describe black borders. They stay nearly true, because
 * stabilization moves the picture only a little. */
gboolean
gst_l1l2_stab_copy_meta_keeps (const GstMeta * meta)
{
  const GType api = meta->info->api;

  return is_about_the_whole (gst_meta_api_type_get_tags (api))
      || api == GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE
      || api == GST_VIDEO_AFD_META_API_TYPE
      || api == GST_VIDEO_BAR_META_API_TYPE
      || api == GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE;
}

typedef struct
{
  const GstL1L2StabMap *map;
  const GstVideoInfo *out_info;
} Picture;

static gboolean
move_region (GstBuffer * output, GstMeta ** meta, gpointer user_data)
{
  const Picture *picture = user_data;
  GstVideoRegionOfInterestMeta *region;
  GstVideoRectangle box;

  if ((*meta)->info->api != GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)
    return TRUE;
  region = (GstVideoRegionOfInterestMeta *) * meta;
  box.x = region->x;
  box.y = region->y;
  box.w = region->w;
  box.h = region->h;
  if (gst_l1l2_stab_map_box (picture->map->to_output,
          GST_VIDEO_INFO_WIDTH (picture->out_info),
          GST_VIDEO_INFO_HEIGHT (picture->out_info), &box)) {
    region->x = box.x;
    region->y = box.y;
    region->w = box.w;
    region->h = box.h;
  } else {
    *meta = NULL;
  }
  return TRUE;
}

void
gst_l1l2_stab_copy_meta_map_regions (GstBuffer * output, const GstL1L2StabMap * map,
    const GstVideoInfo * out_info)
{
  Picture picture = { map, out_info };

  gst_buffer_foreach_meta (output, move_region, &picture);
}
