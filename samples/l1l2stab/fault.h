/* SPDX-License-Identifier: MIT */
/* What went wrong, in one line, and the exit code that says whose fault it is. */
#ifndef FAULT_H
#define FAULT_H

#include <glib.h>

/* The exit codes. l1l2stab.1 lists them. A signal's number is added to EXIT_SIGNAL. */
enum {
    EXIT_DONE = 0,
    EXIT_OTHER = 1,   /* anything that is not below */
    EXIT_USAGE = 2,   /* an option or the command line is wrong */
    EXIT_INPUT = 3,   /* the input cannot be read, or has no picture that can be stabilized */
    EXIT_OUTPUT = 4,  /* the output cannot be written */
    EXIT_PLUGIN = 5,  /* a decoder, an encoder or the element is not installed */
    EXIT_DAMAGED = 6, /* the output is there, but the input is truncated or damaged: it has what could be read */
    EXIT_BATCH = 7,   /* some files of a batch failed */
    EXIT_SIGNAL = 128
};

/* The domain of the errors of this program. The code of an error is the exit code. */
#define FAULT (fault_quark())
GQuark fault_quark(void);

/* Sets *error, unless it is set already or error is NULL. Returns FALSE. */
gboolean fault(GError **error, int exit_code, const char *format, ...) G_GNUC_PRINTF(3, 4);

/* A copy of a file name for a line of text: what is not printable becomes a question mark. */
char *printable(const char *name);

#endif
