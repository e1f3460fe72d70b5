/* SPDX-License-Identifier: MIT */
#include "subtitle_convert.h"

#include <libavcodec/avcodec.h>
#include <string.h>

#define MAX_BYTES (1 << 16) /* of one subtitle */

struct SubtitleConvert {
    AVCodecContext *decoder, *encoder;
    AVRational time_base;
};

static gboolean is_text(enum AVCodecID id)
{
    const AVCodecDescriptor *descriptor = avcodec_descriptor_get(id);
    return descriptor && (descriptor->props & AV_CODEC_PROP_TEXT_SUB);
}

static AVCodecContext *open_decoder(const AVStream *in)
{
    const AVCodec *codec = avcodec_find_decoder(in->codecpar->codec_id);
    AVCodecContext *decoder = codec ? avcodec_alloc_context3(codec) : NULL;
    if (decoder) {
        decoder->pkt_timebase = in->time_base;
        if (avcodec_parameters_to_context(decoder, in->codecpar) < 0 || avcodec_open2(decoder, codec, NULL) < 0)
            avcodec_free_context(&decoder);
    }
    return decoder;
}

/* The encoders read the styles that the decoder has found. */
static AVCodecContext *open_encoder(enum AVCodecID id, const AVCodecContext *decoder)
{
    const AVCodec *codec = avcodec_find_encoder(id);
    AVCodecContext *encoder = codec ? avcodec_alloc_context3(codec) : NULL;
    if (encoder) {
        encoder->time_base = (AVRational){1, 1000};
        if (decoder->subtitle_header_size > 0) {
            encoder->subtitle_header = av_mallocz((size_t)decoder->subtitle_header_size + 1);
            memcpy(encoder->subtitle_header, decoder->subtitle_header, (size_t)decoder->subtitle_header_size);
            encoder->subtitle_header_size = decoder->subtitle_header_size;
        }
        if (avcodec_open2(encoder, codec, NULL) < 0)
            avcodec_free_context(&encoder);
    }
    return encoder;
}

SubtitleConvert *subtitle_convert_new(const AVStream *in, enum AVCodecID codec, AVStream *out)
{
    if (!is_text(in->codecpar->codec_id))
        return NULL;
    SubtitleConvert *convert = g_new0(SubtitleConvert, 1);
    convert->time_base = in->time_base;
    convert->decoder = open_decoder(in);
    convert->encoder = convert->decoder ? open_encoder(codec, convert->decoder) : NULL;
    if (!convert->encoder || avcodec_parameters_from_context(out->codecpar, convert->encoder) < 0) {
        subtitle_convert_free(convert);
        return NULL;
    }
    return convert;
}

void subtitle_convert_free(SubtitleConvert *convert)
{
    if (!convert)
        return;
    avcodec_free_context(&convert->decoder);
    avcodec_free_context(&convert->encoder);
    g_free(convert);
}

gboolean subtitle_convert_packet(SubtitleConvert *convert, AVPacket *packet)
{
    AVSubtitle subtitle;
    int got = 0;
    if (avcodec_decode_subtitle2(convert->decoder, &subtitle, &got, packet) < 0 || !got)
        return FALSE;
    uint8_t *text = av_mallocz(MAX_BYTES);
    const int size = subtitle.num_rects ? avcodec_encode_subtitle(convert->encoder, text, MAX_BYTES, &subtitle) : 0;
    AVPacket *rewritten = size > 0 ? av_packet_alloc() : NULL;
    const gboolean ok = rewritten && av_new_packet(rewritten, size) >= 0;
    if (ok) {
        memcpy(rewritten->data, text, (size_t)size);
        rewritten->pts = packet->pts;
        rewritten->dts = packet->dts;
        rewritten->duration = packet->duration;
        rewritten->flags = packet->flags;
        rewritten->stream_index = packet->stream_index;
        av_packet_unref(packet);
        av_packet_move_ref(packet, rewritten);
    }
    av_packet_free(&rewritten);
    av_free(text);
    avsubtitle_free(&subtitle);
    return ok;
}
