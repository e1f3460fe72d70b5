/* SPDX-License-Identifier: MIT */
#include "motion/shot_cut.h"

void l1l2_motion_cut_start(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail)
{
    shot->shown[0] = *thumbnail;
    shot->count = 1;
    shot->frames = 0;
    shot->unsure = false;
}

static void remember(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail)
{
    if (++shot->frames >= L1L2_CUT_STEP) {
        shot->frames = 0;
        for (int i = L1L2_CUT_MEMORY - 1; i > 0; i--)
            shot->shown[i] = shot->shown[i - 1];
        shot->count += shot->count < L1L2_CUT_MEMORY;
    }
    shot->shown[0] = *thumbnail;
}

bool l1l2_motion_cut_push(L1L2ShotCut *shot, const L1L2Thumbnail *thumbnail, bool measured)
{
    const bool has_detail = l1l2_image_thumbnail_has_detail(thumbnail);
    shot->unsure = shot->unsure || !measured;
    if (shot->unsure && has_detail) {
        int differing = 0;
        while (differing < shot->count && l1l2_image_thumbnails_differ(&shot->shown[differing], thumbnail))
            differing++;
        if (differing == shot->count)
            return true;
    }
    if (measured && has_detail) {
        shot->unsure = false;
        remember(shot, thumbnail);
    }
    return false;
}
