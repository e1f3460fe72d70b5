/* SPDX-License-Identifier: MIT */
#include "motion/lucas_kanade.h"

#include <float.h>
#include <math.h>

#include "motion/lucas_kanade_patch.h"

/* Iterations at each level end after 10 steps or at a step of 0.03 px. 20 steps and 0.01 px gave no better results. */
enum { ITERATIONS = 10 };
static const float last_step = 0.03f;
/* A step that undoes the one before to this many px: the point swings between two places, and half way is taken. */
static const float same_step = 0.01f;
/* A window whose smaller eigenvalue is below this has too little texture; about a third of a gray level a pixel. */
static const float min_eigenvalue = 1e-4f;
/* Scales the integer sums. Every step is a ratio in which it cancels: slopes, 32 per gray level and pixel, and gray
 * levels, with 5 fractional bits, have the same unit. It only sets the unit of min_eigenvalue. */
static const float unit = 1.0f / (1 << 20);

/* Finds the window around a point. False: it lies outside the level, or the point is not a number. */
static bool place_window(const L1L2LkLevel *level, L1L2LkPoint p, L1L2LkPlace *place)
{
    const float x = floorf(p.x - L1L2_LK_WINDOW / 2), y = floorf(p.y - L1L2_LK_WINDOW / 2);
    if (!(x >= -L1L2_LK_WINDOW && y >= -L1L2_LK_WINDOW && x < (float)level->width && y < (float)level->height))
        return false;
    const float right = p.x - L1L2_LK_WINDOW / 2 - x, below = p.y - L1L2_LK_WINDOW / 2 - y;
    const float one = 1 << L1L2_LK_WEIGHT_BITS;
    place->x = (int)x, place->y = (int)y;
    place->weight[0] = (int16_t)lrintf((1.0f - right) * (1.0f - below) * one);
    place->weight[1] = (int16_t)lrintf(right * (1.0f - below) * one);
    place->weight[2] = (int16_t)lrintf((1.0f - right) * below * one);
    place->weight[3] = (int16_t)((1 << L1L2_LK_WEIGHT_BITS) - place->weight[0] - place->weight[1] - place->weight[2]);
    return true;
}

/* Follows a point at one level, by Gauss-Newton steps on the sum of squared differences. False: the point cannot be
 * followed there; *to may be closer all the same. */
static bool follow(const L1L2LkFunctions *functions, const L1L2LkLevel *a, const L1L2LkLevel *b, L1L2LkPoint from,
                   L1L2LkPoint *to)
{
    L1L2LkPlace place;
    L1L2LkPatch patch;
    if (!place_window(a, from, &place))
        return false;
    L1L2LkSums sums = functions->take(a, &place, &patch);
    const float xx = (float)sums.of[0] * unit, xy = (float)sums.of[1] * unit, yy = (float)sums.of[2] * unit;
    const float determinant = xx * yy - xy * xy;
    const float smaller = (yy + xx - sqrtf((xx - yy) * (xx - yy) + 4.0f * xy * xy)) /
                          (2 * L1L2_LK_WINDOW * L1L2_LK_WINDOW);
    if (smaller < min_eigenvalue || determinant < FLT_EPSILON)
        return false;
    L1L2LkPoint before = {0};
    for (int i = 0; i < ITERATIONS; i++) {
        if (!place_window(b, *to, &place))
            return false;
        sums = functions->compare(b, &place, &patch);
        const float x = (float)sums.of[0] * unit, y = (float)sums.of[1] * unit;
        const L1L2LkPoint step = {(xy * y - yy * x) / determinant, (xy * x - xx * y) / determinant};
        to->x += step.x, to->y += step.y;
        if (step.x * step.x + step.y * step.y <= last_step * last_step)
            break;
        if (i > 0 && fabsf(step.x + before.x) < same_step && fabsf(step.y + before.y) < same_step) {
            to->x -= 0.5f * step.x, to->y -= 0.5f * step.y;
            break;
        }
        before = step;
    }
    return true;
}

bool l1l2_lk_follow(const L1L2LkFunctions *functions, const L1L2LkLevel *a, const L1L2LkLevel *b, int levels,
                    L1L2LkPoint from, L1L2LkPoint *to)
{
    bool found = false;
    to->x = ldexpf(to->x, 1 - levels), to->y = ldexpf(to->y, 1 - levels);
    for (int level = levels - 1; level >= 0; level--) {
        const L1L2LkPoint at_level = {ldexpf(from.x, -level), ldexpf(from.y, -level)};
        found = follow(functions, a + level, b + level, at_level, to);
        if (level > 0)
            to->x *= 2.0f, to->y *= 2.0f;
    }
    return found;
}
