/* SPDX-License-Identifier: MIT */
/*
 * scale.c's step across: weighted sums of a row's samples. Output x sums `taps` samples, a multiple of 4, from first[x]
 * on. Outputs and taps come in blocks of 4 x 4: the weights of four outputs' first four taps, of their next four, ...
 * SSE2 is what every x86-64 has, so it is not chosen at run time; it gives the sums of plain C.
 */
#ifndef L1L2_IMAGE_AREA_SCALE_ROW_H
#define L1L2_IMAGE_AREA_SCALE_ROW_H

#include <stdint.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { L1L2_SCALE_BLOCK = 4 };

/* count: of outputs, a multiple of 4. */
static inline void l1l2_image_scale_row_plain(const int16_t *samples, const int32_t *first, const int16_t *weight,
                                              int taps, int count, int32_t *sum)
{
    for (int x = 0; x < count; x += L1L2_SCALE_BLOCK) {
        int32_t s[L1L2_SCALE_BLOCK] = {0};
        for (int k = 0; k < taps; k += L1L2_SCALE_BLOCK)
            for (int i = 0; i < L1L2_SCALE_BLOCK; i++, weight += L1L2_SCALE_BLOCK)
                for (int j = 0; j < L1L2_SCALE_BLOCK; j++)
                    s[i] += samples[first[x + i] + k + j] * weight[j];
        for (int i = 0; i < L1L2_SCALE_BLOCK; i++)
            sum[x + i] = s[i];
    }
}

#ifdef __SSE2__
static inline __m128i l1l2_image_scale_row_load(const int16_t *low, const int16_t *high)
{
    return _mm_unpacklo_epi64(_mm_loadl_epi64((const void *)low), _mm_loadl_epi64((const void *)high));
}

static inline void l1l2_image_scale_row_sse2(const int16_t *samples, const int32_t *first, const int16_t *weight,
                                             int taps, int count, int32_t *sum)
{
    for (int x = 0; x < count; x += L1L2_SCALE_BLOCK) {
        __m128i a = _mm_setzero_si128(), b = a; /* two halves of the sum of outputs 0 and 1, and of 2 and 3 */
        for (int k = 0; k < taps; k += L1L2_SCALE_BLOCK, weight += 16) {
            const int16_t *from = samples + k;
            const __m128i low = l1l2_image_scale_row_load(from + first[x], from + first[x + 1]);
            const __m128i high = l1l2_image_scale_row_load(from + first[x + 2], from + first[x + 3]);
            a = _mm_add_epi32(a, _mm_madd_epi16(low, _mm_loadu_si128((const void *)weight)));
            b = _mm_add_epi32(b, _mm_madd_epi16(high, _mm_loadu_si128((const void *)(weight + 8))));
        }
        const __m128 c = _mm_castsi128_ps(a), d = _mm_castsi128_ps(b);
        const __m128i even = _mm_castps_si128(_mm_shuffle_ps(c, d, _MM_SHUFFLE(2, 0, 2, 0)));
        const __m128i odd = _mm_castps_si128(_mm_shuffle_ps(c, d, _MM_SHUFFLE(3, 1, 3, 1)));
        _mm_storeu_si128((void *)(sum + x), _mm_add_epi32(even, odd));
    }
}
#define l1l2_image_scale_row l1l2_image_scale_row_sse2
#else
#define l1l2_image_scale_row l1l2_image_scale_row_plain
#endif

#endif
