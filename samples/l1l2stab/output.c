/* SPDX-License-Identifier: MIT */
#include "output.h"

#include "audio_convert.h"
#include "codecs.h"
#include "fault.h"
#include "output_file.h"
#include "say.h"
#include "subtitle_convert.h"

#include <errno.h>
#include <libavcodec/avcodec.h>
#include <libavutil/display.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER_BYTES (1 << 18)
#define NANOSECONDS ((AVRational){1, 1000000000})
#define MOV_FAMILY(muxer) (strcmp(muxer, "mp4") == 0 || strcmp(muxer, "mov") == 0)

/* What becomes of a stream of the input. */
typedef struct Route {
    AVStream *out;            /* NULL: it is left out */
    AudioConvert *audio;      /* NULL: copied */
    SubtitleConvert *subtitle;
} Route;

/* A packet that waits for the picture. */
typedef struct Waiting {
    AVPacket *packet;
    AVRational time_base;
    gint64 time_us;
} Waiting;

struct Output {
    const Input *input;
    const Container *container;
    AVFormatContext *format;
    OutputFile *file;
    char *name;
    Route *routes;            /* by index of the input's stream */
    AVStream *video;
    gint64 *last_dts;         /* by index of the output's stream, in its time base */
    gint64 start_us, end_us;  /* the part of the input that is taken */
    gint64 reached_us;        /* end of the picture that is written */
    GMutex lock;              /* for all below, and for format once it is started */
    GQueue waiting;           /* of Waiting */
    gboolean started, copied_all;
    gint64 bytes;             /* of the complete file */
    int write_errno;
    int left_out;             /* packets that were copied and that the container refused */
    GError *fault;
};

/* ---- the file below libavformat ---- */

#if LIBAVFORMAT_VERSION_MAJOR >= 61
typedef const uint8_t Written;
#else
typedef uint8_t Written;
#endif

static int write_file(void *data, Written *bytes, int size)
{
    Output *output = data;
    int done = 0;
    while (done < size) {
        const ssize_t count = write(output_file_fd(output->file), bytes + done, (size_t)(size - done));
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0) {
            output->write_errno = errno;
            return AVERROR(errno);
        }
        done += (int)count;
    }
    return size;
}

/* The muxer for MP4 reads back nothing, so writing is enough. */
static int64_t seek_file(void *data, int64_t offset, int whence)
{
    const Output *output = data;
    if (whence & AVSEEK_SIZE)
        return -1;
    const off_t reached = lseek(output_file_fd(output->file), offset, whence & ~AVSEEK_FORCE);
    return reached < 0 ? AVERROR(errno) : reached;
}

static void fail(Output *output, int code)
{
    char *shown = printable(output->name);
    if (output->write_errno == ENOSPC || output->write_errno == EDQUOT)
        fault(&output->fault, EXIT_OUTPUT, "%s: the disk is full", shown);
    else if (output->write_errno)
        fault(&output->fault, EXIT_OUTPUT, "%s: cannot be written: %s", shown, g_strerror(output->write_errno));
    else
        fault(&output->fault, EXIT_OUTPUT, "%s: the container %s refuses it: %s", shown, output->container->muxer,
              av_err2str(code));
    g_free(shown);
}

/* ---- streams ---- */

static gboolean takes(const Output *output, enum AVCodecID id)
{
    static const enum AVCodecID transport[] = {AV_CODEC_ID_AAC, AV_CODEC_ID_AAC_LATM, AV_CODEC_ID_AC3, AV_CODEC_ID_EAC3,
                                               AV_CODEC_ID_MP1, AV_CODEC_ID_MP2, AV_CODEC_ID_MP3, AV_CODEC_ID_DTS,
                                               AV_CODEC_ID_TRUEHD, AV_CODEC_ID_OPUS, AV_CODEC_ID_DVB_SUBTITLE,
                                               AV_CODEC_ID_DVB_TELETEXT, AV_CODEC_ID_H264, AV_CODEC_ID_HEVC,
                                               AV_CODEC_ID_MPEG2VIDEO};
    if (strcmp(output->container->muxer, "mpegts") != 0)
        return avformat_query_codec(output->format->oformat, id, FF_COMPLIANCE_NORMAL) == 1;
    for (size_t i = 0; i < G_N_ELEMENTS(transport); i++)
        if (transport[i] == id)
            return TRUE;
    return FALSE;
}

