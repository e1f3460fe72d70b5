/* SPDX-License-Identifier: MIT */
/* Rewrites text subtitles for a container that has its own kind, such as SubRip for MP4. Pictures are not rewritten. */
#ifndef SUBTITLE_CONVERT_H
#define SUBTITLE_CONVERT_H

#include <glib.h>
#include <libavformat/avformat.h>

typedef struct SubtitleConvert SubtitleConvert;

/* Describes the new stream in *out. Returns NULL if that is not possible. */
SubtitleConvert *subtitle_convert_new(const AVStream *in, enum AVCodecID codec, AVStream *out);
void subtitle_convert_free(SubtitleConvert *convert);

/* Replaces the packet's data; the timestamps stay as they are. FALSE: it has no text. */
gboolean subtitle_convert_packet(SubtitleConvert *convert, AVPacket *packet);

#endif
