/* SPDX-License-Identifier: MIT */
#include "motion/static_overlay.h"

#include <math.h>
#include <string.h>

#include "common/mem.h"

/* Of a pixel's evidence: more would be forgotten late. */
enum { MOST = 20 };

bool l1l2_motion_overlay_init(L1L2StaticOverlay *o, int width, int height)
{
    o->width = width, o->height = height;
    if (width * height == 0)
        return true;
    const size_t pixels = (size_t)width * (size_t)height;
    o->score = l1l2_mem_new(pixels, sizeof *o->score);
    o->covered = l1l2_mem_new(pixels, sizeof *o->covered);
    return o->score && o->covered;
}

void l1l2_motion_overlay_clear(L1L2StaticOverlay *o)
{
    l1l2_mem_free(o->score);
    l1l2_mem_free(o->covered);
    l1l2_mem_free(o->excluded);
    o->score = o->covered = o->excluded = NULL;
}

bool l1l2_motion_overlay_exclude(L1L2StaticOverlay *o, const L1L2MeasuredArea *area, double *share)
{
    o->excluded = l1l2_mem_new((size_t)o->width * (size_t)o->height, sizeof *o->excluded);
    if (!o->excluded)
        return false;
    *share = l1l2_motion_area_mark(area, o->excluded, o->width, o->height);
    o->stale = true;
    return true;
}

void l1l2_motion_overlay_reset(L1L2StaticOverlay *o)
{
    const size_t pixels = (size_t)o->width * (size_t)o->height;
    o->any = false;
    o->stale = o->excluded != NULL;
    if (pixels == 0)
        return;
    memset(o->score, 0, pixels);
    memset(o->covered, 0, pixels);
}

/* What one pixel tells: 1 it stands still, -1 it does not, 0 nothing. What stands still does not change at all, which
 * distinguishes it from a scene that moves by less than the camera's motion says. */
static int evidence(const L1L2MotionParameters *p, float now, float still, float moved)
{
    const float noise = (float)p->overlay_noise, change = 2.0f * noise;
    const float as_still = fabsf(now - still), as_moved = fabsf(now - moved);
    if (as_still > change)
        return -1;
    return as_still < noise && as_moved > change ? 1 : 0;
}

/* The previous picture's value at (u, v), which lies within. */
static float sample_at(const L1L2GrayPicture *g, float u, float v)
{
    const int i = (int)u, j = (int)v;
    const uint8_t *p = g->data + j * g->stride + i, *q = p + g->stride;
    const float fx = u - (float)i, fy = v - (float)j;
    const float upper = (float)p[0] + fx * (float)(p[1] - p[0]), lower = (float)q[0] + fx * (float)(q[1] - q[0]);
    return upper + fy * (lower - upper);
}

static double mean_of(const L1L2GrayPicture *g)
{
    int64_t sum = 0;
    for (int y = 0; y < g->height; y++)
        for (int x = 0; x < g->width; x++)
            sum += g->data[y * g->stride + x];
    return (double)sum / (g->width * g->height);
}

/* Pixels that stand still, and that move. */
typedef struct Survey {
    int still, moving;
} Survey;

