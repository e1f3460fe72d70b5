/* SPDX-License-Identifier: MIT */
/*
 * The library in an application on libavformat and libavcodec: decode, push, pull, encode. The video alone is written.
 *
 *     stabilize-libav IN OUT
 *
 * The name of OUT chooses the container, and the container the encoder. The library keeps references to decoded frames,
 * so no picture is copied.
 */
#include <l1l2stab/l1l2stab.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <stdio.h>

typedef struct App {
    AVFormatContext *in, *out;
    AVStream *video; /* of `in` */
    AVCodecContext *decoder, *encoder;
    AVPacket *demuxed, *encoded;
    L1L2Stab *stab;
    int64_t last_pts;
} App;

static int open_decoder(App *a, const char *name)
{
    const AVCodec *codec = NULL;
    int r = avformat_open_input(&a->in, name, NULL, NULL);
    if (r < 0 || (r = avformat_find_stream_info(a->in, NULL)) < 0 ||
        (r = av_find_best_stream(a->in, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0)) < 0)
        return r;
    a->video = a->in->streams[r];
    if (!(a->decoder = avcodec_alloc_context3(codec)))
        return AVERROR(ENOMEM);
    r = avcodec_parameters_to_context(a->decoder, a->video->codecpar);
    return r < 0 ? r : avcodec_open2(a->decoder, codec, NULL);
}

static void log_line(void *cookie, L1L2StabLogLevel level, const char *message)
{
    (void)cookie, (void)level;
    fprintf(stderr, "l1l2stab: %s\n", message);
}

/* plugin/ffmpeg/vf_l1l2stab.c has a table of all formats. */
static L1L2StabFormat format_of(enum AVPixelFormat format)
{
    switch (format) {
    case AV_PIX_FMT_YUV420P:
    case AV_PIX_FMT_YUVJ420P: return L1L2STAB_FORMAT_I420;
    case AV_PIX_FMT_YUV422P: return L1L2STAB_FORMAT_Y42B;
    case AV_PIX_FMT_YUV420P10LE: return L1L2STAB_FORMAT_I420_10LE;
    default: return L1L2STAB_FORMAT_UNKNOWN; /* l1l2stab_create() refuses it, and says so */
    }
}

static int open_stabilizer(App *a)
{
    const AVRational rate = av_guess_frame_rate(a->in, a->video, NULL);
    const AVRational aspect = av_guess_sample_aspect_ratio(a->in, a->video, NULL);
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = format_of(a->decoder->pix_fmt);
    cfg.width = a->decoder->width;
    cfg.height = a->decoder->height;
    cfg.frame_rate = rate.num > 0 ? av_q2d(rate) : 0;
    cfg.pixel_aspect = aspect.num > 0 ? av_q2d(aspect) : 1;
    cfg.logger.write = log_line;
    cfg.logger.max_level = L1L2STAB_LOG_WARN;
    return l1l2stab_create(&a->stab, &cfg) == L1L2STAB_OK ? 0 : AVERROR(EINVAL);
}

/* The output has the format, the colors and the times of the input. */
static int open_encoder(App *a, const char *name)
{
    int r = avformat_alloc_output_context2(&a->out, NULL, NULL, name);
    const AVCodec *codec = r < 0 ? NULL : avcodec_find_encoder(a->out->oformat->video_codec);
    if (!codec)
        return r < 0 ? r : AVERROR_ENCODER_NOT_FOUND;
    AVStream *stream = avformat_new_stream(a->out, NULL);
    if (!stream || !(a->encoder = avcodec_alloc_context3(codec)))
        return AVERROR(ENOMEM);
    a->encoder->width = a->decoder->width;
    a->encoder->height = a->decoder->height;
    a->encoder->pix_fmt = a->decoder->pix_fmt;
    a->encoder->sample_aspect_ratio = av_guess_sample_aspect_ratio(a->in, a->video, NULL);
    a->encoder->color_range = a->decoder->color_range;
    a->encoder->color_primaries = a->decoder->color_primaries;
    a->encoder->color_trc = a->decoder->color_trc;
    a->encoder->colorspace = a->decoder->colorspace;
    a->encoder->framerate = av_guess_frame_rate(a->in, a->video, NULL);
    a->encoder->time_base = stream->time_base = a->video->time_base;
    if (a->out->oformat->flags & AVFMT_GLOBALHEADER)
        a->encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if ((r = avcodec_open2(a->encoder, codec, NULL)) < 0 ||
        (r = avcodec_parameters_from_context(stream->codecpar, a->encoder)) < 0 ||
        (r = avio_open(&a->out->pb, name, AVIO_FLAG_WRITE)) < 0)
        return r;
    return avformat_write_header(a->out, NULL);
}

