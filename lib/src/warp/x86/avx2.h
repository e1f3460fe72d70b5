/* SPDX-License-Identifier: MIT */
/*
 * What the direct sample types share for AVX2: a group is eight lanes of 32 bits. It holds 8, 4 or 2 output samples of
 * 1, 2 or 3..4 components. For each half of a group, four lanes, all taps of a row lie within a few bytes of the
 * source. These bytes are called the window of that half.
 */
#ifndef L1L2_WARP_X86_AVX2_H
#define L1L2_WARP_X86_AVX2_H

#include <stdbool.h>

#include "common/intrinsics.h"
#include "warp/sample.h"

#if L1L2_AVX2 /* so that it can be compiled alone on every machine */

/* The weights of two taps in the two words of each lane: for taps 0 and 1, 2 and 3, 4 and 5. */
typedef struct Weights {
    __m256i pair[L1L2_WARP_MAX_TAPS / 2];
} Weights;

L1L2_INLINE __m256i join(__m128i low, __m128i high)
{
    return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

L1L2_INLINE __m256i load_halves(const void *low, const void *high)
{
    return join(_mm_loadu_si128(low), _mm_loadu_si128(high));
}

/* Repeats the value of each sample for all of its components. */
L1L2_INLINE __m256i spread(const int32_t *at, const int components)
{
    if (components == 1)
        return _mm256_loadu_si256((const void *)at);
    const __m256i lanes = components == 2 ? _mm256_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3)
                                          : _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
    const __m128i values = components == 2 ? _mm_loadu_si128((const void *)at) : _mm_loadl_epi64((const void *)at);
    return _mm256_permutevar8x32_epi32(_mm256_castsi128_si256(values), lanes);
}

/* Bilinear weights need no table: phase 0..1023 has the weights ONE - 16 * phase and 16 * phase. */
L1L2_INLINE Weights weights_2(const int32_t *at, const int components)
{
    const __m256i phase = _mm256_and_si256(spread(at, components), _mm256_set1_epi32(L1L2_WARP_PHASES - 1));
    const __m256i second = _mm256_slli_epi32(phase, L1L2_WARP_WEIGHT_BITS - L1L2_WARP_PHASE_BITS);
    const __m256i first = _mm256_sub_epi32(_mm256_set1_epi32(L1L2_WARP_ONE), second);
    return (Weights){{_mm256_or_si256(first, _mm256_slli_epi32(second, 16))}};
}

/* at[]: positions of the group's samples. */
L1L2_INLINE Weights weights_4(const L1L2WarpKernel *kernel, const int32_t *at, const int components)
{
#define PHASE(i) (const void *)(kernel->weights + (at[i] & (L1L2_WARP_PHASES - 1)) * 4)
#define TWO_PHASES(i, j) _mm_unpacklo_epi64(_mm_loadl_epi64(PHASE(i)), _mm_loadl_epi64(PHASE(j)))
    if (components == 1) {
        const __m256 a = _mm256_castsi256_ps(join(TWO_PHASES(0, 1), TWO_PHASES(4, 5)));
        const __m256 b = _mm256_castsi256_ps(join(TWO_PHASES(2, 3), TWO_PHASES(6, 7)));
        return (Weights){{_mm256_castps_si256(_mm256_shuffle_ps(a, b, _MM_SHUFFLE(2, 0, 2, 0))),
                          _mm256_castps_si256(_mm256_shuffle_ps(a, b, _MM_SHUFFLE(3, 1, 3, 1)))}};
    }
    if (components == 2) {
        const __m256i a = join(TWO_PHASES(0, 1), TWO_PHASES(2, 3));
        return (Weights){{_mm256_shuffle_epi32(a, _MM_SHUFFLE(2, 2, 0, 0)),
                          _mm256_shuffle_epi32(a, _MM_SHUFFLE(3, 3, 1, 1))}};
    }
    const __m256i a = join(_mm_loadl_epi64(PHASE(0)), _mm_loadl_epi64(PHASE(1)));
    return (Weights){{_mm256_shuffle_epi32(a, 0x00), _mm256_shuffle_epi32(a, 0x55)}};
#undef TWO_PHASES
#undef PHASE
}

L1L2_INLINE Weights weights_6(const L1L2WarpKernel *kernel, const int32_t *at, const int components)
{
#define PHASE(i) (const void *)(kernel->weights + (at[i] & (L1L2_WARP_PHASES - 1)) * 8)
    if (components == 1) {
        const __m256i a = load_halves(PHASE(0), PHASE(4)), b = load_halves(PHASE(1), PHASE(5));
        const __m256i c = load_halves(PHASE(2), PHASE(6)), d = load_halves(PHASE(3), PHASE(7));
        const __m256i ab = _mm256_unpacklo_epi32(a, b), cd = _mm256_unpacklo_epi32(c, d);
        return (Weights){{_mm256_unpacklo_epi64(ab, cd), _mm256_unpackhi_epi64(ab, cd),
                          _mm256_unpacklo_epi64(_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, d))}};
    }
    if (components == 2) {
        const __m256i a = load_halves(PHASE(0), PHASE(2)), b = load_halves(PHASE(1), PHASE(3));
        const __m256i ab = _mm256_unpacklo_epi32(a, b);
        return (Weights){{_mm256_shuffle_epi32(ab, _MM_SHUFFLE(1, 1, 0, 0)),
                          _mm256_shuffle_epi32(ab, _MM_SHUFFLE(3, 3, 2, 2)),
                          _mm256_shuffle_epi32(_mm256_unpackhi_epi32(a, b), _MM_SHUFFLE(1, 1, 0, 0))}};
    }
    const __m256i a = load_halves(PHASE(0), PHASE(1));
    return (Weights){{_mm256_shuffle_epi32(a, 0x00), _mm256_shuffle_epi32(a, 0x55), _mm256_shuffle_epi32(a, 0xAA)}};
#undef PHASE
}

L1L2_INLINE Weights load_weights(const L1L2WarpKernel *kernel, const int32_t *at, const int taps, const int components)
{
    return taps == 2 ? weights_2(at, components)
         : taps == 4 ? weights_4(kernel, at, components) : weights_6(kernel, at, components);
}

typedef struct Reach {
    uint32_t columns, rows; /* windows whose first tap is below these, and not negative, lie in the plane */
} Reach;

L1L2_INLINE int first_tap(int32_t at, const int taps)
{
    return (at >> L1L2_WARP_PHASE_BITS) - (taps / 2 - 1);
}

/* For each lane, whole samples from the first position of its half, along one axis. */
L1L2_INLINE __m256i from_first(const int32_t *at, const int components)
{
    const __m256i whole = _mm256_srai_epi32(spread(at, components), L1L2_WARP_PHASE_BITS);
    return _mm256_sub_epi32(whole, _mm256_shuffle_epi32(whole, 0x00));
}

L1L2_INLINE bool all_within(__m256i offset, int limit)
{
    const __m256i limits = _mm256_set1_epi32(limit);
    return _mm256_movemask_epi8(_mm256_cmpeq_epi32(_mm256_max_epu32(offset, limits), limits)) == -1;
}

#endif

#endif
