/* SPDX-License-Identifier: MIT */
/* What applications are told: of each frame that goes out, by a meta and, on demand, a message; of all, by statistics;
 * and where in the source a pointer points that moves over the picture. docs/control.md has every field. */
#ifndef GST_L1L2_STAB_REPORT_H
#define GST_L1L2_STAB_REPORT_H

#include <gst/gst.h>
#include <l1l2stab/l1l2stab.h>

#include "gstl1l2stabmap.h"

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* its object lock guards the rest; not owned */
  guint64 n_in, n_out, n_dropped;       /* frames since the start */
  guint64 n_lost, n_cuts, n_fallbacks, n_early;
  guint64 n_motions;            /* frames with a motion, the first of a path has none ... */
  gdouble quality_sum, quality_min;     /* ... and of these */
  gint64 stage_ns[L1L2STAB_STAGE_COUNT];
  gint threads;                 /* that render */
  const gchar *simd;            /* that they use */
  gboolean has_map;
  GstL1L2StabMap map;           /* of the last frame out */
} GstL1L2StabReport;

void gst_l1l2_stab_report_init (GstL1L2StabReport * report,
    GstElement * element);

/* Forgets what was. */
void gst_l1l2_stab_report_start (GstL1L2StabReport * report);

/* From now on it is this instance that does the work. */
void gst_l1l2_stab_report_use (GstL1L2StabReport * report,
    const L1L2Stab * stab);

/* Frames came in; frames are gone that will not come out. */
void gst_l1l2_stab_report_in (GstL1L2StabReport * report);
void gst_l1l2_stab_report_dropped (GstL1L2StabReport * report, guint64 n);

/* A frame goes out. */
void gst_l1l2_stab_report_out (GstL1L2StabReport * report, GstBuffer * output,
    const L1L2StabInfo * info, const GstL1L2StabMap * map,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info);

/* The element message for the frame that gst_l1l2_stab_report_out() was told of last. */
GstMessage *gst_l1l2_stab_report_message (GstL1L2StabReport * report,
    GstBuffer * output, const L1L2StabInfo * info, const GstSegment * segment);

/* The value of the property. */
GstStructure *gst_l1l2_stab_report_stats (GstL1L2StabReport * report,
    gint window, GstClockTime latency);

/* Takes a navigation event that points into the last picture out; gives one that points at the same thing in the
 * source. */
GstEvent *gst_l1l2_stab_report_point_at_source (GstL1L2StabReport * report,
    GstEvent * event);

/* The name of a model, as messages and motion files have it. */
const gchar *gst_l1l2_stab_report_model_name (L1L2StabMotionSource model);

G_END_DECLS

#endif
