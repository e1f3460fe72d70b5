/* SPDX-License-Identifier: MIT */
/*
 * The intrinsics of AVX2 that the library uses, by SIMDe's of 128 bits: a vector of 256 bits is a struct of its two
 * halves. SIMDe has them too, but gcc keeps its vectors of 256 bits in memory, which takes up to three times as many
 * instructions. Included by intrinsics.h alone, on ARM.
 */
#ifndef L1L2_COMMON_AVX2_HALVES_H
#define L1L2_COMMON_AVX2_HALVES_H

#include "common/compiler.h"

#if defined(L1L2_HAVE_SIMD) && defined(__aarch64__) /* so that it can be compiled alone on every machine */

#include <arm_neon.h>
#include <simde/x86/sse4.1.h>

typedef struct L1L2Halves {
    __m128i low, high;
} L1L2Halves;

#define __m256i L1L2Halves
#define __m256 L1L2Halves

#define L1L2_HALVES(low, high) ((L1L2Halves){low, high})

/* Two of SIMDe's take several instructions on NEON, for operands that the library never has. */

/* The same where not both are -32768: NEON's product is then limited to 32767. */
L1L2_INLINE __m128i l1l2_mulhrs_epi16(__m128i a, __m128i b)
{
    return vreinterpretq_s64_s16(vqrdmulhq_s16(vreinterpretq_s16_s64(a), vreinterpretq_s16_s64(b)));
}

/* The same where all bits of each byte of the mask are equal. */
L1L2_INLINE __m128i l1l2_blendv_epi8(__m128i a, __m128i b, __m128i mask)
{
    return vbslq_s64(vreinterpretq_u64_s64(mask), b, a);
}

/* Operations on the halves by themselves */

#define L1L2_EACH(name, half)                                                                                         \
    L1L2_INLINE L1L2Halves name(L1L2Halves a, L1L2Halves b)                                                            \
    {                                                                                                                 \
        return L1L2_HALVES(half(a.low, b.low), half(a.high, b.high));                                                  \
    }

L1L2_EACH(_mm256_add_epi8, _mm_add_epi8)
L1L2_EACH(_mm256_add_epi16, _mm_add_epi16)
L1L2_EACH(_mm256_add_epi32, _mm_add_epi32)
L1L2_EACH(_mm256_add_epi64, _mm_add_epi64)
L1L2_EACH(_mm256_sub_epi16, _mm_sub_epi16)
L1L2_EACH(_mm256_sub_epi32, _mm_sub_epi32)
L1L2_EACH(_mm256_mulhrs_epi16, l1l2_mulhrs_epi16)
L1L2_EACH(_mm256_mullo_epi16, _mm_mullo_epi16)
L1L2_EACH(_mm256_mullo_epi32, _mm_mullo_epi32)
L1L2_EACH(_mm256_madd_epi16, _mm_madd_epi16)
L1L2_EACH(_mm256_min_epu16, _mm_min_epu16)
L1L2_EACH(_mm256_max_epu32, _mm_max_epu32)
L1L2_EACH(_mm256_and_si256, _mm_and_si128)
L1L2_EACH(_mm256_andnot_si256, _mm_andnot_si128)
L1L2_EACH(_mm256_or_si256, _mm_or_si128)
L1L2_EACH(_mm256_xor_si256, _mm_xor_si128)
L1L2_EACH(_mm256_cmpeq_epi16, _mm_cmpeq_epi16)
L1L2_EACH(_mm256_cmpeq_epi32, _mm_cmpeq_epi32)
L1L2_EACH(_mm256_cmpgt_epi16, _mm_cmpgt_epi16)
L1L2_EACH(_mm256_packs_epi32, _mm_packs_epi32)
L1L2_EACH(_mm256_packus_epi32, _mm_packus_epi32)
L1L2_EACH(_mm256_unpacklo_epi16, _mm_unpacklo_epi16)
L1L2_EACH(_mm256_unpackhi_epi16, _mm_unpackhi_epi16)
L1L2_EACH(_mm256_unpacklo_epi32, _mm_unpacklo_epi32)
L1L2_EACH(_mm256_unpackhi_epi32, _mm_unpackhi_epi32)
L1L2_EACH(_mm256_unpacklo_epi64, _mm_unpacklo_epi64)
L1L2_EACH(_mm256_unpackhi_epi64, _mm_unpackhi_epi64)
L1L2_EACH(_mm256_shuffle_epi8, _mm_shuffle_epi8)

