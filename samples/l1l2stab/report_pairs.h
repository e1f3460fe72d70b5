/* SPDX-License-Identifier: MIT */
/* Some frames before and after stabilization, as JPEG pictures for the report. */
#ifndef REPORT_PAIRS_H
#define REPORT_PAIRS_H

#include <gst/gst.h>

typedef struct ReportPairs ReportPairs;

/* Watches a stabilizer before it starts. duration: of the video in nanoseconds; 0: it is not known. */
ReportPairs *report_pairs_new(GstElement *stabilizer, gint64 duration);
void report_pairs_free(ReportPairs *pairs);

/* Adds [{"time": seconds, "before": "data:...", "after": "data:..."}...]. The pipeline has to be stopped. */
void report_pairs_write(const ReportPairs *pairs, GString *json);

#endif