static enum AVCodecID audio_codec_for(const Output *output)
{
    if (strcmp(output->container->muxer, "webm") == 0)
        return AV_CODEC_ID_OPUS;
    return strcmp(output->container->muxer, "avi") == 0 ? AV_CODEC_ID_MP3 : AV_CODEC_ID_AAC;
}

static enum AVCodecID subtitle_codec_for(const Output *output)
{
    if (MOV_FAMILY(output->container->muxer))
        return AV_CODEC_ID_MOV_TEXT;
    return strcmp(output->container->muxer, "webm") == 0   ? AV_CODEC_ID_WEBVTT
           : strcmp(output->container->muxer, "matroska") == 0 ? AV_CODEC_ID_SUBRIP
                                                              : AV_CODEC_ID_NONE;
}

/* Tags that describe the input's file or its encoding, and would be wrong in the output. */
static void copy_tags(AVDictionary **out, AVDictionary *in)
{
    static const char *const stale[] = {"major_brand", "minor_version", "compatible_brands", "encoder", "rotate"};
    const AVDictionaryEntry *entry = NULL;
    while ((entry = av_dict_get(in, "", entry, AV_DICT_IGNORE_SUFFIX))) {
        gboolean keep = !g_str_has_prefix(entry->key, "DURATION") && !g_str_has_prefix(entry->key, "BPS") &&
                        !g_str_has_prefix(entry->key, "NUMBER_OF_") && !g_str_has_prefix(entry->key, "_STATISTICS_");
        for (size_t i = 0; i < G_N_ELEMENTS(stale); i++)
            keep = keep && g_ascii_strcasecmp(entry->key, stale[i]) != 0;
        if (keep)
            av_dict_set(out, entry->key, entry->value, 0);
    }
}

static void copy_side_data(AVStream *out, const AVStream *in)
{
    for (int i = 0; i < in->nb_side_data; i++) {
        uint8_t *data = av_stream_new_side_data(out, in->side_data[i].type, in->side_data[i].size);
        if (data)
            memcpy(data, in->side_data[i].data, in->side_data[i].size);
    }
}

static AVStream *new_stream(Output *output, const AVStream *in)
{
    AVStream *out = avformat_new_stream(output->format, NULL);
    out->time_base = in->time_base;
    out->disposition = in->disposition;
    out->id = MOV_FAMILY(output->container->muxer) ? 0 : in->id;
    copy_tags(&out->metadata, in->metadata);
    return out;
}

/* A codec's tag is kept where it is also one of the output's container. */
static void copy_parameters(const Output *output, AVStream *out, const AVStream *in)
{
    avcodec_parameters_copy(out->codecpar, in->codecpar);
    const struct AVCodecTag *const *tags = output->format->oformat->codec_tag;
    if (!tags || av_codec_get_id(tags, in->codecpar->codec_tag) != in->codecpar->codec_id)
        out->codecpar->codec_tag = 0;
    out->sample_aspect_ratio = in->sample_aspect_ratio;
    out->avg_frame_rate = in->avg_frame_rate;
    copy_side_data(out, in);
}

static const char *stream_name(const AVStream *in)
{
    const char *type = av_get_media_type_string(in->codecpar->codec_type);
    return type ? type : "data";
}

static void leave_out(const Output *output, const AVStream *in)
{
    say_note("%s: %s stream %d (%s) is left out: %s has no place for it", output->input->name, stream_name(in),
             in->index,
             avcodec_get_name(in->codecpar->codec_id), output->container->suffix);
}

