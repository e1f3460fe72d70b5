/* SPDX-License-Identifier: MIT */
/*
 * A column of a table that has one record a frame: the same field of every record. A leaf.
 *
 * All that is known of a frame lives in one record, in one queue (frame_queue.h of the stabilizer). Camera path and
 * rolling-shutter filter work on these records and own no copies, but each of them knows its own field alone: it gets
 * the column of that field. So the layers stay apart, since nobody but the stabilizer has to know the whole record, and
 * a test of one module passes a plain array.
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
