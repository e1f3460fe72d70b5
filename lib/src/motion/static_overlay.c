/* SPDX-License-Identifier: MIT */
#include "motion/static_overlay.h"

#include <math.h>
#include <string.h>

/* A track that moves less, in px of the downscaled picture, stands still: above the noise of tracking. */
static const double still_px = 0.15;
/* A track that follows the camera outweighs two that stand still. Scores above the maximum would be forgotten late. */
static const double agreeing_track = 2.0, max_score = 20.0;

void l1l2_motion_overlay_reset(L1L2StaticOverlay *o)
{
    memset(o->score, 0, sizeof o->score);
}

static int cell_of(const L1L2StaticOverlay *o, L1L2Point p)
{
    return l1l2_cell_of(p, o->half_w, o->half_h, L1L2_MASK_W, L1L2_MASK_H);
}

void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2Pair *pairs, const bool *inlier, int count,
                               const L1L2Mat *F)
{
    const L1L2MotionParameters *p = o->parameters;
    for (int i = 0; i < count; i++) {
        const L1L2Point from = pairs[i].from, to = pairs[i].to, camera = l1l2_mat_apply(F, from);
        if (hypot(camera.x - from.x, camera.y - from.y) < p->overlay_min_camera * o->pixel)
            continue;
        double *score = &o->score[cell_of(o, from)];
        if (inlier[i])
            *score = fmax(*score - agreeing_track, 0.0);
        else if (hypot(to.x - from.x, to.y - from.y) < still_px * o->pixel)
            *score = fmin(*score + 1.0, max_score);
    }
}

bool l1l2_motion_overlay_covers(const L1L2StaticOverlay *o, L1L2Point p)
{
    return o->score[cell_of(o, p)] >= o->parameters->overlay_hits;
}

void l1l2_motion_overlay_mask(L1L2StaticOverlay *o, L1L2Mask *mask)
{
    for (int cell = 0; cell < L1L2_MASK_CELLS; cell++) {
        mask->blocked[cell] = o->score[cell] >= o->parameters->overlay_hits;
        o->score[cell] = fmax(o->score[cell] - 1.0, 0.0);
    }
}