#undef L1L2_EACH

L1L2_INLINE L1L2Halves _mm256_blendv_epi8(L1L2Halves a, L1L2Halves b, L1L2Halves mask)
{
    return L1L2_HALVES(l1l2_blendv_epi8(a.low, b.low, mask.low), l1l2_blendv_epi8(a.high, b.high, mask.high));
}

/* With a constant, or with a count in a vector. They are macros because the constant has to stay one. */
#define L1L2_EACH_BY(half, a, by) L1L2_HALVES(half((a).low, by), half((a).high, by))

#define _mm256_slli_epi16(a, count) L1L2_EACH_BY(_mm_slli_epi16, a, count)
#define _mm256_slli_epi32(a, count) L1L2_EACH_BY(_mm_slli_epi32, a, count)
#define _mm256_srli_epi16(a, count) L1L2_EACH_BY(_mm_srli_epi16, a, count)
#define _mm256_srli_epi32(a, count) L1L2_EACH_BY(_mm_srli_epi32, a, count)
#define _mm256_srli_epi64(a, count) L1L2_EACH_BY(_mm_srli_epi64, a, count)
#define _mm256_srai_epi16(a, count) L1L2_EACH_BY(_mm_srai_epi16, a, count)
#define _mm256_srai_epi32(a, count) L1L2_EACH_BY(_mm_srai_epi32, a, count)
#define _mm256_sll_epi16(a, count) L1L2_EACH_BY(_mm_sll_epi16, a, count)
#define _mm256_sll_epi32(a, count) L1L2_EACH_BY(_mm_sll_epi32, a, count)
#define _mm256_srl_epi16(a, count) L1L2_EACH_BY(_mm_srl_epi16, a, count)
#define _mm256_srl_epi32(a, count) L1L2_EACH_BY(_mm_srl_epi32, a, count)
#define _mm256_sra_epi32(a, count) L1L2_EACH_BY(_mm_sra_epi32, a, count)
#define _mm256_shuffle_epi32(a, order) L1L2_EACH_BY(_mm_shuffle_epi32, a, order)
#define _mm256_shufflelo_epi16(a, order) L1L2_EACH_BY(_mm_shufflelo_epi16, a, order)
#define _mm256_shufflehi_epi16(a, order) L1L2_EACH_BY(_mm_shufflehi_epi16, a, order)

#define _mm256_blend_epi16(a, b, mask)                                                                                \
    L1L2_HALVES(_mm_blend_epi16((a).low, (b).low, mask), _mm_blend_epi16((a).high, (b).high, mask))
#define L1L2_SHUFFLE_PS(a, b, order)                                                                                  \
    _mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(a), _mm_castsi128_ps(b), order))
#define _mm256_shuffle_ps(a, b, order)                                                                                \
    L1L2_HALVES(L1L2_SHUFFLE_PS((a).low, (b).low, order), L1L2_SHUFFLE_PS((a).high, (b).high, order))

/* Halves and wholes. Only 1, the high half, is inserted or extracted. */
#define _mm256_castsi256_ps(a) (a)
#define _mm256_castps_si256(a) (a)
#define _mm256_castsi256_si128(a) ((a).low)
#define _mm256_castsi128_si256(a) L1L2_HALVES(a, a)
#define _mm256_extracti128_si256(a, one) ((a).high)
#define _mm256_inserti128_si256(a, b, one) L1L2_HALVES((a).low, b)

