/* SPDX-License-Identifier: MIT */
#include "motion/static_overlay.h"

#include <math.h>
#include <string.h>

/* Tracked pixels a frame: what stands still moves less, and it can only be told where the camera moves more. */
static const double still_px = 0.15, moving_px = 2.0;
enum { ENOUGH = 5, MOST = 20, AGREES = 2 };

void l1l2_motion_overlay_reset(L1L2StaticOverlay *o)
{
    memset(o->score, 0, sizeof o->score);
}

static int clamp(int v, int low, int high)
{
    return v < low ? low : v > high ? high : v;
}

static int cell_of(const L1L2StaticOverlay *o, L1L2Point p)
{
    return l1l2_cell_of(p, o->half_w, o->half_h, L1L2_MASK_W, L1L2_MASK_H);
}

void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2Pair *pairs, const bool *inlier, int count,
                               const L1L2Mat *F)
{
    for (int i = 0; i < count; i++) {
        const L1L2Point from = pairs[i].from, to = pairs[i].to, camera = l1l2_mat_apply(F, from);
        if (hypot(camera.x - from.x, camera.y - from.y) < moving_px * o->pixel)
            continue;
        int *score = &o->score[cell_of(o, from)];
        if (inlier[i])
            *score = clamp(*score - AGREES, 0, MOST);
        else if (hypot(to.x - from.x, to.y - from.y) < still_px * o->pixel)
            *score = clamp(*score + 1, 0, MOST);
    }
}

bool l1l2_motion_overlay_covers(const L1L2StaticOverlay *o, L1L2Point p)
{
    return o->score[cell_of(o, p)] >= ENOUGH;
}

void l1l2_motion_overlay_mask(L1L2StaticOverlay *o, L1L2Mask *mask)
{
    for (int cell = 0; cell < L1L2_MASK_CELLS; cell++) {
        mask->blocked[cell] = o->score[cell] >= ENOUGH;
        o->score[cell] -= o->score[cell] > 0;
    }
}
