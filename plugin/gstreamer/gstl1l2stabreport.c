/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabreport.h"

#include "gstl1l2stabmatrix.h"
#include "gstl1l2stabmeta.h"

void
gst_l1l2_stab_report_init (GstL1L2StabReport * report, GstElement * element)
{
  memset (report, 0, sizeof (*report));
  report->element = element;
}

void
gst_l1l2_stab_report_start (GstL1L2StabReport * report)
{
  GstElement *element = report->element;

  GST_OBJECT_LOCK (element);
  gst_l1l2_stab_report_init (report, element);
  GST_OBJECT_UNLOCK (element);
}

void
gst_l1l2_stab_report_use (GstL1L2StabReport * report, const L1L2Stab * stab)
{
  GST_OBJECT_LOCK (report->element);
  report->threads = l1l2stab_threads (stab);
  report->simd = l1l2stab_simd ();
  report->has_map = FALSE;
  GST_OBJECT_UNLOCK (report->element);
}

void
gst_l1l2_stab_report_in (GstL1L2StabReport * report)
{
  GST_OBJECT_LOCK (report->element);
  report->n_in++;
  GST_OBJECT_UNLOCK (report->element);
}

void
gst_l1l2_stab_report_dropped (GstL1L2StabReport * report, guint64 n)
{
  GST_OBJECT_LOCK (report->element);
  report->n_dropped += n;
  GST_OBJECT_UNLOCK (report->element);
}

/* A frame that starts a path, although frames were before it, is a cut. */
static void
count (GstL1L2StabReport * report, const L1L2StabInfo * info)
{
  guint i;

  report->n_out++;
  report->n_lost += (info->flags & L1L2STAB_INFO_MOTION_LOST) != 0;
  report->n_aligned += info->model == L1L2STAB_MOTION_SOURCE_ALIGNMENT;
  report->n_bridged += (info->flags & L1L2STAB_INFO_BRIDGED) != 0;
  report->filled_sum += info->filled;
  report->extended_sum += info->extended;
  report->n_fallbacks += (info->flags & L1L2STAB_INFO_PATH_FALLBACK) != 0;
  report->n_early += (info->flags & L1L2STAB_INFO_EARLY) != 0;
  if (info->flags & L1L2STAB_INFO_PATH_START) {
    report->n_cuts += info->index > 0;
  } else {
    if (report->n_motions == 0 || info->quality < report->quality_min)
      report->quality_min = info->quality;
    report->quality_sum += info->quality;
    report->n_motions++;
  }
  for (i = 0; i < L1L2STAB_STAGE_COUNT; i++)
    report->stage_ns[i] += info->stage_ns[i];
}

void
gst_l1l2_stab_report_out (GstL1L2StabReport * report, GstBuffer * output,
    const L1L2StabInfo * info, const GstL1L2StabMap * map,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info)
{
  guint64 frame;

  GST_OBJECT_LOCK (report->element);
  count (report, info);
  report->map = *map;
  report->has_map = TRUE;
  frame = report->n_out - 1;
  GST_OBJECT_UNLOCK (report->element);
  gst_l1l2_stab_meta_add (output, frame, map, in_info, out_info);
}

const gchar *
gst_l1l2_stab_report_model_name (L1L2StabMotionSource model)
{
  switch (model) {
    case L1L2STAB_MOTION_SOURCE_NONE:
      return "none";
    case L1L2STAB_MOTION_SOURCE_IDENTITY:
      return "identity";
    case L1L2STAB_MOTION_SOURCE_PREDICTED:
      return "predicted";
    case L1L2STAB_MOTION_SOURCE_TRANSLATION:
      return "translation";
    case L1L2STAB_MOTION_SOURCE_SIMILARITY:
      return "similarity";
    case L1L2STAB_MOTION_SOURCE_GIVEN:
      return "given";
    case L1L2STAB_MOTION_SOURCE_AFFINE:
      return "affine";
    case L1L2STAB_MOTION_SOURCE_ALIGNMENT:
      return "alignment";
  }
  return "unknown";
}

