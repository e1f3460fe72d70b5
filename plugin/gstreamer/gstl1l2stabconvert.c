/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabconvert.h"

#include "gstl1l2stabcaps.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug

/* The library's range. */
#define MIN_PIXEL_ASPECT 0.1
#define MAX_PIXEL_ASPECT 10.0

static const struct
{
  L1L2StabLogLevel ours;
  GstDebugLevel gst;
} levels[] = {
  {L1L2STAB_LOG_ERROR, GST_LEVEL_ERROR},
  {L1L2STAB_LOG_WARN, GST_LEVEL_WARNING},
  {L1L2STAB_LOG_INFO, GST_LEVEL_INFO},
  {L1L2STAB_LOG_DEBUG, GST_LEVEL_DEBUG},
  {L1L2STAB_LOG_TRACE, GST_LEVEL_LOG},
};

static void
write_message (void *cookie, L1L2StabLogLevel level, const char *message)
{
  GstL1L2StabLog *log = cookie;
  guint i;

  /* The first error is the cause; the later ones are its consequences. */
  if (level == L1L2STAB_LOG_ERROR && !log->reason)
    log->reason = g_strdup (message);
  for (i = 0; i < G_N_ELEMENTS (levels); i++) {
    if (levels[i].ours == level)
      GST_CAT_LEVEL_LOG (GST_CAT_DEFAULT, levels[i].gst, log->object, "%s",
          message);
  }
}

void
gst_l1l2_stab_convert_logger (L1L2StabLogger * logger, GstL1L2StabLog * log)
{
  GstDebugLevel threshold = gst_debug_category_get_threshold (GST_CAT_DEFAULT);
  guint i;

  g_clear_pointer (&log->reason, g_free);
  logger->write = write_message;
  logger->cookie = log;
  logger->max_level = L1L2STAB_LOG_ERROR;       /* errors at least, so that the reason is known */
  for (i = 0; i < G_N_ELEMENTS (levels); i++) {
    if (levels[i].gst <= threshold)
      logger->max_level = levels[i].ours;
  }
}

gboolean
gst_l1l2_stab_convert_caps (GstVideoInfo * info, const GstCaps * caps)
{
  const gchar *site;

  if (!gst_video_info_from_caps (info, caps))
    return FALSE;
  site = gst_structure_get_string (gst_caps_get_structure (caps, 0),
      "chroma-site");
  GST_VIDEO_INFO_CHROMA_SITE (info) = site ?
      gst_video_chroma_site_from_string (site) : GST_VIDEO_CHROMA_SITE_UNKNOWN;
  return TRUE;
}

static L1L2StabChromaSite
chroma_site_from_video (GstVideoChromaSite site)
{
  if (site == GST_VIDEO_CHROMA_SITE_UNKNOWN)
    return L1L2STAB_CHROMA_SITE_LEFT;
  if ((site & GST_VIDEO_CHROMA_SITE_H_COSITED) == 0)
    return L1L2STAB_CHROMA_SITE_CENTER;
  if (site & GST_VIDEO_CHROMA_SITE_V_COSITED)
    return L1L2STAB_CHROMA_SITE_TOP_LEFT;
  return L1L2STAB_CHROMA_SITE_LEFT;
}

/* Nonsense in the caps must not stop the stream: it counts as square pixels. */
static gdouble
pixel_aspect_from_video (const GstVideoInfo * info)
{
  const gdouble aspect = (gdouble) GST_VIDEO_INFO_PAR_N (info)
      / GST_VIDEO_INFO_PAR_D (info);

  return aspect >= MIN_PIXEL_ASPECT && aspect <= MAX_PIXEL_ASPECT ? aspect : 1;
}

void
gst_l1l2_stab_convert_config (L1L2StabConfig * config, const GstVideoInfo * info)
{
  config->format = gst_l1l2_stab_caps_format (GST_VIDEO_INFO_FORMAT (info));
  config->width = GST_VIDEO_INFO_WIDTH (info);
  config->height = GST_VIDEO_INFO_HEIGHT (info);
  config->chroma_site =
      chroma_site_from_video (GST_VIDEO_INFO_CHROMA_SITE (info));
  config->pixel_aspect = pixel_aspect_from_video (info);
  config->frame_rate = 0;
  if (GST_VIDEO_INFO_FPS_N (info) > 0) {
    gdouble rate;

    gst_util_fraction_to_double (GST_VIDEO_INFO_FPS_N (info),
        GST_VIDEO_INFO_FPS_D (info), &rate);
    if (rate <= GST_L1L2_STAB_MAX_FRAME_RATE)
      config->frame_rate = rate;
  }
}

GstClockTime
gst_l1l2_stab_convert_stream_time (const GstSegment * segment,
    GstClockTime timestamp)
{
  if (segment->format != GST_FORMAT_TIME)
    return GST_CLOCK_TIME_NONE;
  return gst_segment_to_stream_time (segment, GST_FORMAT_TIME, timestamp);
}

GstClockTime
gst_l1l2_stab_convert_add_times (GstClockTime a, GstClockTime b)
{
  const GstClockTime largest = GST_CLOCK_TIME_NONE - 1;

  return a <= largest - b ? a + b : largest;
}

GstClockTime
gst_l1l2_stab_convert_time_distance (GstClockTime a, GstClockTime b)
{
  return a > b ? a - b : b - a;
}

void
gst_l1l2_stab_convert_planes (L1L2StabFrame * frame, const GstVideoFrame * video)
{
  guint i;

  for (i = 0; i < GST_VIDEO_FRAME_N_PLANES (video); i++) {
    frame->data[i] = GST_VIDEO_FRAME_PLANE_DATA (video, i);
    frame->stride[i] = GST_VIDEO_FRAME_PLANE_STRIDE (video, i);
  }
}

GstFlowReturn
gst_l1l2_stab_convert_result (GstElement * element, L1L2StabResult result,
    const GstL1L2StabLog * log)
{
  const gchar *what = l1l2stab_strerror (result);
  const gchar *reason = log->reason ? log->reason : what;

  switch (result) {
    case L1L2STAB_OK:
    case L1L2STAB_AGAIN:
    case L1L2STAB_EOS:
      return GST_FLOW_OK;
    case L1L2STAB_ERR_ARGUMENT:
    case L1L2STAB_ERR_UNSUPPORTED:
      GST_ELEMENT_ERROR (element, LIBRARY, SETTINGS, ("%s", reason),
          ("%s", what));
      return GST_FLOW_ERROR;
    case L1L2STAB_ERR_NOMEM:
      GST_ELEMENT_ERROR (element, RESOURCE, NO_SPACE_LEFT, ("%s", what),
          ("%s", reason));
      return GST_FLOW_ERROR;
    case L1L2STAB_ERR_STATE:
    case L1L2STAB_ERR_BACKEND:
      break;
  }
  GST_ELEMENT_ERROR (element, LIBRARY, FAILED, ("%s", what), ("%s", reason));
  return GST_FLOW_ERROR;
}