L1L2_INLINE L1L2Halves _mm256_broadcastsi128_si256(__m128i a)
{
    return L1L2_HALVES(a, a);
}

L1L2_INLINE L1L2Halves _mm256_loadu_si256(const void *at)
{
    return L1L2_HALVES(_mm_loadu_si128(at), _mm_loadu_si128((const uint8_t *)at + 16));
}

L1L2_INLINE void _mm256_storeu_si256(void *at, L1L2Halves a)
{
    _mm_storeu_si128(at, a.low);
    _mm_storeu_si128((void *)((uint8_t *)at + 16), a.high);
}

#define _mm256_setzero_si256() _mm256_broadcastsi128_si256(_mm_setzero_si128())
#define _mm256_set1_epi8(value) _mm256_broadcastsi128_si256(_mm_set1_epi8(value))
#define _mm256_set1_epi16(value) _mm256_broadcastsi128_si256(_mm_set1_epi16(value))
#define _mm256_set1_epi32(value) _mm256_broadcastsi128_si256(_mm_set1_epi32(value))
#define _mm256_set1_epi64x(value) _mm256_broadcastsi128_si256(_mm_set1_epi64x(value))
#define _mm256_setr_epi64x(a, b, c, d) L1L2_HALVES(_mm_set_epi64x(b, a), _mm_set_epi64x(d, c))
#define _mm256_setr_epi32(a, b, c, d, e, f, g, h) L1L2_HALVES(_mm_setr_epi32(a, b, c, d), _mm_setr_epi32(e, f, g, h))
#define _mm256_setr_epi8(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p,                                               \
                         q, r, s, t, u, v, w, x, y, z, A, B, C, D, E, F)                                               \
    L1L2_HALVES(_mm_setr_epi8(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p),                                         \
                _mm_setr_epi8(q, r, s, t, u, v, w, x, y, z, A, B, C, D, E, F))

/* Across the halves */

L1L2_INLINE __m128i l1l2_lookup_epi32(L1L2Halves a, __m128i index)
{
    const uint8x16x2_t table = {{vreinterpretq_u8_s64(a.low), vreinterpretq_u8_s64(a.high)}};
    const uint32x4_t first = vmulq_n_u32(vreinterpretq_u32_s64(index), 0x04040404);
    return vreinterpretq_s64_u8(vqtbl2q_u8(table, vreinterpretq_u8_u32(vaddq_u32(first, vdupq_n_u32(0x03020100)))));
}

L1L2_INLINE L1L2Halves _mm256_permutevar8x32_epi32(L1L2Halves a, L1L2Halves index)
{
    return L1L2_HALVES(l1l2_lookup_epi32(a, index.low), l1l2_lookup_epi32(a, index.high));
}

L1L2_INLINE L1L2Halves _mm256_permute4x64_epi64(L1L2Halves a, const int order)
{
    const int i = 2 * (order & 3), j = 2 * (order >> 2 & 3), k = 2 * (order >> 4 & 3), l = 2 * (order >> 6 & 3);
    return _mm256_permutevar8x32_epi32(a, _mm256_setr_epi32(i, i + 1, j, j + 1, k, k + 1, l, l + 1));
}

L1L2_INLINE int _mm256_testz_si256(L1L2Halves a, L1L2Halves b)
{
    const __m128i both = _mm_or_si128(_mm_and_si128(a.low, b.low), _mm_and_si128(a.high, b.high));
    return vmaxvq_u32(vreinterpretq_u32_s64(both)) == 0;
}

L1L2_INLINE int _mm256_movemask_epi8(L1L2Halves a)
{
    return (int)((uint32_t)_mm_movemask_epi8(a.low) | (uint32_t)_mm_movemask_epi8(a.high) << 16);
}

L1L2_INLINE int _mm256_movemask_ps(L1L2Halves a)
{
    return _mm_movemask_ps(_mm_castsi128_ps(a.low)) | _mm_movemask_ps(_mm_castsi128_ps(a.high)) << 4;
}

#endif

#endif
