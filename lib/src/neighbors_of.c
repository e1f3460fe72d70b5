/* SPDX-License-Identifier: MIT */
#include "neighbors_of.h"

#include "path/chain.h"

_Static_assert((int)L1L2_BORDER_MAX_FRAMES <= (int)L1L2_PATH_MAX_REACH, "neighbors are farther away than chains reach");

int l1l2_neighbors_of_oldest(const L1L2FrameQueue *queue, int reach, int64_t known_end, const L1L2Geometry *geometry,
                             L1L2BorderNeighbor *neighbors)
{
    L1L2PathLink links[2 * L1L2_PATH_MAX_REACH];
    const int linked = l1l2_path_chain(l1l2_frame_queue_path_frames(queue), queue->begin, queue->kept, known_end, reach,
                                       links);
    int count = 0;
    for (int i = 0; i < linked; i++) {
        const L1L2StabFrame *frame = &l1l2_frame_queue_at(queue, links[i].t)->frame;
        if (!frame->data[0])
            continue;
        neighbors[count++] = (L1L2BorderNeighbor){
            .t = links[i].t,
            .map = l1l2_mat_to_samples(l1l2_mat_rescale(links[i].map, geometry->diagonal_px), geometry->pixel_aspect),
            .data = (const uint8_t *const *)frame->data,
            .stride = frame->stride,
        };
    }
    return count;
}
