/* SPDX-License-Identifier: MIT */
#include "motion/motion_gap.h"

void l1l2_motion_gap_close(L1L2MotionGap *gap)
{
    gap->frames = 0;
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

L1L2Mat l1l2_motion_gap_product(const L1L2MotionGap *gap)
{
    L1L2Mat G = l1l2_mat_identity();
    for (int i = 0; i < gap->frames; i++)
        G = l1l2_mat_mul(G, gap->F[i]);
    return G;
}

void l1l2_motion_gap_bridge(L1L2MotionGap *gap, const L1L2Mat *G)
{
    l1l2_motion_share_out(G, gap->F, gap->weight, NULL, gap->frames);
}
