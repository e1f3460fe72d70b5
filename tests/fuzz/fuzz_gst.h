/* SPDX-License-Identifier: MIT */
/* What the targets of the element share: GStreamer without any plugin but our element, which is linked in. */
#ifndef FUZZ_GST_H
#define FUZZ_GST_H

#include <gst/gst.h>

#include "fuzz_input.h"

/* Initializes GStreamer once. */
void fuzz_gst_init(void);

/* An element with a bus of its own, which keeps its messages. */
GstElement *fuzz_element_new(void);
void fuzz_element_free(GstElement *element);

/* Takes all messages. Returns the number of errors, and checks that each has a text. */
int fuzz_count_errors(GstElement *element);

/* A file in memory, and the name by which the code under test opens it. */
typedef struct FuzzFile {
    int fd;
    char name[64];
} FuzzFile;

FuzzFile fuzz_file_new(const uint8_t *data, size_t size);
void fuzz_file_free(FuzzFile *file);

#endif