/* The cover picture of a Matroska file is an attachment. */
static void route_cover(Output *output, Route *route, const AVStream *in)
{
    const gboolean matroska = strcmp(output->container->muxer, "matroska") == 0;
    if (!matroska && !takes(output, in->codecpar->codec_id)) {
        leave_out(output, in);
        return;
    }
    route->out = new_stream(output, in);
    copy_parameters(output, route->out, in);
    if (!matroska)
        return;
    AVCodecParameters *par = route->out->codecpar;
    par->codec_type = AVMEDIA_TYPE_ATTACHMENT;
    par->extradata = av_mallocz((size_t)in->attached_pic.size + AV_INPUT_BUFFER_PADDING_SIZE);
    memcpy(par->extradata, in->attached_pic.data, (size_t)in->attached_pic.size);
    par->extradata_size = in->attached_pic.size;
    const gboolean png = par->codec_id == AV_CODEC_ID_PNG;
    av_dict_set(&route->out->metadata, "filename", png ? "cover.png" : "cover.jpg", AV_DICT_DONT_OVERWRITE);
    av_dict_set(&route->out->metadata, "mimetype", png ? "image/png" : "image/jpeg", AV_DICT_DONT_OVERWRITE);
    route->out->disposition = 0;
}

static void route_audio(Output *output, Route *route, const AVStream *in)
{
    /* In a file that ends before its sound begins, nothing tells what sound it is. */
    if (in->codecpar->sample_rate <= 0) {
        say_note("%s: audio stream %d is left out: the file has no sound for it", output->input->name, in->index);
        return;
    }
    route->out = new_stream(output, in);
    if (takes(output, in->codecpar->codec_id)) {
        copy_parameters(output, route->out, in);
        return;
    }
    route->audio = audio_convert_new(in, audio_codec_for(output), route->out);
    if (route->audio)
        say_note("%s: audio stream %d is encoded anew (%s to %s): %s does not take %s", output->input->name, in->index,
                 avcodec_get_name(in->codecpar->codec_id), avcodec_get_name(audio_codec_for(output)),
                 output->container->suffix, avcodec_get_name(in->codecpar->codec_id));
    else
        fault(&output->fault, EXIT_PLUGIN, "%s: audio stream %d (%s) cannot be written to %s. Try .mkv",
              output->input->name, in->index, avcodec_get_name(in->codecpar->codec_id), output->container->suffix);
}

static void route_subtitle(Output *output, Route *route, const AVStream *in)
{
    if (takes(output, in->codecpar->codec_id)) {
        route->out = new_stream(output, in);
        copy_parameters(output, route->out, in);
        return;
    }
    /* A stream cannot be taken back, so try first whether the text can be rewritten. */
    AVFormatContext *scratch = avformat_alloc_context();
    AVStream *trial = avformat_new_stream(scratch, NULL);
    route->subtitle = subtitle_convert_new(in, subtitle_codec_for(output), trial);
    if (route->subtitle) {
        route->out = new_stream(output, in);
        avcodec_parameters_copy(route->out->codecpar, trial->codecpar);
    } else
        leave_out(output, in);
    avformat_free_context(scratch);
}

/* The time code is a tag, and the muxer makes its track anew; chapters too. The data of GoPro cameras are copied. */
static void route_data(Output *output, Route *route, const AVStream *in)
{
    const uint32_t tag = in->codecpar->codec_tag;
    if (tag == MKTAG('t', 'm', 'c', 'd') || tag == MKTAG('t', 'e', 'x', 't'))
        return;
    if (tag != MKTAG('g', 'p', 'm', 'd') || !MOV_FAMILY(output->container->muxer)) {
        leave_out(output, in);
        return;
    }
    route->out = new_stream(output, in);
    copy_parameters(output, route->out, in);
    route->out->codecpar->codec_tag = tag;
}

static void route_stream(Output *output, Route *route, const AVStream *in)
{
    switch (in->codecpar->codec_type) {
    case AVMEDIA_TYPE_VIDEO:
        if (in == output->input->video)
            route->out = output->video = new_stream(output, in);
        else if (in->disposition & AV_DISPOSITION_ATTACHED_PIC)
            route_cover(output, route, in);
        else if (takes(output, in->codecpar->codec_id)) {
            route->out = new_stream(output, in);
            copy_parameters(output, route->out, in);
        } else
            leave_out(output, in);
        break;
    case AVMEDIA_TYPE_AUDIO:
        route_audio(output, route, in);
        break;
    case AVMEDIA_TYPE_SUBTITLE:
        route_subtitle(output, route, in);
        break;
    case AVMEDIA_TYPE_ATTACHMENT:
        if (strcmp(output->container->muxer, "matroska") == 0) {
            route->out = new_stream(output, in);
            copy_parameters(output, route->out, in);
        } else
            leave_out(output, in);
        break;
    default:
        route_data(output, route, in);
    }
}

