/* SPDX-License-Identifier: MIT */
/* What tests of the warp share: pictures surrounded by guard bytes, random similarities, a call of the warp. */
#ifndef WARP_FIXTURE_H
#define WARP_FIXTURE_H

#include <stdlib.h>
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "formats.h"
#include "warp/warp.h"

enum { GUARD = 37, GUARD_BYTE = 0xA5 }; /* guard bytes at each side of every row; GUARD rows above and below */

/* The formats in the order of their numbers. Packed 4:2:2 has no planes of its own: test_packed422.c tests it. */
enum { FIRST_FORMAT = L1L2STAB_FORMAT_GRAY8 };

static inline bool is_packed(int format)
{
    return format >= L1L2STAB_FORMAT_YUY2 && format <= L1L2STAB_FORMAT_VYUY;
}

typedef struct Plane {
    uint8_t *memory, *data;
    ptrdiff_t stride;
    int width, height, components; /* samples */
    int sample_bytes;              /* of all components */
} Plane;

typedef struct Picture {
    const L1L2FormatInfo *format;
    int width, height; /* pixels */
    Plane plane[L1L2_MAX_PLANES];
} Picture;

static inline Picture picture_new(L1L2StabFormat id, int width, int height)
{
    Picture p = {.format = l1l2_image_format_info(id), .width = width, .height = height};
    for (int i = 0; i < p.format->planes; i++) {
        Plane *plane = &p.plane[i];
        plane->width = l1l2_image_plane_size(width, p.format->plane[i].log2_sub_x);
        plane->height = l1l2_image_plane_size(height, p.format->plane[i].log2_sub_y);
        plane->components = p.format->plane[i].components;
        plane->sample_bytes = plane->components * l1l2_image_format_bytes(p.format);
        plane->stride = plane->width * plane->sample_bytes + 2 * GUARD;
        const size_t bytes = (size_t)plane->stride * (size_t)(plane->height + 2 * GUARD);
        plane->memory = malloc(bytes);
        ck_assert_ptr_nonnull(plane->memory);
        memset(plane->memory, GUARD_BYTE, bytes);
        plane->data = plane->memory + GUARD * plane->stride + GUARD;
    }
    return p;
}

static inline void picture_free(Picture *p)
{
    for (int i = 0; i < p->format->planes; i++)
        free(p->plane[i].memory);
}

static inline uint8_t *sample(const Picture *p, int plane, int u, int v)
{
    return p->plane[plane].data + v * p->plane[plane].stride + u * p->plane[plane].sample_bytes;
}

/* A component's level, 0 .. 2^depth - 1. */
static inline int level(const Picture *p, int plane, int u, int v, int component)
{
    const uint8_t *at = sample(p, plane, u, v);
    return p->format->depth > 8 ? (at[2 * component] | at[2 * component + 1] << 8) >> p->format->shift : at[component];
}

static inline void set_level(Picture *p, int plane, int u, int v, int component, int to)
{
    uint8_t *at = sample(p, plane, u, v);
    if (p->format->depth > 8) {
        at[2 * component] = (uint8_t)(to << p->format->shift);
        at[2 * component + 1] = (uint8_t)(to << p->format->shift >> 8);
    } else {
        at[component] = (uint8_t)to;
    }
}

static inline int max_level(const Picture *p)
{
    return (1 << p->format->depth) - 1;
}

static inline void picture_randomize(Picture *p, uint64_t seed)
{
    L1L2Rng rng = l1l2_rng_seeded(seed);
    for (int i = 0; i < p->format->planes; i++)
        for (int v = 0; v < p->plane[i].height; v++)
            for (int k = 0; k < p->plane[i].width * p->plane[i].components; k++)
                set_level(p, i, 0, v, k, (int)l1l2_rng_below(&rng, 1u << p->format->depth));
}

static inline void assert_guards_untouched(const Picture *p)
{
    for (int i = 0; i < p->format->planes; i++) {
        const Plane *plane = &p->plane[i];
        for (int v = -GUARD; v < plane->height + GUARD; v++)
            for (int k = -GUARD; k < plane->width * plane->sample_bytes + GUARD; k++)
                if ((v < 0 || v >= plane->height || k < 0 || k >= plane->width * plane->sample_bytes) &&
                    plane->data[v * plane->stride + k] != GUARD_BYTE)
                    ck_abort_msg("%s plane %d: byte %d of row %d was written", p->format->name, i, k, v);
    }
}

static inline void assert_same_picture(const Picture *a, const Picture *b)
{
    for (int i = 0; i < a->format->planes; i++)
        for (int v = 0; v < a->plane[i].height; v++)
            if (memcmp(sample(a, i, 0, v), sample(b, i, 0, v), (size_t)(a->plane[i].width * a->plane[i].sample_bytes)))
                ck_abort_msg("%s plane %d: row %d differs", a->format->name, i, v);
}

/* For the pictures' format and sizes: bicubic, chroma site left, one thread. */
static inline L1L2WarpConfig warp_config(const Picture *src, const Picture *dst)
{
    return (L1L2WarpConfig){
        .format = src->format,
        .in_width = src->width,
        .in_height = src->height,
        .out_width = dst->width,
        .out_height = dst->height,
        .chroma_site = L1L2STAB_CHROMA_SITE_LEFT,
        .interpolation = L1L2STAB_INTERPOLATION_BICUBIC,
    };
}

static inline void warp_picture_by(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, const Picture *src, Picture *dst)
{
    L1L2Warp *warp;
    ck_assert_int_eq(l1l2_warp_create(&warp, cfg), L1L2STAB_OK);
    const uint8_t *from[4] = {NULL};
    uint8_t *to[4] = {NULL};
    ptrdiff_t from_stride[4] = {0}, to_stride[4] = {0};
    for (int i = 0; i < src->format->planes; i++) {
        from[i] = src->plane[i].data;
        from_stride[i] = src->plane[i].stride;
        to[i] = dst->plane[i].data;
        to_stride[i] = dst->plane[i].stride;
    }
    l1l2_warp_render(warp, map, from, from_stride, to, to_stride);
    l1l2_warp_free(warp);
}

static inline void warp_picture(const L1L2WarpConfig *cfg, const L1L2Mat *map, const Picture *src, Picture *dst)
{
    warp_picture_by(cfg, &(L1L2WarpMap){.affine = *map}, src, dst);
}

static inline double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* Maps such as the stabilizer makes, and a little beyond: zoom 0.75..1.2, up to 0.15 rad, some px off the center. */
static inline L1L2Mat random_similarity(L1L2Rng *rng)
{
    const double zoom = uniform(rng, 0.75, 1.2), angle = uniform(rng, -0.15, 0.15);
    const double x = uniform(rng, -6.0, 6.0), y = uniform(rng, -6.0, 6.0);
    return l1l2_mat_similarity(zoom * cos(angle), zoom * sin(angle), x, y);
}

#endif
