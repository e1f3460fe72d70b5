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
    const size_t pixels = (size_t)width * (size_t)height;
    o->score = l1l2_mem_new(pixels, sizeof *o->score);
    o->told = l1l2_mem_new(pixels, sizeof *o->told);
    o->covered = l1l2_mem_new(pixels, sizeof *o->covered);
    return o->score && o->told && o->covered;
}

void l1l2_motion_overlay_clear(L1L2StaticOverlay *o)
{
    l1l2_mem_free(o->score);
    l1l2_mem_free(o->told);
    l1l2_mem_free(o->covered);
    l1l2_mem_free(o->excluded);
    o->score = o->covered = o->excluded = NULL;
    o->told = NULL;
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
    memset(o->score, 0, pixels);
    memset(o->covered, 0, pixels);
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

/* Two pictures and the camera's motion between them, in their pixels: (x, y) of the current one lies at (u, v) of the
 * previous one, u = u0 + ux x + uy y. */
typedef struct Comparison {
    const L1L2GrayPicture *now, *previous;
    float offset; /* of brightness, from the previous picture to the current one */
    double u0, ux, uy, v0, vx, vy;
} Comparison;

static Comparison compare(const L1L2StaticOverlay *o, const L1L2GrayPicture *now, const L1L2GrayPicture *previous,
                          const L1L2Mat *F)
{
    const double unit_x = 2.0 * o->half_w / o->width, unit_y = 2.0 * o->half_h / o->height;
    const double x0 = 0.5 * unit_x - o->half_w, y0 = 0.5 * unit_y - o->half_h;
    const double *f = F->m;
    return (Comparison){
        .now = now,
        .previous = previous,
        .offset = (float)(mean_of(now) - mean_of(previous)),
        .u0 = (f[0] * x0 + f[1] * y0 + f[2] - x0) / unit_x,
        .ux = f[0],
        .uy = f[1] * unit_y / unit_x,
        .v0 = (f[3] * x0 + f[4] * y0 + f[5] - y0) / unit_y,
        .vx = f[3] * unit_x / unit_y,
        .vy = f[4],
    };
}

/* What a pixel of the current picture tells: 1 it stands still, -1 it does not, 0 nothing. What stands still does not
 * change at all, which distinguishes it from a scene that moves by less than the camera's motion says. */
static int evidence(const Comparison *c, int x, int y, float noise)
{
    const float u = (float)(c->u0 + c->ux * x + c->uy * y), v = (float)(c->v0 + c->vx * x + c->vy * y);
    if (!(u >= 0.0f && v >= 0.0f && u < (float)(c->previous->width - 1) && v < (float)(c->previous->height - 1)))
        return 0;
    const float change = 2.0f * noise, now = (float)c->now->data[y * c->now->stride + x] - c->offset;
    const float as_still = fabsf(now - (float)c->previous->data[y * c->previous->stride + x]);
    if (as_still > change)
        return -1;
    return as_still < noise && fabsf(now - sample_at(c->previous, u, v)) > change ? 1 : 0;
}

/* What each pixel tells, in o->told, and for how many of them it stands still less for how many it moves. */
static int gather_evidence(L1L2StaticOverlay *o, const Comparison *c)
{
    const float noise = (float)o->parameters->overlay_noise;
    int sum = 0;
    for (int y = 0; y < o->height; y++)
        for (int x = 0; x < o->width; x++) {
            const int i = y * o->width + x;
            o->told[i] = (int8_t)(o->excluded && o->excluded[i] ? 0 : evidence(c, x, y, noise));
            sum += o->told[i];
        }
    return sum;
}

/* What stands still is an overlay only if it is the smaller part of what can be seen: else F is a subject's motion. */
void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2GrayPicture *now, const L1L2GrayPicture *previous,
                               const L1L2Mat *F)
{
    const L1L2Mat identity = l1l2_mat_identity();
    const double pixel = o->half_w / o->width; /* of the downscaled picture, which is twice as large */
    const int hits = (int)o->parameters->overlay_hits, pixels = o->width * o->height;
    if (l1l2_mat_corner_distance(F, &identity, o->half_w, o->half_h) < o->parameters->overlay_min_camera * pixel)
        return;
    const Comparison c = compare(o, now, previous, F);
    if (gather_evidence(o, &c) >= 0)
        return;
    for (int i = 0; i < pixels; i++) {
        const int score = o->score[i] + o->told[i], kept = score < 0 ? 0 : score > MOST ? MOST : score;
        o->stale |= (kept >= hits) != (o->score[i] >= hits);
        o->score[i] = (uint8_t)kept;
    }
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
