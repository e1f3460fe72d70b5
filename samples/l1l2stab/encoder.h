/* SPDX-License-Identifier: MIT */
/*
 * Which encoder makes the output's picture, with which settings, and what it accepts.
 *
 * The codec of the input is kept if the output's container takes it and an encoder for it is installed. Otherwise the
 * container's first codec that is installed and has enough bits is used.
 */
#ifndef ENCODER_H
#define ENCODER_H

#include "options.h"

#include <libavformat/avformat.h>

typedef struct Encoder {
    char *launch;          /* the encoder, named "encoder", and its parser, in the syntax of gst_parse_launch() */
    char **properties;     /* key, value, ... that --encoder gave, NULL at the end; or NULL */
    char *raw_formats;     /* the formats of the raw picture, as in caps */
    gboolean even_size;    /* an odd width or height is refused */
    char *summary;         /* for people */
} Encoder;

/* The containers, by the suffix of a name, without regard to case. NULL: not known. */
typedef struct Container {
    const char *suffix;    /* ".mp4" */
    const char *muxer;     /* libavformat's name */
    const char *codecs;    /* names of the encoders' codecs, best first */
    gboolean rotation;     /* has a place for the display matrix */
} Container;
const Container *container_of(const char *name);

/* All suffixes, for a message. */
#define CONTAINER_SUFFIXES ".mp4, .m4v, .mov, .mkv, .webm, .ts, .m2ts, .mts or .avi"

gboolean encoder_choose(Encoder *encoder, const Options *options, const Container *container, const AVStream *video,
                        GError **error);
void encoder_clear(Encoder *encoder);

/* Prints the encoders that are installed. */
void encoder_list(void);

#endif
