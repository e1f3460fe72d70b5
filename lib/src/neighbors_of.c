/* SPDX-License-Identifier: MIT */
#include "neighbors_of.h"

static int add(const L1L2FrameQueue *queue, int64_t t, const L1L2Mat *chain, const L1L2Geometry *geometry,
               L1L2BorderNeighbor *neighbor)
{
    const L1L2QueuedFrame *record = l1l2_frame_queue_at(queue, t);
    if (!record->frame.data[0])
        return 0;
    *neighbor = (L1L2BorderNeighbor){
        .t = t,
        .map = l1l2_mat_to_samples(l1l2_mat_rescale(*chain, geometry->diagonal_px), geometry->pixel_aspect),
        .data = (const uint8_t *const *)record->frame.data,
        .stride = record->frame.stride,
    };
    return 1;
}

/* F_t maps frame t to frame t - 1. So F_{k+1} ... F_t maps it to frame k, and the inverses lead to later frames. */
int l1l2_neighbors_of_oldest(const L1L2FrameQueue *queue, int reach, int64_t known_end, const L1L2Geometry *geometry,
                             L1L2BorderNeighbor *neighbors)
{
    const int64_t t = queue->begin;
    int count = 0;
    L1L2Mat chain = l1l2_mat_identity(), inverse;
    for (int64_t k = t - 1; k >= queue->kept && k >= t - reach; k--) {
        const L1L2QueuedFrame *later = l1l2_frame_queue_at(queue, k + 1);
        if (!later->path.linked)
            break;
        chain = l1l2_mat_mul(later->path.F, chain);
        count += add(queue, k, &chain, geometry, &neighbors[count]);
    }
    chain = l1l2_mat_identity();
    for (int64_t k = t + 1; k < known_end && k <= t + reach; k++) {
        const L1L2QueuedFrame *record = l1l2_frame_queue_at(queue, k);
        if (!record->path.linked || !l1l2_mat_inverse(record->path.F, &inverse))
            break;
        chain = l1l2_mat_mul(inverse, chain);
        count += add(queue, k, &chain, geometry, &neighbors[count]);
    }
    return count;
}