/* Side data of the picture that stay true. The color's own come from the encoder. */
static void copy_video_side_data(const Output *output)
{
    static const enum AVPacketSideDataType kept[] = {AV_PKT_DATA_DISPLAYMATRIX, AV_PKT_DATA_SPHERICAL,
                                                     AV_PKT_DATA_STEREO3D, AV_PKT_DATA_ICC_PROFILE};
    const AVStream *in = output->input->video;
    for (size_t i = 0; i < G_N_ELEMENTS(kept); i++) {
        size_t size;
        const uint8_t *data = av_stream_get_side_data(in, kept[i], &size);
        if (!data || (kept[i] == AV_PKT_DATA_DISPLAYMATRIX && !output->container->rotation))
            continue;
        uint8_t *copy = av_stream_new_side_data(output->video, kept[i], size);
        if (copy)
            memcpy(copy, data, size);
    }
}

gboolean output_needs_upright_picture(const Output *output)
{
    return !output->container->rotation &&
           av_stream_get_side_data(output->input->video, AV_PKT_DATA_DISPLAYMATRIX, NULL) != NULL;
}

static void copy_chapters(Output *output)
{
    const AVFormatContext *in = output->input->format;
    AVChapter **chapters = av_calloc(in->nb_chapters + 1, sizeof *chapters);
    for (unsigned i = 0; i < in->nb_chapters; i++) {
        const AVChapter *from = in->chapters[i];
        const gint64 shift = av_rescale_q(output->input->origin_us + output->start_us, AV_TIME_BASE_Q, from->time_base);
        const gint64 end = output->end_us < 0 ? G_MAXINT64
                           : av_rescale_q(output->end_us - output->start_us, AV_TIME_BASE_Q, from->time_base);
        if (from->end <= shift || from->start - shift >= end)
            continue;
        AVChapter *chapter = av_mallocz(sizeof *chapter);
        chapter->id = from->id;
        chapter->time_base = from->time_base;
        chapter->start = MAX(0, from->start - shift);
        chapter->end = MIN(end, from->end - shift);
        av_dict_copy(&chapter->metadata, from->metadata, 0);
        chapters[output->format->nb_chapters++] = chapter;
    }
    output->format->chapters = chapters;
}

static gboolean make_streams(Output *output)
{
    const AVFormatContext *in = output->input->format;
    output->routes = g_new0(Route, in->nb_streams);
    for (unsigned i = 0; i < in->nb_streams; i++)
        route_stream(output, &output->routes[i], in->streams[i]);
    copy_video_side_data(output);
    copy_tags(&output->format->metadata, in->metadata);
    copy_chapters(output);
    output->last_dts = g_new(gint64, output->format->nb_streams);
    for (unsigned i = 0; i < output->format->nb_streams; i++)
        output->last_dts[i] = AV_NOPTS_VALUE;
    return !output->fault;
}

Output *output_new(const Options *options, const Input *input, const char *name, const Container *container,
                   GError **error)
{
    Output *output = g_new0(Output, 1);
    output->input = input;
    output->container = container;
    output->name = g_strdup(name);
    output->start_us = options->start_us;
    output->end_us = options->end_us;
    g_mutex_init(&output->lock);
    g_queue_init(&output->waiting);
    avformat_alloc_output_context2(&output->format, NULL, container->muxer, NULL);
    output->file = output_file_open(name, error);
    if (output->file) {
        output->format->pb = avio_alloc_context(av_malloc(BUFFER_BYTES), BUFFER_BYTES, 1, output, NULL, write_file,
                                                seek_file);
        output->format->flags |= AVFMT_FLAG_CUSTOM_IO;
        if (make_streams(output))
            return output;
        output_fault(output, error);
    }
    output_free(output);
    return NULL;
}

