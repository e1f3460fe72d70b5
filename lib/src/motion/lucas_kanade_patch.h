/* SPDX-License-Identifier: MIT */
/*
 * flow.c's inner loops: a window sampled between pixels, by bilinear weights of 14 bits. SSE2 is what every x86-64 has,
 * so it is not chosen at run time; it gives the sums of plain C.
 */
#ifndef L1L2_MOTION_LUCAS_KANADE_PATCH_H
#define L1L2_MOTION_LUCAS_KANADE_PATCH_H

#include <string.h>

#include "motion/lucas_kanade.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum {
    L1L2_LK_LANES = 16, /* of a row: the window's, and zeros */
    L1L2_LK_WEIGHT_BITS = 14,
    L1L2_LK_GREY_SHIFT = L1L2_LK_WEIGHT_BITS - 5,
    L1L2_LK_GREY_ROUND = 1 << (L1L2_LK_GREY_SHIFT - 1),
    L1L2_LK_SLOPE_ROUND = 1 << (L1L2_LK_WEIGHT_BITS - 1)
};

/* The window's first pixel, and the weights of it, of the one on its right, and of the two below. */
typedef struct L1L2LkPlace {
    int x, y;
    int16_t weight[4];
} L1L2LkPlace;

typedef struct L1L2LkPatch {
    int16_t grey[L1L2_LK_WINDOW][L1L2_LK_LANES];
    int16_t across[L1L2_LK_WINDOW][L1L2_LK_LANES], down[L1L2_LK_WINDOW][L1L2_LK_LANES];
} L1L2LkPatch;

/* Sums over the window. Of slopes: across squared, across times down, down squared. Of what a picture has more than the
 * patch: times across, times down. */
typedef struct L1L2LkSums {
    int64_t of[3];
} L1L2LkSums;

/* A slope is 4080 at most, a difference of greys 8160, a window 121 pixels: a quarter of the sums fits 32 bits. */

static inline int l1l2_lk_sample_plain(const uint8_t *p, ptrdiff_t stride, const int16_t *w)
{
    return (p[0] * w[0] + p[1] * w[1] + p[stride] * w[2] + p[stride + 1] * w[3] + L1L2_LK_GREY_ROUND) >>
           L1L2_LK_GREY_SHIFT;
}

static inline int l1l2_lk_slope_plain(const int16_t *p, ptrdiff_t stride, const int16_t *w)
{
    return (p[0] * w[0] + p[2] * w[1] + p[stride] * w[2] + p[stride + 2] * w[3] + L1L2_LK_SLOPE_ROUND) >>
           L1L2_LK_WEIGHT_BITS;
}

static inline L1L2LkSums l1l2_lk_take_plain(const L1L2LkLevel *level, const L1L2LkPlace *place,
                                                L1L2LkPatch *patch)
{
    L1L2LkSums sums = {{0}};
    memset(patch, 0, sizeof *patch);
    for (int y = 0; y < L1L2_LK_WINDOW; y++)
        for (int x = 0; x < L1L2_LK_WINDOW; x++) {
            const int column = place->x + x, row = place->y + y;
            const int16_t *slope = level->slope + level->slope_stride * row + 2 * column;
            const int grey =
                l1l2_lk_sample_plain(level->grey + level->stride * row + column, level->stride, place->weight);
            const int across = l1l2_lk_slope_plain(slope, level->slope_stride, place->weight);
            const int down = l1l2_lk_slope_plain(slope + 1, level->slope_stride, place->weight);
            patch->grey[y][x] = (int16_t)grey;
            patch->across[y][x] = (int16_t)across;
            patch->down[y][x] = (int16_t)down;
            sums.of[0] += across * across, sums.of[1] += across * down, sums.of[2] += down * down;
        }
    return sums;
}

static inline L1L2LkSums l1l2_lk_compare_plain(const L1L2LkLevel *level, const L1L2LkPlace *place,
                                                   const L1L2LkPatch *patch)
{
    L1L2LkSums sums = {{0}};
    for (int y = 0; y < L1L2_LK_WINDOW; y++)
        for (int x = 0; x < L1L2_LK_WINDOW; x++) {
            const uint8_t *at = level->grey + level->stride * (place->y + y) + place->x + x;
            const int more = l1l2_lk_sample_plain(at, level->stride, place->weight) - patch->grey[y][x];
            sums.of[0] += more * patch->across[y][x], sums.of[1] += more * patch->down[y][x];
        }
    return sums;
}

