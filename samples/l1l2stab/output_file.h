/* SPDX-License-Identifier: MIT */
/*
 * The output file, which has its name only once it is complete.
 *
 * Until then it has no name at all (O_TMPFILE), so that nothing is left of it even if this program is killed. On file
 * systems that cannot do that it has a hidden temporary name, which output_file_discard() removes.
 */
#ifndef OUTPUT_FILE_H
#define OUTPUT_FILE_H

#include <glib.h>

typedef struct OutputFile OutputFile;

/* Checks a name before anything is decoded. input: the output must not be this file. */
gboolean output_file_check(const char *name, const char *input, GError **error);

OutputFile *output_file_open(const char *name, GError **error);
int output_file_fd(const OutputFile *file);

/* Gives the file its name, or another one in the same folder, and frees it. A file of that name is replaced. */
gboolean output_file_commit(OutputFile *file, const char *name, GError **error);

/* Drops the file. NULL is fine. */
void output_file_discard(OutputFile *file);

/* "film.mp4": "film.partial.mp4". */
char *output_file_partial_name(const char *name);

#endif