static void free_waiting(gpointer data)
{
    Waiting *waiting = data;
    av_packet_free(&waiting->packet);
    g_free(waiting);
}

void output_free(Output *output)
{
    if (!output)
        return;
    for (unsigned i = 0; output->routes && i < output->input->format->nb_streams; i++) {
        audio_convert_free(output->routes[i].audio);
        subtitle_convert_free(output->routes[i].subtitle);
    }
    g_queue_clear_full(&output->waiting, free_waiting);
    if (output->format && output->format->pb) {
        av_freep(&output->format->pb->buffer);
        avio_context_free(&output->format->pb);
    }
    avformat_free_context(output->format);
    output_file_discard(output->file);
    g_mutex_clear(&output->lock);
    g_clear_error(&output->fault);
    g_free(output->last_dts);
    g_free(output->routes);
    g_free(output->name);
    g_free(output);
}

/* ---- writing, with the lock held ---- */

/* The muxer wants decoding times that grow. */
static void correct_times(Output *output, AVPacket *packet, const AVStream *out)
{
    gint64 *last = &output->last_dts[packet->stream_index];
    const gboolean strict = !(output->format->oformat->flags & AVFMT_TS_NONSTRICT);
    if (packet->dts == AV_NOPTS_VALUE)
        packet->dts = packet->pts != AV_NOPTS_VALUE ? packet->pts : *last == AV_NOPTS_VALUE ? 0 : *last + 1;
    if (*last != AV_NOPTS_VALUE && packet->dts < *last + (strict ? 1 : 0))
        packet->dts = *last + (strict ? 1 : 0);
    if (packet->pts == AV_NOPTS_VALUE || packet->pts < packet->dts)
        packet->pts = packet->dts;
    *last = packet->dts;
}

/* A damaged packet that is only copied does not end the output: it is left out. */
static gboolean can_leave_out(const Output *output, const AVStream *out, int code)
{
    return out != output->video && !output->write_errno && (code == AVERROR_INVALIDDATA || code == AVERROR(EINVAL));
}

static void write_packet(Output *output, AVPacket *packet, AVRational time_base)
{
    const AVStream *out = output->format->streams[packet->stream_index];
    av_packet_rescale_ts(packet, time_base, out->time_base);
    packet->pos = -1;
    correct_times(output, packet, out);
    const int code = output->fault ? 0 : av_write_frame(output->format, packet);
    if (code < 0 && can_leave_out(output, out, code))
        output->left_out++;
    else if (code < 0)
        fail(output, code);
}

/* Writes the packets of other streams up to a time. */
static void write_waiting(Output *output, gint64 until_us)
{
    Waiting *first;
    while ((first = g_queue_peek_head(&output->waiting)) && first->time_us <= until_us) {
        g_queue_pop_head(&output->waiting);
        write_packet(output, first->packet, first->time_base);
        free_waiting(first);
    }
}

/* Moves a packet, with the output's stream index, to those that wait. */
static void enqueue(Output *output, AVPacket *packet, AVRational time_base)
{
    const gint64 time = packet->dts != AV_NOPTS_VALUE ? packet->dts : packet->pts;
    Waiting *waiting = g_new0(Waiting, 1);
    waiting->packet = av_packet_alloc();
    waiting->time_base = time_base;
    waiting->time_us = time == AV_NOPTS_VALUE ? 0 : av_rescale_q(time, time_base, AV_TIME_BASE_Q);
    av_packet_move_ref(waiting->packet, packet);
    g_queue_push_tail(&output->waiting, waiting);
}

/*
 * MP4 and MOV have two places for tags: one for a fixed set of names, which every player reads, and which has the cover
 * picture; and one for any name, such as those of phones. libavformat writes either.
 */
