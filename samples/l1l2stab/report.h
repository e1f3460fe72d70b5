/* SPDX-License-Identifier: MIT */
/*
 * The report of a stabilized video: DIR/NAME.html, .json and .csv.
 *
 * The page is report/page.html with the plotting library and the data put into it, so that it is one file that needs no
 * network. It has the paths as filmed and as stabilized, the shake before and after, what other settings would leave,
 * and frames before and after.
 */
#ifndef REPORT_H
#define REPORT_H

#include "input.h"
#include "options.h"

#include <gst/gst.h>

typedef struct Report Report;

/* For --report: checks that reports can be made, and makes the folder. */
gboolean report_check(const char *folder, GError **error);

/* Watches a stabilizer before it starts. Options and input must outlive the report. orientation: how videoflip would
 * turn the picture upright, or NULL. duration: of the output in nanoseconds, 0 if it is not known. */
Report *report_new(const Options *options, Input *input, GstElement *stabilizer, const char *orientation,
                   gint64 duration);
void report_free(Report *report);

/* Takes an element message. */
void report_add(Report *report, const GstStructure *message);

/* Writes the files after the pipeline was stopped. They are named after the output. */
gboolean report_write(Report *report, const char *output, GError **error);

#endif
