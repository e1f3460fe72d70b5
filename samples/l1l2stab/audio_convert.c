/* SPDX-License-Identifier: MIT */
#include "audio_convert.h"

#include <libavcodec/avcodec.h>
#include <libavutil/audio_fifo.h>
#include <libavutil/channel_layout.h>
#include <libswresample/swresample.h>

#define BITS_PER_CHANNEL 96000 /* per second; AAC and Opus are transparent for nearly everybody there */
#define DEFAULT_FRAME 1024     /* samples, for encoders that take any number */

struct AudioConvert {
    AVCodecContext *decoder, *encoder;
    SwrContext *resampler;
    AVAudioFifo *fifo;      /* decoded samples that do not fill an encoder's frame yet */
    AVFrame *decoded;
    AVPacket *encoded;
    AVRational in_time_base;
    gint64 next;            /* timestamp of the first sample in fifo, in 1/rate; AV_NOPTS_VALUE: none came yet */
    int stream;             /* index of the output's stream */
};

static AVCodecContext *open_decoder(const AVStream *in)
{
    const AVCodec *codec = avcodec_find_decoder(in->codecpar->codec_id);
    AVCodecContext *decoder = codec ? avcodec_alloc_context3(codec) : NULL;
    if (!decoder)
        return NULL;
    decoder->pkt_timebase = in->time_base;
    if (avcodec_parameters_to_context(decoder, in->codecpar) < 0 || avcodec_open2(decoder, codec, NULL) < 0)
        avcodec_free_context(&decoder);
    else if (decoder->ch_layout.order == AV_CHANNEL_ORDER_UNSPEC)
        av_channel_layout_default(&decoder->ch_layout, decoder->ch_layout.nb_channels);
    return decoder;
}

/* The encoder's sample rate: the input's own, or the nearest that the encoder has. */
static int supported_rate(const AVCodec *codec, int rate)
{
    int best = 0;
    if (!codec->supported_samplerates)
        return rate;
    for (const int *r = codec->supported_samplerates; *r; r++)
        if (!best || ABS(*r - rate) < ABS(best - rate))
            best = *r;
    return best;
}

static AVCodecContext *open_encoder(enum AVCodecID id, const AVCodecContext *decoder)
{
    const AVCodec *codec = id == AV_CODEC_ID_OPUS ? avcodec_find_encoder_by_name("libopus") : avcodec_find_encoder(id);
    AVCodecContext *encoder = codec ? avcodec_alloc_context3(codec) : NULL;
    if (!encoder)
        return NULL;
    encoder->sample_rate = supported_rate(codec, decoder->sample_rate);
    av_channel_layout_copy(&encoder->ch_layout, &decoder->ch_layout);
    encoder->sample_fmt = codec->sample_fmts ? codec->sample_fmts[0] : decoder->sample_fmt;
    encoder->bit_rate = (int64_t)BITS_PER_CHANNEL * encoder->ch_layout.nb_channels;
    encoder->time_base = (AVRational){1, encoder->sample_rate};
    encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (avcodec_open2(encoder, codec, NULL) < 0)
        avcodec_free_context(&encoder);
    return encoder;
}

AudioConvert *audio_convert_new(const AVStream *in, enum AVCodecID codec, AVStream *out)
{
    AudioConvert *convert = g_new0(AudioConvert, 1);
    convert->in_time_base = in->time_base;
    convert->next = AV_NOPTS_VALUE;
    convert->stream = out->index;
    convert->decoder = open_decoder(in);
    convert->encoder = convert->decoder ? open_encoder(codec, convert->decoder) : NULL;
    AVCodecContext *from = convert->decoder, *to = convert->encoder;
    if (!to || swr_alloc_set_opts2(&convert->resampler, &to->ch_layout, to->sample_fmt, to->sample_rate,
                                   &from->ch_layout, from->sample_fmt, from->sample_rate, 0, NULL) < 0 ||
        swr_init(convert->resampler) < 0 || avcodec_parameters_from_context(out->codecpar, to) < 0) {
        audio_convert_free(convert);
        return NULL;
    }
    convert->fifo = av_audio_fifo_alloc(to->sample_fmt, to->ch_layout.nb_channels, DEFAULT_FRAME);
    convert->decoded = av_frame_alloc();
    convert->encoded = av_packet_alloc();
    out->time_base = to->time_base;
    return convert;
}