/* Counts them, of the pixels that the previous picture shows too. apply: changes their evidence. */
static Survey survey(L1L2StaticOverlay *o, const L1L2GrayPicture *now, const L1L2GrayPicture *previous,
                     const L1L2Mat *F, bool apply)
{
    const double unit_x = 2.0 * o->half_w / o->width, unit_y = 2.0 * o->half_h / o->height;
    const float offset = (float)(mean_of(now) - mean_of(previous));
    Survey sum = {0, 0};
    for (int y = 0; y < o->height; y++) {
        const double py = (y + 0.5) * unit_y - o->half_h, x0 = 0.5 * unit_x - o->half_w;
        const float u0 = (float)((F->m[0] * x0 + F->m[1] * py + F->m[2] + o->half_w) / unit_x - 0.5);
        const float v0 = (float)((F->m[3] * x0 + F->m[4] * py + F->m[5] + o->half_h) / unit_y - 0.5);
        const float du = (float)F->m[0], dv = (float)(F->m[3] * unit_x / unit_y);
        const ptrdiff_t row = (ptrdiff_t)y * o->width;
        const uint8_t *excluded = o->excluded ? o->excluded + row : NULL;
        for (int x = 0; x < o->width; x++) {
            const float u = u0 + (float)x * du, v = v0 + (float)x * dv;
            if (excluded && excluded[x])
                continue;
            if (!(u >= 0.0f && v >= 0.0f && u < (float)(o->width - 1) && v < (float)(o->height - 1)))
                continue;
            const int told = evidence(o->parameters, (float)now->data[y * now->stride + x],
                                      (float)previous->data[y * previous->stride + x] + offset,
                                      sample_at(previous, u, v) + offset);
            uint8_t *score = &o->score[row + x];
            sum.still += told > 0;
            sum.moving += told < 0;
            if (apply && told > 0 && *score < MOST)
                ++*score;
            else if (apply && told < 0)
                *score -= *score > 0;
        }
    }
    return sum;
}

/* What stands still is an overlay only if it is the smaller part of what can be seen: else F is a subject's motion. */
void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2GrayPicture *now, const L1L2GrayPicture *previous,
                               const L1L2Mat *F)
{
    const L1L2Mat identity = l1l2_mat_identity();
    const double pixel = o->half_w / o->width; /* of the downscaled picture, which is twice as large */
    if (!o->score || l1l2_mat_corner_distance(F, &identity, o->half_w, o->half_h) <
                         o->parameters->overlay_min_camera * pixel)
        return;
    const Survey seen = survey(o, now, previous, F, false);
    if (seen.still >= seen.moving || seen.still + seen.moving == 0)
        return;
    survey(o, now, previous, F, true);
    o->stale = true;
}

static int least_of(int a, int b)
{
    return a < b ? a : b;
}

/* Marks what is excluded, and what has enough evidence and its surroundings: a tracking window reaches as far. */
static void update(L1L2StaticOverlay *o)
{
    enum { REACH = 1 };
    const size_t pixels = (size_t)o->width * (size_t)o->height;
    o->stale = false;
    o->any = o->excluded != NULL;
    if (o->excluded)
        memcpy(o->covered, o->excluded, pixels);
    else
        memset(o->covered, 0, pixels);
    for (int y = 0; y < o->height; y++)
        for (int x = 0; x < o->width; x++) {
            if (o->score[y * o->width + x] < o->parameters->overlay_hits)
                continue;
            o->any = true;
            const int left = x < REACH ? 0 : x - REACH, right = least_of(x + REACH, o->width - 1);
            for (int j = y < REACH ? 0 : y - REACH; j <= least_of(y + REACH, o->height - 1); j++)
                memset(o->covered + (ptrdiff_t)j * o->width + left, 1, (size_t)(right - left + 1));
        }
}

bool l1l2_motion_overlay_covers(L1L2StaticOverlay *o, L1L2Point p)
{
    if (o->stale)
        update(o);
    if (!o->any)
        return false;
    const int x = (int)floor((p.x + o->half_w) / (2.0 * o->half_w) * o->width);
    const int y = (int)floor((p.y + o->half_h) / (2.0 * o->half_h) * o->height);
    return x >= 0 && y >= 0 && x < o->width && y < o->height && o->covered[y * o->width + x] != 0;
}

L1L2Mask l1l2_motion_overlay_mask(L1L2StaticOverlay *o)
{
    if (o->stale)
        update(o);
    return (L1L2Mask){o->any ? o->covered : NULL, o->width, o->height};
}

void l1l2_motion_overlay_age(L1L2StaticOverlay *o)
{
    const int pixels = o->width * o->height;
    for (int i = 0; i < pixels; i++)
        o->score[i] -= o->score[i] > 0;
    o->stale = o->stale || o->any;
}
