/* SPDX-License-Identifier: MIT */
/*
 * What the program says: notes, errors, progress and results.
 *
 * People read stderr: one line that is overwritten on a terminal, and otherwise plain lines,
     at most one in 5 s. Programs
 * read --json from stdout: one object in each line, with a "type".
 */
#ifndef SAY_H
#define SAY_H

#include <glib.h>

void say_init(gboolean json, gboolean quiet, gboolean verbose);

/* Something that the user should know: a stream that was left out, a column that was cut off. */
void say_note(const char *format, ...) G_GNUC_PRINTF(1, 2);

/* Something for --verbose. */
void say_detail(const char *format, ...) G_GNUC_PRINTF(1, 2);

void say_error(const char *text);

typedef struct Progress {
    const char *file;      /* printable */
    gint64 frames;         /* that are done */
    double seconds;        /* of the input that is done */
    double duration;       /* of the input; 0: not known */
    double elapsed;        /* seconds of the clock */
    gint64 bytes;          /* of the output */
} Progress;

/* Shows the progress if it is time for it. Call it some times a second. */
void say_progress(const Progress *progress);

/* Ends a line of progress on the terminal, and prints what was done. out: printable, or NULL. */
void say_done(const Progress *progress, const char *out, int exit_code);

/* One line of --json that is ready, and the text for people, which may be NULL. */
void say_result(const char *json, const char *text);

/* A text in quotes for JSON. Freed with g_free(). */
char *say_json_string(const char *text);

#endif
