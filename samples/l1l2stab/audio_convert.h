/* SPDX-License-Identifier: MIT */
/* Encodes an audio stream anew, for a container that does not take the input's codec. All others are copied. */
#ifndef AUDIO_CONVERT_H
#define AUDIO_CONVERT_H

#include <glib.h>
#include <libavformat/avformat.h>

typedef struct AudioConvert AudioConvert;

/* Takes a packet, which it may move from. Its timestamps are in audio_convert_time_base(). */
typedef void (*AudioConvertSink)(void *cookie, int stream, AVPacket *packet);

/* Describes the new stream in *out. Returns NULL if the codec cannot be decoded or encoded. */
AudioConvert *audio_convert_new(const AVStream *in, enum AVCodecID codec, AVStream *out);
void audio_convert_free(AudioConvert *convert);

/* packet NULL: the end. */
void audio_convert_push(AudioConvert *convert, const AVPacket *packet, AudioConvertSink sink, void *cookie);

#endif