static gboolean needs_free_tags(const Output *output)
{
    const AVDictionaryEntry *entry = NULL;
    gboolean other = FALSE, cover = FALSE;
    while ((entry = av_dict_get(output->format->metadata, "", entry, AV_DICT_IGNORE_SUFFIX)))
        other = other || strchr(entry->key, '.') != NULL;
    for (unsigned i = 0; i < output->format->nb_streams; i++)
        cover = cover || (output->format->streams[i]->disposition & AV_DISPOSITION_ATTACHED_PIC);
    if (other && cover)
        say_note("%s: tags that only some players read are left out, to keep the cover picture", output->input->name);
    return other && !cover;
}

static void set_option(AVDictionary **options, const Output *output)
{
    if (MOV_FAMILY(output->container->muxer)) {
        if (needs_free_tags(output))
            av_dict_set(options, "movflags", "+use_metadata_tags", 0);
        av_dict_set(options, "write_tmcd", "auto", 0);
    } else if (strcmp(output->container->muxer, "mpegts") != 0 && strcmp(output->container->muxer, "avi") != 0)
        av_dict_set(options, "default_mode", "passthrough", 0);
}

static gboolean start(Output *output, const AVPacket *first, const GstCaps *encoded, const GstCaps *raw)
{
    AVDictionary *options = NULL;
    if (!codecs_describe(encoded, raw, output->video)) {
        char *text = gst_caps_to_string(encoded);
        fault(&output->fault, EXIT_USAGE, "what the encoder makes (%s) cannot be written to %s", text,
              output->container->suffix);
        g_free(text);
        return FALSE;
    }
    codecs_find_extradata(output->video, first);
    if (!takes(output, output->video->codecpar->codec_id))
        return fault(&output->fault, EXIT_USAGE, "%s does not take %s: choose another --encoder or output name",
                     output->container->suffix, avcodec_get_name(output->video->codecpar->codec_id));
    /* Apple's players want this one of the two tags for HEVC. */
    if (output->video->codecpar->codec_id == AV_CODEC_ID_HEVC && MOV_FAMILY(output->container->muxer))
        output->video->codecpar->codec_tag = MKTAG('h', 'v', 'c', '1');
    output->video->avg_frame_rate = output->input->video->avg_frame_rate;
    set_option(&options, output);
    const int code = avformat_write_header(output->format, &options);
    av_dict_free(&options);
    if (code < 0)
        fail(output, code);
    output->started = code >= 0;
    return output->started;
}

/* ---- what other threads call ---- */

/* Shifts a packet so that the part of the input that is taken begins at 0. FALSE: it is outside this part. */
static gboolean shift(const Output *output, AVPacket *packet, const AVStream *in)
{
    const gint64 begin = av_rescale_q(output->start_us, AV_TIME_BASE_Q, in->time_base);
    const gint64 end = output->end_us < 0 ? G_MAXINT64 : av_rescale_q(output->end_us, AV_TIME_BASE_Q, in->time_base);
    packet->pts = input_ticks(output->input, in, packet->pts);
    packet->dts = input_ticks(output->input, in, packet->dts);
    const gint64 time = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
    if (time != AV_NOPTS_VALUE && ((output->start_us > 0 && time < begin) || time >= end))
        return FALSE;
    if (packet->pts != AV_NOPTS_VALUE)
        packet->pts -= begin;
    if (packet->dts != AV_NOPTS_VALUE)
        packet->dts -= begin;
    return TRUE;
}

/* The converter's packets, in the thread that reads. */
static void enqueue_audio(void *cookie, int stream, AVPacket *packet)
{
    Output *output = cookie;
    const AVRational time_base = output->format->streams[stream]->codecpar->sample_rate
                                     ? (AVRational){1, output->format->streams[stream]->codecpar->sample_rate}
                                     : output->format->streams[stream]->time_base;
    packet->stream_index = stream;
    g_mutex_lock(&output->lock);
    enqueue(output, packet, time_base);
    g_mutex_unlock(&output->lock);
}

