/* SPDX-License-Identifier: MIT */
#include "input.h"

#include "fault.h"
#include "say.h"
#include "truncation.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER_BYTES (1 << 16)

/* The open file below libavformat. */
typedef struct InputFile {
    int fd;
    int cancel_fd;      /* an eventfd: readable once the input is canceled */
    gboolean regular;
    gint canceled;      /* atomic */
    gint read_errno;    /* of the last failed read, or 0 */
} InputFile;

/* ---- the log of libavformat: the last error explains why a file cannot be read ---- */

static GMutex log_lock;
static char last_error[256];
static gboolean log_verbose;

static void keep_log(void *context, int level, const char *format, va_list args)
{
    char line[256];
    int print_prefix = 1;
    if (level > AV_LOG_WARNING)
        return;
    av_log_format_line(context, level, format, args, line, sizeof line, &print_prefix);
    g_strchomp(line);
    if (log_verbose)
        g_printerr("l1l2stab: libav: %s\n", line);
    g_mutex_lock(&log_lock);
    if (level <= AV_LOG_ERROR)
        g_strlcpy(last_error, line, sizeof last_error);
    g_mutex_unlock(&log_lock);
}

void input_log_to(gboolean verbose)
{
    log_verbose = verbose;
    av_log_set_callback(keep_log);
}

static gboolean log_has(const char *text)
{
    g_mutex_lock(&log_lock);
    const gboolean has = strstr(last_error, text) != NULL;
    g_mutex_unlock(&log_lock);
    return has;
}

/* ---- the file ---- */

/* Waits until there is something to read. A FIFO that nobody has opened for writing yet is waited for. */
static gboolean wait_for_data(const InputFile *file)
{
    struct pollfd fds[2] = {{.fd = file->fd, .events = POLLIN}, {.fd = file->cancel_fd, .events = POLLIN}};
    while (poll(fds, 2, -1) < 0)
        if (errno != EINTR)
            return FALSE;
    return fds[1].revents == 0;
}

static int read_file(void *data, uint8_t *bytes, int size)
{
    InputFile *file = data;
    ssize_t count;
    do {
        if (g_atomic_int_get(&file->canceled) || (!file->regular && !wait_for_data(file)))
            return AVERROR_EXIT;
        count = read(file->fd, bytes, (size_t)size);
    } while (count < 0 && (errno == EINTR || errno == EAGAIN));
    if (count < 0)
        file->read_errno = errno;
    return count < 0 ? AVERROR(errno) : count == 0 ? AVERROR_EOF : (int)count;
}

static int64_t seek_file(void *data, int64_t offset, int whence)
{
    const InputFile *file = data;
    struct stat status;
    if (whence & AVSEEK_SIZE)
        return fstat(file->fd, &status) == 0 ? status.st_size : AVERROR(errno);
    const off_t reached = lseek(file->fd, offset, whence & ~AVSEEK_FORCE);
    return reached < 0 ? AVERROR(errno) : reached;
}

static int is_canceled(void *data)
{
    return g_atomic_int_get(&((InputFile *)data)->canceled);
}

