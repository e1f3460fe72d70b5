/* SPDX-License-Identifier: MIT */
/* One input, one output: the reader's thread feeds the picture's pipeline and the output, the main loop watches. */
#ifndef JOB_H
#define JOB_H

#include "encoder.h"
#include "input.h"
#include "options.h"
#include "picture.h"

/* Stabilizes a file into `out`, or into a window
    if that is NULL. Says what it does and what goes wrong. Returns the exit
 * code. */
int job_run(const Options *options, const char *in, const char *out);

/* Runs the picture of an input to its end, without output. on_message gets the element messages. FALSE sets *error. */
typedef void (*JobMessage)(void *cookie, const GstStructure *message);
gboolean job_analyze(const Options *options, Input *input, JobMessage on_message, void *cookie, GError **error);

/* Opens the input, and says which of several video streams it takes. */
Input *job_open(const Options *options, const char *in, GError **error);

#endif
