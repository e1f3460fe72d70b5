/* SPDX-License-Identifier: MIT */
/* Analysis alone: how much a video shakes, what makes it difficult, and what each crop would leave. */
#ifndef ESTIMATE_H
#define ESTIMATE_H

#include "options.h"

/* Prints the analysis. Returns the exit code. */
int estimate_run(const Options *options, const char *in);

/* For --crop auto: adds the property crop-ratio to the options. Returns the exit code. */
int estimate_choose_crop(Options *options, const char *in);

#endif
