/* SPDX-License-Identifier: MIT */
/*
 * The input file, read by libavformat.
 *
 * The file is opened here and read through a callback. So a name is never taken for an address such as http:, and
 * reading from a FIFO can be canceled at any moment.
 */
#ifndef INPUT_H
#define INPUT_H

#include <glib.h>
#include <libavformat/avformat.h>

typedef struct Input {
    char *name;               /* printable */
    AVFormatContext *format;
    AVStream *video;          /* the stream that is stabilized */
    int videos;               /* number of video streams, without cover pictures */
    gint64 origin_us;         /* the file's time that is the output's time 0 */
    char *damage;             /* what shows that the file is truncated or damaged, or NULL */
    gboolean encrypted;       /* found while reading: the picture cannot be decoded */
    struct InputFile *file;
} Input;

#define ANY_STREAM (-1)

/* Opens a file and chooses its video stream: that with this index, or the main one. Returns NULL and sets *error if
 * there is none. It is closed by input_close(), which accepts NULL. */
Input *input_open(const char *name, int stream, GError **error);
void input_close(Input *input);

/* Makes a read that waits, and all reads to come, return at once. Any thread may call it. */
void input_cancel(Input *input);

/* Goes to the last key frame at or before a time from the origin. FALSE if the file cannot seek. */
gboolean input_seek(Input *input, gint64 time_us);

/* Reads the next packet of any stream. FALSE at the end, after which input->damage says whether it is the true end. */
gboolean input_read(Input *input, AVPacket *packet);

/* Sets *error for an encrypted input. Returns FALSE. */
gboolean input_explain_encryption(const Input *input, GError **error);

/* A timestamp of a stream, with the origin as 0: in ticks of the stream's time base. AV_NOPTS_VALUE stays. */
gint64 input_ticks(const Input *input, const AVStream *stream, gint64 timestamp);

/* Duration in nanoseconds; 0 if it is not known. */
gint64 input_duration_ns(const Input *input);

/* Keeps the log of libavformat and libavcodec from stderr, unless verbose, and looks into it to explain errors. */
void input_log_to(gboolean verbose);

#endif
