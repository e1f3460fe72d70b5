/* SPDX-License-Identifier: MIT */
/*
 * Many files. Each is stabilized by a process of its own, which runs this program for one file: a decoder that crashes,
 * or leaks, costs one file.
 *
 * An output has its name only when it is complete. So a batch that was ended goes on where it was with --skip-existing.
 */
#ifndef BATCH_H
#define BATCH_H

#include "options.h"

/* Returns the exit code. */
int batch_run(const Options *options);

/* The name of the output of an input, to be freed. */
char *batch_output_name(const Options *options, const char *in);

#endif