/* Opens without waiting: a FIFO would wait for its writer here, where nothing could cancel it. */
static InputFile *open_file(const char *name, const char *shown, GError **error)
{
    const int fd = open(name, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    if (fd < 0 || fstat(fd, &status) != 0 || S_ISDIR(status.st_mode)) {
        if (fd >= 0)
            fault(error, EXIT_INPUT, "%s: is a folder, not a video", shown);
        else if (errno == ENOENT || errno == ENOTDIR)
            fault(error, EXIT_INPUT, "%s: no such file", shown);
        else
            fault(error, EXIT_INPUT, "%s: cannot be read: %s", shown, g_strerror(errno));
        if (fd >= 0)
            close(fd);
        return NULL;
    }
    InputFile *file = g_new0(InputFile, 1);
    file->fd = fd;
    file->cancel_fd = eventfd(0, EFD_CLOEXEC);
    file->regular = S_ISREG(status.st_mode);
    return file;
}

static AVFormatContext *new_format(InputFile *file)
{
    AVFormatContext *format = avformat_alloc_context();
    format->pb = avio_alloc_context(av_malloc(BUFFER_BYTES), BUFFER_BYTES, 0, file, read_file, NULL,
                                    file->regular ? seek_file : NULL);
    format->interrupt_callback = (AVIOInterruptCB){.callback = is_canceled, .opaque = file};
    format->flags |= AVFMT_FLAG_CUSTOM_IO;
    /* A playlist must not open other files or the network. */
    format->protocol_whitelist = av_strdup("none");
    return format;
}

/* ---- the streams ---- */

static gboolean is_picture_file(const AVFormatContext *format)
{
    const char *name = format->iformat->name;
    return g_str_has_suffix(name, "_pipe") || g_str_has_prefix(name, "image2") || g_str_equal(name, "ico");
}

static gboolean is_video(const AVStream *stream)
{
    return stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO && !(stream->disposition & AV_DISPOSITION_ATTACHED_PIC);
}

static gboolean is_encrypted(const AVStream *stream)
{
    const uint32_t tag = stream->codecpar->codec_tag;
    return tag == MKTAG('e', 'n', 'c', 'v') || tag == MKTAG('d', 'r', 'm', 'i') ||
           av_stream_get_side_data(stream, AV_PKT_DATA_ENCRYPTION_INIT_INFO, NULL);
}

/* The name of an MP4 file is enough for libavformat to look for its index. */
static gboolean begins_like_mp4(const InputFile *file)
{
    static const char *const boxes[] = {"ftyp", "mdat", "moov", "wide", "free", "skip", "pnot"};
    char begin[8] = "";
    if (pread(file->fd, begin, sizeof begin, 0) != sizeof begin)
        return FALSE;
    for (size_t i = 0; i < G_N_ELEMENTS(boxes); i++)
        if (memcmp(begin + 4, boxes[i], 4) == 0)
            return TRUE;
    return FALSE;
}

static gboolean explain_open(const Input *input, int code, GError **error)
{
    if (code == AVERROR_EXIT)
        return fault(error, EXIT_INPUT, "%s: reading was interrupted", input->name);
    if (input->file->read_errno)
        return fault(error, EXIT_INPUT, "%s: cannot be read: %s", input->name, g_strerror(input->file->read_errno));
    if (log_has("moov atom not found") && begins_like_mp4(input->file))
        return fault(error, EXIT_INPUT,
                     "%s: is truncated: the index at its end (moov) is missing, and nothing can be read without it",
                     input->name);
    if (code == AVERROR_INVALIDDATA || code == AVERROR_EOF || code == AVERROR_PROTOCOL_NOT_FOUND)
        return fault(error, EXIT_INPUT, "%s: is not a video, or damaged at its beginning", input->name);
    return fault(error, EXIT_INPUT, "%s: cannot be read: %s", input->name, av_err2str(code));
}

static gboolean choose_stream(Input *input, int wanted, GError **error)
{
    const AVFormatContext *format = input->format;
    int audios = 0;
    for (unsigned i = 0; i < format->nb_streams; i++) {
        input->videos += is_video(format->streams[i]);
        audios += format->streams[i]->codecpar->codec_type == AVMEDIA_TYPE_AUDIO;
    }
    if (wanted != ANY_STREAM) {
        if (wanted >= (int)format->nb_streams || !is_video(format->streams[wanted]))
            return fault(error, EXIT_USAGE, "%s: stream %d is not a video stream", input->name, wanted);
        input->video = format->streams[wanted];
        return TRUE;
    }
    if (input->videos == 0)
        return fault(error, EXIT_INPUT, "%s: %s", input->name,
                     audios ? "has sound only, and no video" : "there is no video in it");
    int best = av_find_best_stream(input->format, AVMEDIA_TYPE_VIDEO, -1, -1, NULL, 0);
    for (unsigned i = 0; best < 0 || !is_video(format->streams[best]); i++)
        best = (int)i;
    input->video = format->streams[best];
    return TRUE;
}

/* A pixel is up to twice as wide as high. One of 1:257 comes from a damaged header, and a picture that x264 codes with
 * such pixels cannot be decoded again by FFmpeg. The bounds are those of the library. */
static void check_pixel_aspect(Input *input)
{
    AVStream *video = input->video;
    const AVRational pixel = av_guess_sample_aspect_ratio(input->format, video, NULL);
    if (pixel.num <= 0 || pixel.den <= 0 || (av_q2d(pixel) >= 0.1 && av_q2d(pixel) <= 10.0))
        return;
    say_note("%s: its header says that pixels are %d:%d; they are taken for square", input->name, pixel.num, pixel.den);
    video->sample_aspect_ratio = video->codecpar->sample_aspect_ratio = av_make_q(1, 1);
}

gboolean input_explain_encryption(const Input *input, GError **error)
{
    return fault(error, EXIT_INPUT, "%s: is encrypted (DRM), so its picture cannot be decoded", input->name);
}

static gboolean find_streams(Input *input, int wanted, GError **error)
{
    const int code = avformat_find_stream_info(input->format, NULL);
    if (code < 0)
        return explain_open(input, code, error);
    if (is_picture_file(input->format))
        return fault(error, EXIT_INPUT, "%s: is a picture, not a video", input->name);
    if (!choose_stream(input, wanted, error))
        return FALSE;
    if (is_encrypted(input->video))
        return input_explain_encryption(input, error);
    check_pixel_aspect(input);
    if (input->format->start_time != AV_NOPTS_VALUE && input->format->start_time > 0)
        input->origin_us = input->format->start_time;
    return TRUE;
}

Input *input_open(const char *name, int stream, GError **error)
{
    Input *input = g_new0(Input, 1);
    input->name = printable(name);
    g_mutex_lock(&log_lock);
    last_error[0] = '\0';
    g_mutex_unlock(&log_lock);

    input->file = open_file(name, input->name, error);
    if (input->file) {
        input->format = new_format(input->file);
        AVIOContext *io = input->format->pb;
        const int code = avformat_open_input(&input->format, name, NULL, NULL);
        if (code < 0) { /* libavformat has freed the context, but not what it read through */
            av_freep(&io->buffer);
            avio_context_free(&io);
            explain_open(input, code, error);
        } else if (find_streams(input, stream, error))
            return input;
    }
    input_close(input);
    return NULL;
}

void input_close(Input *input)
{
    if (!input)
        return;
    if (input->format) {
        AVIOContext *io = input->format->pb;
        avformat_close_input(&input->format);
        av_freep(&io->buffer);
        avio_context_free(&io);
    }
    if (input->file) {
        close(input->file->fd);
        close(input->file->cancel_fd);
    }
    g_free(input->file);
    g_free(input->damage);
    g_free(input->name);
    g_free(input);
}

void input_cancel(Input *input)
{
    g_atomic_int_set(&input->file->canceled, 1);
    eventfd_write(input->file->cancel_fd, 1);
}

gboolean input_seek(Input *input, gint64 time_us)
{
    const gint64 target = time_us + input->origin_us;
    return avformat_seek_file(input->format, -1, G_MININT64, target, target, 0) >= 0;
}

/* ---- reading ---- */

static void note_damage(Input *input, const char *format, ...) G_GNUC_PRINTF(2, 3);
static void note_damage(Input *input, const char *format, ...)
{
    va_list args;
    if (input->damage)
        return;
    va_start(args, format);
    input->damage = g_strdup_vprintf(format, args);
    va_end(args);
}

static void follow(Input *input, const AVPacket *packet)
{
    /* In a transport stream this only says that parts were joined or lost on the air, and it goes on. */
    if ((packet->flags & AV_PKT_FLAG_CORRUPT) && strcmp(input->format->iformat->name, "mpegts") != 0)
        note_damage(input, "a packet is incomplete");
    if (packet->stream_index != input->video->index)
        return;
    input->encrypted = input->encrypted || av_packet_get_side_data(packet, AV_PKT_DATA_ENCRYPTION_INFO, NULL);
}

/* The end of the input: the true one? */
static void check_end(Input *input, int code)
{
    const InputFile *file = input->file;
    const gint64 missing = truncation_missing_bytes(file->fd);
    if (code == AVERROR_EXIT)
        return;
    if (file->read_errno)
        note_damage(input, "reading failed: %s", g_strerror(file->read_errno));
    else if (missing > 0)
        note_damage(input, "%" G_GINT64_FORMAT " bytes are missing at its end", missing);
    else if (code != AVERROR_EOF)
        note_damage(input, "%s", av_err2str(code));
}

gboolean input_read(Input *input, AVPacket *packet)
{
    const int code = av_read_frame(input->format, packet);
    if (code >= 0)
        follow(input, packet);
    else
        check_end(input, code);
    return code >= 0 && !input->encrypted;
}

gint64 input_ticks(const Input *input, const AVStream *stream, gint64 timestamp)
{
    if (timestamp == AV_NOPTS_VALUE)
        return timestamp;
    return timestamp - av_rescale_q(input->origin_us, AV_TIME_BASE_Q, stream->time_base);
}

gint64 input_duration_ns(const Input *input)
{
    const AVFormatContext *format = input->format;
    if (input->video->duration != AV_NOPTS_VALUE && input->video->duration > 0)
        return av_rescale_q(input->video->duration, input->video->time_base, (AVRational){1, 1000000000});
    return format->duration != AV_NOPTS_VALUE && format->duration > 0 ? format->duration * 1000 : 0;
}
