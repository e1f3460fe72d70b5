/* SPDX-License-Identifier: MIT */
/*
 * A column of a table that has one record a frame: the same field of every record.
 *
 * All that is known of a frame is in one record, in the stabilizer's queue (frame_queue.h). The camera path and the
 * rolling-shutter filter work on these records without copies. Each of them knows only its own field, by its column. So
 * the whole record is known to the stabilizer alone, and a test of one module can pass a plain array.
 */
#ifndef L1L2_COMMON_FRAME_COLUMN_H
#define L1L2_COMMON_FRAME_COLUMN_H

#include <stddef.h>
#include <stdint.h>

typedef struct L1L2FrameColumn {
    void *first;   /* the field of the record in row 0 */
    size_t stride; /* bytes from a record to the next */
    int rows;      /* frame t is in row t modulo rows: later frames take the places of earlier ones */
} L1L2FrameColumn;

/* The field of frame t; the caller knows its type. */
static inline void *l1l2_frame_column_at(L1L2FrameColumn column, int64_t t)
{
    return (char *)column.first + (size_t)(t % column.rows) * column.stride;
}

#endif