#ifdef __SSE2__
/* Two weights, over and over. */
static inline __m128i l1l2_lk_pair(const int16_t *w)
{
    return _mm_set1_epi32((int)((uint32_t)(uint16_t)w[0] | (uint32_t)(uint16_t)w[1] << 16));
}

/* Of a row, each pixel and the one on its right: 12 pairs. */
typedef struct L1L2LkRow {
    __m128i pair[3];
} L1L2LkRow;

static inline L1L2LkRow l1l2_lk_load(const uint8_t *p)
{
    const __m128i zero = _mm_setzero_si128();
    const __m128i left = _mm_loadu_si128((const void *)p), right = _mm_loadu_si128((const void *)(p + 1));
    const __m128i low = _mm_unpacklo_epi8(left, right), high = _mm_unpackhi_epi8(left, right);
    return (L1L2LkRow){{_mm_unpacklo_epi8(low, zero), _mm_unpackhi_epi8(low, zero), _mm_unpacklo_epi8(high, zero)}};
}

/* 12 samples; greys[1] has 4 and 4 zeros. */
static inline void l1l2_lk_sample(const L1L2LkRow *above, const L1L2LkRow *below, __m128i upper, __m128i lower,
                                    __m128i greys[2])
{
    const __m128i round = _mm_set1_epi32(L1L2_LK_GREY_ROUND);
    __m128i s[3];
    for (int i = 0; i < 3; i++) {
        const __m128i sum =
            _mm_add_epi32(_mm_madd_epi16(above->pair[i], upper), _mm_madd_epi16(below->pair[i], lower));
        s[i] = _mm_srai_epi32(_mm_add_epi32(sum, round), L1L2_LK_GREY_SHIFT);
    }
    greys[0] = _mm_packs_epi32(s[0], s[1]);
    greys[1] = _mm_packs_epi32(s[2], _mm_setzero_si128());
}

/* Of four pixels the slopes, across in the first and down in the second. */
static inline void l1l2_lk_slopes(const int16_t *p, ptrdiff_t stride, __m128i upper, __m128i lower,
                                    __m128i slopes[2])
{
    const __m128i round = _mm_set1_epi32(L1L2_LK_SLOPE_ROUND);
    const __m128i a = _mm_loadu_si128((const void *)p), b = _mm_loadu_si128((const void *)(p + 2));
    const __m128i c = _mm_loadu_si128((const void *)(p + stride)), d = _mm_loadu_si128((const void *)(p + stride + 2));
    const __m128i low = _mm_add_epi32(_mm_madd_epi16(_mm_unpacklo_epi16(a, b), upper),
                                      _mm_madd_epi16(_mm_unpacklo_epi16(c, d), lower));
    const __m128i high = _mm_add_epi32(_mm_madd_epi16(_mm_unpackhi_epi16(a, b), upper),
                                       _mm_madd_epi16(_mm_unpackhi_epi16(c, d), lower));
    const __m128 l = _mm_castsi128_ps(_mm_srai_epi32(_mm_add_epi32(low, round), L1L2_LK_WEIGHT_BITS));
    const __m128 h = _mm_castsi128_ps(_mm_srai_epi32(_mm_add_epi32(high, round), L1L2_LK_WEIGHT_BITS));
    slopes[0] = _mm_castps_si128(_mm_shuffle_ps(l, h, _MM_SHUFFLE(2, 0, 2, 0)));
    slopes[1] = _mm_castps_si128(_mm_shuffle_ps(l, h, _MM_SHUFFLE(3, 1, 3, 1)));
}

static inline int64_t l1l2_lk_total(__m128i sums)
{
    int32_t of[4];
    _mm_storeu_si128((void *)of, sums);
    return (int64_t)of[0] + of[1] + of[2] + of[3];
}

