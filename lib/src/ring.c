/* SPDX-License-Identifier: MIT */
#include "ring.h"

#include <assert.h>

#include "mem.h"

bool l1l2_ring_init(L1L2Ring *ring, int capacity)
{
    *ring = (L1L2Ring){.items = l1l2_mem_new((size_t)capacity, sizeof *ring->items), .capacity = capacity};
    return ring->items != NULL;
}

void l1l2_ring_clear(L1L2Ring *ring)
{
    l1l2_ring_drop_all(ring);
    l1l2_mem_free(ring->items);
    *ring = (L1L2Ring){0};
}

void l1l2_ring_drop_all(L1L2Ring *ring)
{
    while (ring->count > 0)
        l1l2_ring_drop_oldest(ring);
}

L1L2Held *l1l2_ring_append(L1L2Ring *ring)
{
    assert(ring->count < ring->capacity);
    ring->count++;
    return l1l2_ring_at(ring, ring->count - 1);
}

L1L2Held *l1l2_ring_at(const L1L2Ring *ring, int index)
{
    assert(index >= 0 && index < ring->count);
    return &ring->items[(ring->oldest + index) % ring->capacity];
}

void l1l2_ring_drop_oldest(L1L2Ring *ring)
{
    const L1L2StabFrame frame = l1l2_ring_at(ring, 0)->frame;
    ring->oldest = (ring->oldest + 1) % ring->capacity;
    ring->count--;
    if (frame.release)
        frame.release(frame.opaque);
}