void audio_convert_free(AudioConvert *convert)
{
    if (!convert)
        return;
    avcodec_free_context(&convert->decoder);
    avcodec_free_context(&convert->encoder);
    swr_free(&convert->resampler);
    if (convert->fifo)
        av_audio_fifo_free(convert->fifo);
    av_frame_free(&convert->decoded);
    av_packet_free(&convert->encoded);
    g_free(convert);
}

static AVFrame *new_frame(const AVCodecContext *encoder, int samples)
{
    AVFrame *frame = av_frame_alloc();
    frame->nb_samples = samples;
    frame->format = encoder->sample_fmt;
    frame->sample_rate = encoder->sample_rate;
    av_channel_layout_copy(&frame->ch_layout, &encoder->ch_layout);
    av_frame_get_buffer(frame, 0);
    return frame;
}

static void encode(AudioConvert *convert, const AVFrame *frame, AudioConvertSink sink, void *cookie)
{
    if (avcodec_send_frame(convert->encoder, frame) < 0)
        return;
    while (avcodec_receive_packet(convert->encoder, convert->encoded) >= 0) {
        sink(cookie, convert->stream, convert->encoded);
        av_packet_unref(convert->encoded);
    }
}

/* Encodes what is in the fifo in frames of the encoder's size. The last one may be shorter. */
static void encode_fifo(AudioConvert *convert, gboolean all, AudioConvertSink sink, void *cookie)
{
    const int size = convert->encoder->frame_size ? convert->encoder->frame_size : DEFAULT_FRAME;
    int left;
    while ((left = av_audio_fifo_size(convert->fifo)) >= size || (all && left > 0)) {
        AVFrame *frame = new_frame(convert->encoder, MIN(left, size));
        av_audio_fifo_read(convert->fifo, (void **)frame->extended_data, frame->nb_samples);
        frame->pts = convert->next;
        convert->next += frame->nb_samples;
        encode(convert, frame, sink, cookie);
        av_frame_free(&frame);
    }
}

/* frame NULL: the samples that the resampler holds back. */
static void resample(AudioConvert *convert, const AVFrame *frame)
{
    const int most = swr_get_out_samples(convert->resampler, frame ? frame->nb_samples : 0);
    if (most <= 0)
        return;
    AVFrame *converted = new_frame(convert->encoder, most);
    const int count = swr_convert(convert->resampler, converted->extended_data, most,
                                  frame ? (const uint8_t **)frame->extended_data : NULL, frame ? frame->nb_samples : 0);
    if (count > 0)
        av_audio_fifo_write(convert->fifo, (void **)converted->extended_data, count);
    av_frame_free(&converted);
}

void audio_convert_push(AudioConvert *convert, const AVPacket *packet, AudioConvertSink sink, void *cookie)
{
    if (avcodec_send_packet(convert->decoder, packet) < 0 && packet)
        return; /* a damaged packet is left out */
    while (avcodec_receive_frame(convert->decoder, convert->decoded) >= 0) {
        if (convert->next == AV_NOPTS_VALUE)
            convert->next = convert->decoded->pts == AV_NOPTS_VALUE
                                ? 0 : av_rescale_q(convert->decoded->pts, convert->in_time_base,
                                                   convert->encoder->time_base);
        resample(convert, convert->decoded);
        encode_fifo(convert, FALSE, sink, cookie);
    }
    if (!packet && convert->next != AV_NOPTS_VALUE) {
        resample(convert, NULL);
        encode_fifo(convert, TRUE, sink, cookie);
        encode(convert, NULL, sink, cookie);
    }
}
