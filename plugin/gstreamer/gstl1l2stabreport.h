/* SPDX-License-Identifier: MIT */
/* What the element reports to applications: a meta and, on request, a message for each output frame; statistics of
 * all frames; and the point of the source frame that a pointer over the picture points at. docs/control.md lists all
 * fields. */
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
  guint64 n_aligned, n_bridged;
  gdouble filled_sum, extended_sum;     /* parts of output frames */
  guint64 n_lost, n_cuts, n_fallbacks, n_early; /* output frames with these marks */
  guint64 n_motions;            /* output frames that have a motion: all but the first of a path */
  gdouble quality_sum, quality_min;     /* of these motions */
  gint64 stage_ns[L1L2STAB_STAGE_COUNT];
  gint threads;                 /* number of threads that render */
  const gchar *simd;            /* name of their instruction set */
  gboolean has_map;
  GstL1L2StabMap map;           /* of the last output frame */
} GstL1L2StabReport;

void gst_l1l2_stab_report_init (GstL1L2StabReport * report,
    GstElement * element);

/* Resets all counts, at the start of the element. */
void gst_l1l2_stab_report_start (GstL1L2StabReport * report);

/* Notes the threads and the instruction set of a new instance of the library. */
void gst_l1l2_stab_report_use (GstL1L2StabReport * report,
    const L1L2Stab * stab);

/* Counts a frame that came in, and frames that will not go out. */
void gst_l1l2_stab_report_in (GstL1L2StabReport * report);
void gst_l1l2_stab_report_dropped (GstL1L2StabReport * report, guint64 n);

/* Counts a frame that goes out and adds its meta. */
void gst_l1l2_stab_report_out (GstL1L2StabReport * report, GstBuffer * output,
    const L1L2StabInfo * info, const GstL1L2StabMap * map,
    const GstVideoInfo * in_info, const GstVideoInfo * out_info);

/* The element message of the frame that was passed to gst_l1l2_stab_report_out() last. */
GstMessage *gst_l1l2_stab_report_message (GstL1L2StabReport * report,
    GstBuffer * output, const L1L2StabInfo * info, const GstSegment * segment);

/* The value of the property `stats`. */
GstStructure *gst_l1l2_stab_report_stats (GstL1L2StabReport * report,
    gint window, GstClockTime latency);

/* Takes a navigation event that points into the last output frame. Returns one that points at the same thing in its
 * source frame. */
GstEvent *gst_l1l2_stab_report_point_at_source (GstL1L2StabReport * report,
    GstEvent * event);

/* The name of a motion source, as in messages and motion files. */
const gchar *gst_l1l2_stab_report_model_name (L1L2StabMotionSource model);

G_END_DECLS

#endif