GstMessage *
gst_l1l2_stab_report_message (GstL1L2StabReport * report, GstBuffer * output,
    const L1L2StabInfo * info, const GstSegment * segment)
{
  const gboolean timed = segment->format == GST_FORMAT_TIME;
  const GstClockTime pts = GST_BUFFER_PTS (output);
  GstStructure *structure;
  guint64 frame;

  GST_OBJECT_LOCK (report->element);
  frame = report->n_out - 1;
  GST_OBJECT_UNLOCK (report->element);

  structure = gst_structure_new ("l1l2stab-frame",
      "frame", G_TYPE_UINT64, frame,
      "timestamp", G_TYPE_UINT64, pts,
      "stream-time", G_TYPE_UINT64, timed ?
      gst_segment_to_stream_time (segment, GST_FORMAT_TIME, pts) :
      GST_CLOCK_TIME_NONE,
      "running-time", G_TYPE_UINT64, timed ?
      gst_segment_to_running_time (segment, GST_FORMAT_TIME, pts) :
      GST_CLOCK_TIME_NONE,
      "duration", G_TYPE_UINT64, GST_BUFFER_DURATION (output),
      "path-frame", G_TYPE_UINT64, info->path_index,
      "model", G_TYPE_STRING, gst_l1l2_stab_report_model_name (info->model),
      "quality", G_TYPE_DOUBLE, info->quality,
      "tracks", G_TYPE_INT, info->tracks,
      "inliers", G_TYPE_INT, info->inliers,
      "lambda", G_TYPE_DOUBLE, info->lambda,
      "crop-ratio", G_TYPE_DOUBLE, info->crop_ratio,
      "bypass", G_TYPE_DOUBLE, info->bypass,
      "residual", G_TYPE_DOUBLE, info->residual,
      "readout", G_TYPE_DOUBLE, info->readout,
      "filled", G_TYPE_DOUBLE, info->filled,
      "extended", G_TYPE_DOUBLE, info->extended,
      "path-start", G_TYPE_BOOLEAN,
      (info->flags & L1L2STAB_INFO_PATH_START) != 0,
      "motion-lost", G_TYPE_BOOLEAN,
      (info->flags & L1L2STAB_INFO_MOTION_LOST) != 0,
      "bridged", G_TYPE_BOOLEAN,
      (info->flags & L1L2STAB_INFO_BRIDGED) != 0,
      "path-fallback", G_TYPE_BOOLEAN,
      (info->flags & L1L2STAB_INFO_PATH_FALLBACK) != 0,
      "early", G_TYPE_BOOLEAN, (info->flags & L1L2STAB_INFO_EARLY) != 0, NULL);
  gst_l1l2_stab_meta_set_matrix (structure, "motion", info->F);
  gst_l1l2_stab_meta_set_matrix (structure, "update", info->B);
  gst_l1l2_stab_meta_set_matrix (structure, "camera", info->C);
  gst_l1l2_stab_meta_set_matrix (structure, "path", info->P);
  gst_l1l2_stab_meta_set_matrix (structure, "warp", info->warp);
  return gst_message_new_element (GST_OBJECT_CAST (report->element),
      structure);
}

GstStructure *
gst_l1l2_stab_report_stats (GstL1L2StabReport * report, gint window,
    GstClockTime latency)
{
  static const gchar *stages[L1L2STAB_STAGE_COUNT] = {
    "scale-time", "track-time", "fit-time", "solve-time", "warp-time"
  };
  GstL1L2StabReport now;
  GstStructure *stats;
  guint i;

  GST_OBJECT_LOCK (report->element);
  now = *report;
  GST_OBJECT_UNLOCK (report->element);

  stats = gst_structure_new ("l1l2stab-stats",
      "frames-in", G_TYPE_UINT64, now.n_in,
      "frames-out", G_TYPE_UINT64, now.n_out,
      "frames-dropped", G_TYPE_UINT64, now.n_dropped,
      "frames-held", G_TYPE_UINT64, now.n_in - now.n_out - now.n_dropped,
      "quality-mean", G_TYPE_DOUBLE, now.n_motions ?
      now.quality_sum / now.n_motions : 0.0,
      "quality-min", G_TYPE_DOUBLE, now.quality_min,
      "motion-lost", G_TYPE_UINT64, now.n_lost,
      "aligned", G_TYPE_UINT64, now.n_aligned,
      "bridged", G_TYPE_UINT64, now.n_bridged,
      "filled-mean", G_TYPE_DOUBLE, now.n_out ? now.filled_sum / now.n_out :
      0.0,
      "extended-mean", G_TYPE_DOUBLE, now.n_out ?
      now.extended_sum / now.n_out : 0.0,
      "cuts", G_TYPE_UINT64, now.n_cuts,
      "path-fallbacks", G_TYPE_UINT64, now.n_fallbacks,
      "early", G_TYPE_UINT64, now.n_early,
      "window", G_TYPE_INT, window,
      "latency", G_TYPE_UINT64, latency,
      "threads", G_TYPE_INT, now.threads,
      "simd", G_TYPE_STRING, now.simd ? now.simd : "",
      "version", G_TYPE_STRING, l1l2stab_version (), NULL);
  for (i = 0; i < L1L2STAB_STAGE_COUNT; i++)
    gst_structure_set (stats, stages[i], G_TYPE_UINT64, now.n_out ?
        (guint64) now.stage_ns[i] / now.n_out : 0, NULL);
  return stats;
}

GstEvent *
gst_l1l2_stab_report_point_at_source (GstL1L2StabReport * report,
    GstEvent * event)
{
  const GstStructure *structure = gst_event_get_structure (event);
  GstL1L2StabMap map;
  gboolean has_map;
  gdouble x, y;

  GST_OBJECT_LOCK (report->element);
  map = report->map;
  has_map = report->has_map;
  GST_OBJECT_UNLOCK (report->element);

  /* gst_navigation_event_get_coordinates() of GStreamer 1.22 does not handle the wheel, so the fields are read here. */
  if (has_map && structure
      && gst_structure_get (structure, "pointer_x", G_TYPE_DOUBLE, &x,
          "pointer_y", G_TYPE_DOUBLE, &y, NULL)
      && gst_l1l2_stab_matrix_map_point (map.to_source, &x, &y)) {
    event = gst_event_make_writable (event);
    gst_structure_set (gst_event_writable_structure (event),
        "pointer_x", G_TYPE_DOUBLE, x, "pointer_y", G_TYPE_DOUBLE, y, NULL);
  }
  return event;
}
