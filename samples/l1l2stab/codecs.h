/* SPDX-License-Identifier: MIT */
/* Between the two frameworks: what libavformat calls a codec, and the caps that GStreamer knows it by. */
#ifndef CODECS_H
#define CODECS_H

#include <gst/gst.h>
#include <libavformat/avformat.h>

/* The caps of the packets of a video stream, with all that the container says about its picture. */
GstCaps *codecs_caps(const AVFormatContext *format, AVStream *stream);

/* Describes what an encoder's packets are: codec, size, color, extra data and HDR side data. FALSE: not known. */
gboolean codecs_describe(const GstCaps *encoded, const GstCaps *raw, AVStream *stream);

/* For an encoder whose caps have no extra data: finds them in its first packet. */
void codecs_find_extradata(AVStream *stream, const AVPacket *first);

/* The Debian package that has the decoder of a codec. NULL: none is known. */
const char *codecs_package(enum AVCodecID id);

#endif
