/* SPDX-License-Identifier: MIT */
/*
 * Is the end of a file missing? Most containers state the sizes of their parts. A file that is shorter than its parts
 * was cut off: by a full card, a broken download, an empty battery.
 */
#ifndef TRUNCATION_H
#define TRUNCATION_H

#include <glib.h>

/* Number of bytes that are missing at the end of a regular file; 0: none, or the container does not tell. */
gint64 truncation_missing_bytes(int fd);

#endif
