/* SPDX-License-Identifier: MIT */
/* The pass across for SSE2. A vector of words holds four taps of each of two outputs, and pmaddwd weighs them. */
#include "common/intrinsics.h"

#include "image/area_scale_row.h"

static inline __m128i load_two(const int16_t *low, const int16_t *high)
{
    return _mm_unpacklo_epi64(_mm_loadl_epi64((const void *)low), _mm_loadl_epi64((const void *)high));
}

static void row(const int16_t *samples, const int32_t *first, const int16_t *weight, int taps, int count, int32_t *sum)
{
    for (int x = 0; x < count; x += L1L2_AREA_SCALE_BLOCK) {
        /* Each output has two halves of its sum: outputs 0 and 1 in a, 2 and 3 in b. */
        __m128i a = _mm_setzero_si128(), b = a;
        for (int k = 0; k < taps; k += L1L2_AREA_SCALE_BLOCK, weight += 16) {
            const int16_t *from = samples + k;
            const __m128i low = load_two(from + first[x], from + first[x + 1]);
            const __m128i high = load_two(from + first[x + 2], from + first[x + 3]);
            a = _mm_add_epi32(a, _mm_madd_epi16(low, _mm_loadu_si128((const void *)weight)));
            b = _mm_add_epi32(b, _mm_madd_epi16(high, _mm_loadu_si128((const void *)(weight + 8))));
        }
        const __m128 c = _mm_castsi128_ps(a), d = _mm_castsi128_ps(b);
        const __m128i even = _mm_castps_si128(_mm_shuffle_ps(c, d, _MM_SHUFFLE(2, 0, 2, 0)));
        const __m128i odd = _mm_castps_si128(_mm_shuffle_ps(c, d, _MM_SHUFFLE(3, 1, 3, 1)));
        _mm_storeu_si128((void *)(sum + x), _mm_add_epi32(even, odd));
    }
}

void l1l2_image_scale_functions_init_sse2(L1L2AreaScaleFunctions *functions)
{
    functions->row = row;
}
