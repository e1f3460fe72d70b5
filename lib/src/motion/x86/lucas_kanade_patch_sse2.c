/* SPDX-License-Identifier: MIT */
/* The inner loops for SSE2. A row of the window is 12 pixels in words, of which the last is set to zero. */
#include "common/intrinsics.h"
#include <string.h>

#include "motion/lucas_kanade_patch.h"

/* Two weights in each of the four pairs of words. */
static inline __m128i repeat_pair(const int16_t *w)
{
    return _mm_set1_epi32((int)((uint32_t)(uint16_t)w[0] | (uint32_t)(uint16_t)w[1] << 16));
}

/* Twelve pairs of a row of pixels: each pixel and the one on its right. */
typedef struct Row {
    __m128i pair[3];
} Row;

static inline Row load_row(const uint8_t *p)
{
    const __m128i zero = _mm_setzero_si128();
    const __m128i left = _mm_loadu_si128((const void *)p), right = _mm_loadu_si128((const void *)(p + 1));
    const __m128i low = _mm_unpacklo_epi8(left, right), high = _mm_unpackhi_epi8(left, right);
    return (Row){{_mm_unpacklo_epi8(low, zero), _mm_unpackhi_epi8(low, zero), _mm_unpacklo_epi8(high, zero)}};
}

/* Twelve sampled gray levels; greys[1] has the last 4 of them and 4 zeros. upper, lower: weights of the two rows. */
static inline void sample_grey(const Row *above, const Row *below, __m128i upper, __m128i lower, __m128i greys[2])
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

/* The sampled slopes of four pixels: across in slopes[0], down in slopes[1]. */
static inline void sample_slopes(const int16_t *p, ptrdiff_t stride, __m128i upper, __m128i lower, __m128i slopes[2])
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

static inline int64_t total(__m128i sums)
{
    int32_t of[4];
    _mm_storeu_si128((void *)of, sums);
    return (int64_t)of[0] + of[1] + of[2] + of[3];
}

/* sums + the products of a row's 16 words, a * b. */
static inline __m128i add_products(__m128i sums, const __m128i a[2], const __m128i b[2])
{
    return _mm_add_epi32(sums, _mm_add_epi32(_mm_madd_epi16(a[0], b[0]), _mm_madd_epi16(a[1], b[1])));
}

static L1L2LkSums take(const L1L2LkLevel *level, const L1L2LkPlace *place, L1L2LkPatch *patch)
{
    const __m128i upper = repeat_pair(place->weight), lower = repeat_pair(place->weight + 2);
    const __m128i inside = _mm_setr_epi16(-1, -1, -1, 0, 0, 0, 0, 0); /* cuts off the twelfth pixel */
    const uint8_t *grey = level->grey + level->stride * place->y + place->x;
    const int16_t *slope = level->slope + level->slope_stride * place->y + 2 * place->x;
    __m128i xx = _mm_setzero_si128(), xy = xx, yy = xx;
    Row above = load_row(grey);
    for (int y = 0; y < L1L2_LK_WINDOW; y++, slope += level->slope_stride) {
        const Row below = load_row(grey += level->stride);
        __m128i greys[2], first[2], second[2], third[2];
        sample_grey(&above, &below, upper, lower, greys);
        above = below;
        sample_slopes(slope, level->slope_stride, upper, lower, first);
        sample_slopes(slope + 8, level->slope_stride, upper, lower, second);
        sample_slopes(slope + 16, level->slope_stride, upper, lower, third);
        const __m128i across[2] = {_mm_packs_epi32(first[0], second[0]),
                                   _mm_and_si128(_mm_packs_epi32(third[0], third[0]), inside)};
        const __m128i down[2] = {_mm_packs_epi32(first[1], second[1]),
                                 _mm_and_si128(_mm_packs_epi32(third[1], third[1]), inside)};
        greys[1] = _mm_and_si128(greys[1], inside);
        memcpy(patch->grey[y], greys, sizeof greys);
        memcpy(patch->across[y], across, sizeof across);
        memcpy(patch->down[y], down, sizeof down);
        xx = add_products(xx, across, across);
        xy = add_products(xy, across, down);
        yy = add_products(yy, down, down);
    }
    return (L1L2LkSums){{total(xx), total(xy), total(yy)}};
}

static L1L2LkSums compare(const L1L2LkLevel *level, const L1L2LkPlace *place, const L1L2LkPatch *patch)
{
    const __m128i upper = repeat_pair(place->weight), lower = repeat_pair(place->weight + 2);
    const uint8_t *grey = level->grey + level->stride * place->y + place->x;
    __m128i x_sums = _mm_setzero_si128(), y_sums = x_sums;
    Row above = load_row(grey);
    for (int y = 0; y < L1L2_LK_WINDOW; y++) {
        const Row below = load_row(grey += level->stride);
        __m128i more[2], old[2], across[2], down[2];
        sample_grey(&above, &below, upper, lower, more);
        above = below;
        memcpy(old, patch->grey[y], sizeof old);
        memcpy(across, patch->across[y], sizeof across);
        memcpy(down, patch->down[y], sizeof down);
        more[0] = _mm_sub_epi16(more[0], old[0]);
        more[1] = _mm_sub_epi16(more[1], old[1]);
        x_sums = add_products(x_sums, more, across);
        y_sums = add_products(y_sums, more, down);
    }
    return (L1L2LkSums){{total(x_sums), total(y_sums), 0}};
}

void l1l2_lk_functions_init_sse2(L1L2LkFunctions *functions)
{
    *functions = (L1L2LkFunctions){take, compare};
}
