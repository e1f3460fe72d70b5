/* SPDX-License-Identifier: MIT */
/*
 * The command line.
 *
 * There are two tables: that of the program's own options in options.c, and the properties of the element, which this
 * program asks the element for. The parser, --help and --complete all use these two. The manual page, l1l2stab.1, has
 * the same options, and a test compares them.
 */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <gst/gst.h>

typedef enum Compare { COMPARE_NONE, COMPARE_SIDE, COMPARE_SPLIT, COMPARE_FLIP } Compare;

typedef struct Options {
    char **inputs;       /* file names, NULL at the end */
    int input_count;
    char *out, *out_dir, *suffix;
    char *format;        /* suffix of the output's names in a batch, such as "mkv" */
    int stream;          /* index of the video stream, or ANY_STREAM */

    char *encoder;       /* NAME[:key=value...], or NULL: chosen by the input and the output's name */
    double crf;          /* < 0: the encoder's default */
    int bitrate;         /* kbit/s; 0: constant quality */
    char *preset;

    gint64 start_us, end_us; /* of the input; end_us -1: to its end */
    Compare compare;
    gboolean preview, estimate;
    char *report;        /* folder, or NULL */

    gboolean crop_auto;      /* --crop auto */
    double keep;             /* share of the steadying that --crop auto keeps, 0 to 1 */

    gboolean batch, skip_existing;
    int jobs;            /* 0: by the number of cores */

    gboolean json, quiet, verbose;

    GPtrArray *settings; /* the element's properties: name, value, name, value ... */
} Options;

/* What main() does after the command line was read. */
typedef enum OptionsResult { OPTIONS_RUN, OPTIONS_SHOWN, OPTIONS_WRONG } OptionsResult;

/* Reads the command line. OPTIONS_SHOWN: --help or the like was all that was asked for. OPTIONS_WRONG sets *error. */
OptionsResult options_parse(Options *options, int argc, char **argv, GError **error);
void options_clear(Options *options);

/* Sets the element's properties that were given. */
gboolean options_apply(const Options *options, GstElement *stabilizer, GError **error);

/* The command line that gives a process for one file the same options,
    without the names. Freed by g_ptr_array_unref(). */
GPtrArray *options_for_one_file(const Options *options);

#endif
