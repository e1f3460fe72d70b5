/* SPDX-License-Identifier: MIT */
#include "motion/motion_gap.h"

void l1l2_motion_gap_close(L1L2MotionGap *gap)
{
    gap->frames = gap->settled = 0;
}

bool l1l2_motion_gap_add(L1L2MotionGap *gap, const L1L2Mat *F, double weight)
{
    if (gap->frames == L1L2_BRIDGE_MAX_FRAMES) {
        l1l2_motion_gap_close(gap);
        return false;
    }
    gap->F[gap->frames] = *F;
    gap->weight[gap->frames++] = weight;
    return true;
}

static L1L2Mat product(const L1L2MotionGap *gap, int frames)
{
    L1L2Mat G = l1l2_mat_identity();
    for (int i = 0; i < frames; i++)
        G = l1l2_mat_mul(G, gap->F[i]);
    return G;
}

L1L2Mat l1l2_motion_gap_product(const L1L2MotionGap *gap)
{
    return product(gap, gap->frames);
}

int l1l2_motion_gap_bridge(L1L2MotionGap *gap, const L1L2Mat *G)
{
    const int first = gap->settled, count = gap->frames - first;
    const L1L2Mat before = product(gap, first);
    L1L2Mat inverse;
    if (count == 0 || !l1l2_mat_inverse(before, &inverse))
        return 0;
    const L1L2Mat rest = l1l2_mat_mul(inverse, *G);
    l1l2_motion_share_out(&rest, gap->F + first, gap->weight + first, NULL, count);
    gap->settled = gap->frames;
    return count;
}