void output_copy(Output *output, AVPacket *packet)
{
    const AVStream *in = output->input->format->streams[packet->stream_index];
    Route *route = &output->routes[packet->stream_index];
    if (!route->out || route->out->codecpar->codec_type == AVMEDIA_TYPE_ATTACHMENT || !shift(output, packet, in))
        return;
    if (route->audio) {
        audio_convert_push(route->audio, packet, enqueue_audio, output);
        return;
    }
    if (route->subtitle && !subtitle_convert_packet(route->subtitle, packet))
        return;
    packet->stream_index = route->out->index;
    g_mutex_lock(&output->lock);
    enqueue(output, packet, in->time_base);
    g_mutex_unlock(&output->lock);
}

void output_copy_end(Output *output)
{
    for (unsigned i = 0; i < output->input->format->nb_streams; i++)
        if (output->routes[i].audio)
            audio_convert_push(output->routes[i].audio, NULL, enqueue_audio, output);
}

/* The packet of an encoded buffer. */
static AVPacket *packet_of(const Output *output, GstBuffer *buffer, gint64 pts, gint64 dts)
{
    AVPacket *packet = av_packet_alloc();
    const gsize size = gst_buffer_get_size(buffer);
    const AVRational ticks = output->input->video->time_base;
    if (av_new_packet(packet, (int)size) < 0) {
        av_packet_free(&packet);
        return NULL;
    }
    gst_buffer_extract(buffer, 0, packet->data, size);
    /* Back to the ticks that the input had: exact, because a tick is longer than a nanosecond. */
    packet->pts = av_rescale_q(pts, NANOSECONDS, ticks);
    packet->dts = av_rescale_q(dts, NANOSECONDS, ticks);
    packet->duration = GST_BUFFER_DURATION_IS_VALID(buffer)
                           ? av_rescale_q((gint64)GST_BUFFER_DURATION(buffer), NANOSECONDS, ticks) : 0;
    packet->stream_index = output->video->index;
    packet->flags = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT) ? 0 : AV_PKT_FLAG_KEY;
    return packet;
}

gboolean output_picture(Output *output, GstBuffer *buffer, const GstCaps *encoded, const GstCaps *raw, gint64 pts,
                        gint64 dts)
{
    AVPacket *packet = packet_of(output, buffer, pts, dts);
    g_mutex_lock(&output->lock);
    if (!packet)
        fault(&output->fault, EXIT_OTHER, "%s: not enough memory", output->input->name);
    if (!output->fault && (output->started || start(output, packet, encoded, raw))) {
        write_waiting(output, dts / 1000);
        write_packet(output, packet, output->input->video->time_base);
        output->reached_us = MAX(output->reached_us, pts / 1000);
    }
    av_packet_free(&packet);
    const gboolean ok = !output->fault;
    g_mutex_unlock(&output->lock);
    return ok;
}

gboolean output_finish(Output *output, gboolean partial, char **written, GError **error)
{
    g_mutex_lock(&output->lock);
    if (!output->started)
        fault(&output->fault, EXIT_INPUT, "%s: no frame of it could be decoded", output->input->name);
    write_waiting(output, partial ? output->reached_us : G_MAXINT64);
    const int code = output->fault ? 0 : av_write_trailer(output->format);
    if (!output->fault && (code < 0 || output->write_errno))
        fail(output, code);
    gboolean ok = !output->fault;
    g_mutex_unlock(&output->lock);
    if (!ok)
        return output_fault(output, error), FALSE;

    output->bytes = output_bytes(output);
    char *name = partial ? output_file_partial_name(output->name) : g_strdup(output->name);
    ok = output_file_commit(output->file, name, error);
    output->file = NULL;
    if (ok)
        *written = name;
    else
        g_free(name);
    return ok;
}

int output_left_out(Output *output)
{
    g_mutex_lock(&output->lock);
    const int left_out = output->left_out;
    g_mutex_unlock(&output->lock);
    return left_out;
}

gint64 output_bytes(Output *output)
{
    struct stat status;
    return output->file && fstat(output_file_fd(output->file), &status) == 0 ? status.st_size : output->bytes;
}

gboolean output_fault(Output *output, GError **error)
{
    g_mutex_lock(&output->lock);
    const gboolean has = output->fault != NULL;
    if (has && error && !*error)
        *error = g_error_copy(output->fault);
    g_mutex_unlock(&output->lock);
    return has;
}