/* sums += a * b of a row's 16 lanes */
static inline __m128i l1l2_lk_add(__m128i sums, const __m128i a[2], const __m128i b[2])
{
    return _mm_add_epi32(sums, _mm_add_epi32(_mm_madd_epi16(a[0], b[0]), _mm_madd_epi16(a[1], b[1])));
}

static inline L1L2LkSums l1l2_lk_take_sse2(const L1L2LkLevel *level, const L1L2LkPlace *place,
                                               L1L2LkPatch *patch)
{
    const __m128i upper = l1l2_lk_pair(place->weight), lower = l1l2_lk_pair(place->weight + 2);
    const __m128i inside = _mm_setr_epi16(-1, -1, -1, 0, 0, 0, 0, 0); /* the twelfth pixel is beyond the window */
    const uint8_t *grey = level->grey + level->stride * place->y + place->x;
    const int16_t *slope = level->slope + level->slope_stride * place->y + 2 * place->x;
    __m128i xx = _mm_setzero_si128(), xy = xx, yy = xx;
    L1L2LkRow above = l1l2_lk_load(grey);
    for (int y = 0; y < L1L2_LK_WINDOW; y++, slope += level->slope_stride) {
        const L1L2LkRow below = l1l2_lk_load(grey += level->stride);
        __m128i greys[2], first[2], second[2], third[2];
        l1l2_lk_sample(&above, &below, upper, lower, greys);
        above = below;
        l1l2_lk_slopes(slope, level->slope_stride, upper, lower, first);
        l1l2_lk_slopes(slope + 8, level->slope_stride, upper, lower, second);
        l1l2_lk_slopes(slope + 16, level->slope_stride, upper, lower, third);
        const __m128i across[2] = {_mm_packs_epi32(first[0], second[0]),
                                   _mm_and_si128(_mm_packs_epi32(third[0], third[0]), inside)};
        const __m128i down[2] = {_mm_packs_epi32(first[1], second[1]),
                                 _mm_and_si128(_mm_packs_epi32(third[1], third[1]), inside)};
        greys[1] = _mm_and_si128(greys[1], inside);
        memcpy(patch->grey[y], greys, sizeof greys);
        memcpy(patch->across[y], across, sizeof across);
        memcpy(patch->down[y], down, sizeof down);
        xx = l1l2_lk_add(xx, across, across);
        xy = l1l2_lk_add(xy, across, down);
        yy = l1l2_lk_add(yy, down, down);
    }
    return (L1L2LkSums){{l1l2_lk_total(xx), l1l2_lk_total(xy), l1l2_lk_total(yy)}};
}

static inline L1L2LkSums l1l2_lk_compare_sse2(const L1L2LkLevel *level, const L1L2LkPlace *place,
                                                  const L1L2LkPatch *patch)
{
    const __m128i upper = l1l2_lk_pair(place->weight), lower = l1l2_lk_pair(place->weight + 2);
    const uint8_t *grey = level->grey + level->stride * place->y + place->x;
    __m128i x_sums = _mm_setzero_si128(), y_sums = x_sums;
    L1L2LkRow above = l1l2_lk_load(grey);
    for (int y = 0; y < L1L2_LK_WINDOW; y++) {
        const L1L2LkRow below = l1l2_lk_load(grey += level->stride);
        __m128i more[2], old[2], across[2], down[2];
        l1l2_lk_sample(&above, &below, upper, lower, more);
        above = below;
        memcpy(old, patch->grey[y], sizeof old);
        memcpy(across, patch->across[y], sizeof across);
        memcpy(down, patch->down[y], sizeof down);
        more[0] = _mm_sub_epi16(more[0], old[0]);
        more[1] = _mm_sub_epi16(more[1], old[1]);
        x_sums = l1l2_lk_add(x_sums, more, across);
        y_sums = l1l2_lk_add(y_sums, more, down);
    }
    return (L1L2LkSums){{l1l2_lk_total(x_sums), l1l2_lk_total(y_sums), 0}};
}
#define l1l2_lk_take l1l2_lk_take_sse2
#define l1l2_lk_compare l1l2_lk_compare_sse2
#else
#define l1l2_lk_take l1l2_lk_take_plain
#define l1l2_lk_compare l1l2_lk_compare_plain
#endif

#endif
