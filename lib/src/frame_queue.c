/* SPDX-License-Identifier: MIT */
#include "frame_queue.h"

#include <assert.h>

#include "common/mem.h"

bool l1l2_frame_queue_init(L1L2FrameQueue *ring, int capacity)
{
    *ring = (L1L2FrameQueue){.items = l1l2_mem_new((size_t)capacity, sizeof *ring->items), .capacity = capacity};
    return ring->items != NULL;
}

void l1l2_frame_queue_clear(L1L2FrameQueue *ring)
{
    l1l2_frame_queue_drop_all(ring);
    l1l2_mem_free(ring->items);
    *ring = (L1L2FrameQueue){0};
}

void l1l2_frame_queue_drop_all(L1L2FrameQueue *ring)
{
    while (ring->count > 0)
        l1l2_frame_queue_drop_oldest(ring);
}

L1L2QueuedFrame *l1l2_frame_queue_append(L1L2FrameQueue *ring)
{
    assert(ring->count < ring->capacity);
    ring->count++;
    return l1l2_frame_queue_at(ring, ring->count - 1);
}

L1L2QueuedFrame *l1l2_frame_queue_at(const L1L2FrameQueue *ring, int index)
{
    assert(index >= 0 && index < ring->count);
    return &ring->items[(ring->oldest + index) % ring->capacity];
}

void l1l2_frame_queue_drop_oldest(L1L2FrameQueue *ring)
{
    const L1L2StabFrame frame = l1l2_frame_queue_at(ring, 0)->frame;
    ring->oldest = (ring->oldest + 1) % ring->capacity;
    ring->count--;
    if (frame.release)
        frame.release(frame.opaque);
}
