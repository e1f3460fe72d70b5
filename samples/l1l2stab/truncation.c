/* SPDX-License-Identifier: MIT */
#include "truncation.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define EBML_ID 0x1A45DFA3u
#define SEGMENT_ID 0x18538067u
#define MAX_BOXES 100000 /* of one MP4 file: fragments have two each */

static gboolean read_at(int fd, gint64 position, guint8 *bytes, size_t size)
{
    return pread(fd, bytes, size, position) == (ssize_t)size;
}

static guint32 big_endian(const guint8 *bytes)
{
    return (guint32)bytes[0] << 24 | (guint32)bytes[1] << 16 | (guint32)bytes[2] << 8 | bytes[3];
}

/* MP4 and MOV: a chain of boxes, each with its size and its name. */
static gint64 end_of_boxes(int fd, gint64 length)
{
    guint8 head[16];
    gint64 position = 0;
    for (int i = 0; i < MAX_BOXES && position < length && read_at(fd, position, head, 8); i++) {
        gint64 size = big_endian(head);
        if (size == 0) /* up to the end of the file */
            return length;
        if (size == 1 && read_at(fd, position, head, 16))
            size = (gint64)((guint64)big_endian(head + 8) << 32 | big_endian(head + 12));
        if (size < 8 || size > G_MAXINT64 - position)
            return length; /* not boxes any more: some cameras append their own data */
        position += size;
    }
    return position;
}

/* A number of Matroska: the leading zeros of the first byte say how many bytes follow. Returns its length, or 0. */
static int read_number(int fd, gint64 position, guint64 *value, gboolean *unknown)
{
    guint8 bytes[8];
    if (!read_at(fd, position, bytes, 1) || bytes[0] == 0)
        return 0;
    int length = 1;
    while (!(bytes[0] & (0x80 >> (length - 1))))
        length++;
    if (!read_at(fd, position, bytes, (size_t)length))
        return 0;
    const guint8 mask = (guint8)((1 << (8 - length)) - 1);
    *value = bytes[0] & mask;
    *unknown = (bytes[0] & mask) == mask;
    for (int i = 1; i < length; i++) {
        *value = *value << 8 | bytes[i];
        *unknown = *unknown && bytes[i] == 0xff;
    }
    return length;
}

/* Matroska and WebM: a head, then one segment with its size, which a live recording does not know. */
static gint64 end_of_segment(int fd, gint64 length)
{
    guint8 id[4];
    gint64 position = 0;
    for (int i = 0; i < 2; i++) {
        guint64 size = 0;
        gboolean unknown = FALSE;
        if (!read_at(fd, position, id, 4))
            return length;
        const int bytes = read_number(fd, position + 4, &size, &unknown);
        if (bytes == 0 || unknown || size > G_MAXINT64 / 2)
            return length;
        position += 4 + bytes + (gint64)size;
        if (big_endian(id) == SEGMENT_ID)
            return position;
    }
    return length;
}

gint64 truncation_missing_bytes(int fd)
{
    struct stat status;
    guint8 head[8];
    if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode) || !read_at(fd, 0, head, sizeof head))
        return 0;
    gint64 end = status.st_size;
    if (memcmp(head + 4, "ftyp", 4) == 0)
        end = end_of_boxes(fd, status.st_size);
    else if (big_endian(head) == EBML_ID)
        end = end_of_segment(fd, status.st_size);
    else if (memcmp(head, "RIFF", 4) == 0)
        end = 8 + (gint64)((guint32)head[4] | (guint32)head[5] << 8 | (guint32)head[6] << 16 | (guint32)head[7] << 24);
    return MAX(0, end - status.st_size);
}
