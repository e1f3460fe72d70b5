/* SPDX-License-Identifier: MIT */
#include "path/chain.h"

#include "path/path.h"

int l1l2_path_chain(L1L2FrameColumn frames, int64_t t, int64_t begin, int64_t end, int reach, L1L2PathLink *links)
{
    int count = 0;
    L1L2Mat chain = l1l2_mat_identity(), inverse;
    for (int64_t k = t - 1; k >= begin && k >= t - reach; k--) {
        const L1L2PathFrame *later = l1l2_frame_column_at(frames, k + 1);
        if (!later->linked)
            break;
        chain = l1l2_mat_mul(later->F, chain);
        links[count++] = (L1L2PathLink){k, chain};
    }
    chain = l1l2_mat_identity();
    for (int64_t k = t + 1; k < end && k <= t + reach; k++) {
        const L1L2PathFrame *frame = l1l2_frame_column_at(frames, k);
        if (!frame->linked || !l1l2_mat_inverse(frame->F, &inverse))
            break;
        chain = l1l2_mat_mul(inverse, chain);
        links[count++] = (L1L2PathLink){k, chain};
    }
    return count;
}