/* NULL: the end. */
static int encode(App *a, const AVFrame *frame)
{
    int r = avcodec_send_frame(a->encoder, frame);
    while (r >= 0 && (r = avcodec_receive_packet(a->encoder, a->encoded)) >= 0) {
        av_packet_rescale_ts(a->encoded, a->encoder->time_base, a->out->streams[0]->time_base);
        r = av_interleaved_write_frame(a->out, a->encoded); /* takes the packet's content */
    }
    return r == AVERROR(EAGAIN) || r == AVERROR_EOF ? 0 : r;
}

static void set_planes(L1L2StabFrame *planes, const AVFrame *frame)
{
    for (int i = 0; i < 4; i++) {
        planes->data[i] = frame->data[i];
        planes->stride[i] = frame->linesize[i];
    }
}

/* Renders the frames that are ready and encodes them. Each has the time and the colors of its source. */
static int pull(App *a)
{
    void *source;
    int r = 0;
    while (r >= 0 && l1l2stab_peek(a->stab, NULL, &source) == L1L2STAB_OK) {
        L1L2StabFrame planes = {0};
        AVFrame *frame = av_frame_alloc();
        if (!frame)
            return AVERROR(ENOMEM);
        frame->format = a->encoder->pix_fmt;
        frame->width = a->encoder->width;
        frame->height = a->encoder->height;
        if ((r = av_frame_get_buffer(frame, 0)) >= 0 && (r = av_frame_copy_props(frame, source)) >= 0) {
            frame->pict_type = AV_PICTURE_TYPE_NONE; /* the encoder chooses */
            set_planes(&planes, frame);
            r = l1l2stab_pull(a->stab, &planes, NULL) == L1L2STAB_OK ? encode(a, frame) : AVERROR_EXTERNAL;
        }
        av_frame_free(&frame);
    }
    return r;
}

static void release_frame(void *opaque)
{
    AVFrame *frame = opaque;
    av_frame_free(&frame);
}

/* Takes the frame: the library holds it until it has been rendered. */
static int push(App *a, AVFrame *frame)
{
    L1L2StabFrame in = {.opaque = frame, .release = release_frame};
    const AVCodecContext *as = a->encoder;
    frame->pts = frame->best_effort_timestamp;
    if (frame->pts == AV_NOPTS_VALUE || frame->pts <= a->last_pts)
        frame->pts = a->last_pts + 1; /* B-frames in AVI, which has no presentation times */
    a->last_pts = frame->pts;
    in.pts = av_rescale_q(frame->pts, a->video->time_base, (AVRational){1, 1000000000});
    set_planes(&in, frame);
    if (frame->width == as->width && frame->height == as->height && frame->format == as->pix_fmt &&
        l1l2stab_push(a->stab, &in) == L1L2STAB_OK)
        return pull(a);
    av_frame_free(&frame);
    return AVERROR(EINVAL); /* frames that change their size or format need a new stabilizer and a new encoder */
}

/* NULL: the end. */
static int decode(App *a, const AVPacket *packet)
{
    int r = avcodec_send_packet(a->decoder, packet);
    while (r >= 0) {
        AVFrame *frame = av_frame_alloc();
        if (!frame)
            return AVERROR(ENOMEM);
        if ((r = avcodec_receive_frame(a->decoder, frame)) >= 0)
            r = push(a, frame);
        else
            av_frame_free(&frame);
    }
    return r == AVERROR(EAGAIN) || r == AVERROR_EOF ? 0 : r;
}

static int run(App *a)
{
    int r = 0;
    while (r >= 0 && (r = av_read_frame(a->in, a->demuxed)) >= 0) {
        r = a->demuxed->stream_index == a->video->index ? decode(a, a->demuxed) : 0;
        av_packet_unref(a->demuxed);
    }
    if (r != AVERROR_EOF || (r = decode(a, NULL)) < 0)
        return r;
    l1l2stab_finish(a->stab);
    if ((r = pull(a)) < 0 || (r = encode(a, NULL)) < 0)
        return r;
    return av_write_trailer(a->out);
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: stabilize-libav IN OUT\n");
        return 2;
    }
    av_log_set_level(AV_LOG_WARNING);
    App a = {.demuxed = av_packet_alloc(), .encoded = av_packet_alloc(), .last_pts = -1};
    int r = a.demuxed && a.encoded ? 0 : AVERROR(ENOMEM);
    if (r < 0 || (r = open_decoder(&a, argv[1])) < 0 || (r = open_stabilizer(&a)) < 0 ||
        (r = open_encoder(&a, argv[2])) < 0 || (r = run(&a)) < 0)
        fprintf(stderr, "stabilize-libav: %s\n", av_err2str(r));

    l1l2stab_free(&a.stab); /* gives back the frames that it holds */
    avcodec_free_context(&a.encoder);
    avcodec_free_context(&a.decoder);
    if (a.out)
        avio_closep(&a.out->pb);
    avformat_free_context(a.out);
    avformat_close_input(&a.in);
    av_packet_free(&a.encoded);
    av_packet_free(&a.demuxed);
    return r < 0;
}
