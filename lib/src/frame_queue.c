/* SPDX-License-Identifier: MIT */
#include "frame_queue.h"

#include <assert.h>

#include "common/mem.h"

_Static_assert((int)L1L2_PATH_PAST <= (int)L1L2_FRAME_QUEUE_PAST, "the path looks back on more than is kept");
_Static_assert((int)L1L2_SHUTTER_FILTER_PAST <= (int)L1L2_FRAME_QUEUE_PAST,
               "the rolling-shutter filter looks back on more than is kept");

L1L2QueuedFrame *l1l2_frame_queue_at(const L1L2FrameQueue *queue, int64_t t)
{
    assert(t >= queue->kept && t < queue->end);
    return &queue->records[t % queue->rows];
}

bool l1l2_frame_queue_init(L1L2FrameQueue *queue, int capacity, int keep)
{
    const int rows = capacity + (keep > L1L2_FRAME_QUEUE_PAST ? keep : L1L2_FRAME_QUEUE_PAST);
    *queue = (L1L2FrameQueue){.records = l1l2_mem_new((size_t)rows, sizeof *queue->records), .capacity = capacity,
                              .keep = keep, .rows = rows};
    return queue->records != NULL;
}

void l1l2_frame_queue_clear(L1L2FrameQueue *queue)
{
    l1l2_frame_queue_reset(queue);
    l1l2_mem_free(queue->records);
    *queue = (L1L2FrameQueue){0};
}

void l1l2_frame_queue_reset(L1L2FrameQueue *queue)
{
    while (queue->begin < queue->end)
        l1l2_frame_queue_drop_oldest(queue);
    l1l2_frame_queue_release_kept(queue);
    queue->begin = queue->end = queue->kept = 0;
}

int l1l2_frame_queue_count(const L1L2FrameQueue *queue)
{
    return (int)(queue->end - queue->begin);
}

L1L2QueuedFrame *l1l2_frame_queue_append(L1L2FrameQueue *queue)
{
    assert(l1l2_frame_queue_count(queue) < queue->capacity);
    queue->end++;
    L1L2QueuedFrame *record = l1l2_frame_queue_newest(queue);
    *record = (L1L2QueuedFrame){0};
    return record;
}

L1L2QueuedFrame *l1l2_frame_queue_oldest(const L1L2FrameQueue *queue)
{
    return l1l2_frame_queue_at(queue, queue->begin);
}

L1L2QueuedFrame *l1l2_frame_queue_newest(const L1L2FrameQueue *queue)
{
    return l1l2_frame_queue_at(queue, queue->end - 1);
}

static void release_oldest_kept(L1L2FrameQueue *queue)
{
    const L1L2StabFrame frame = l1l2_frame_queue_at(queue, queue->kept)->frame;
    queue->kept++;
    if (frame.release)
        frame.release(frame.opaque);
}

void l1l2_frame_queue_drop_oldest(L1L2FrameQueue *queue)
{
    assert(l1l2_frame_queue_count(queue) > 0);
    queue->begin++;
    while (queue->begin - queue->kept > queue->keep)
        release_oldest_kept(queue);
}

void l1l2_frame_queue_release_kept(L1L2FrameQueue *queue)
{
    while (queue->kept < queue->begin)
        release_oldest_kept(queue);
}

static L1L2FrameColumn column(const L1L2FrameQueue *queue, void *first)
{
    return (L1L2FrameColumn){first, sizeof *queue->records, queue->rows};
}

L1L2FrameColumn l1l2_frame_queue_path_frames(const L1L2FrameQueue *queue)
{
    return column(queue, &queue->records[0].path);
}

L1L2FrameColumn l1l2_frame_queue_shutter_frames(const L1L2FrameQueue *queue)
{
    return column(queue, &queue->records[0].shutter);
}

L1L2FrameColumn l1l2_frame_queue_motions(const L1L2FrameQueue *queue)
{
    return column(queue, &queue->records[0].path.F);
}
