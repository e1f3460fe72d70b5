/* SPDX-License-Identifier: MIT */
/*
 * The bilinear sample type of 8 bits for AVX2: sixteen words at a time, the same bytes as plain C.
 *
 * A group is sixteen lanes of 16 bits: 16, 8 or 4 output samples of 1, 2 or 3..4 components. Each half of it has both
 * taps of a row within 16 bytes of the source. Samples may lie on two pairs of rows: three rows are weighed.
 */
#ifndef L1L2_WARP_U8_LINEAR_AVX2_H
#define L1L2_WARP_U8_LINEAR_AVX2_H

#include <string.h>

#include "warp_avx2.h"
#include "warp_u8.h"

#ifdef __AVX2__ /* so that it compiles alone, on every machine */

/* One value a sample, 32 bits each, by halves of the group. One component: the halves' first four in a, the others in
 * b; two: in a; more: in a, 64 bits each. Unused ones are 0. */
typedef struct Values {
    __m256i a, b;
} Values;

SPECIALIZED Values load_values(const int32_t *at, const int components)
{
    if (components == 1)
        return (Values){load_halves(at, at + 8), load_halves(at + 4, at + 12)};
    if (components == 2)
        return (Values){_mm256_loadu_si256((const void *)at), _mm256_setzero_si256()};
    return (Values){_mm256_cvtepu32_epi64(_mm_loadu_si128((const void *)at)), _mm256_setzero_si256()};
}

/* To one word a lane; values of 0 .. 32767, or masks of all bits. */
SPECIALIZED __m256i spread_words(Values v, const int components)
{
    if (components == 1)
        return _mm256_packs_epi32(v.a, v.b);
    if (components == 2)
        return _mm256_blend_epi16(v.a, _mm256_slli_epi32(v.a, 16), 0xAA);
    return _mm256_shuffle_epi8(v.a, _mm256_broadcastsi128_si256(
        _mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 8, 9, 8, 9, 8, 9, 8, 9)));
}

/* Whole samples from each half's first one. */
SPECIALIZED Values offsets(Values at, const int components)
{
    const __m256i whole_a = _mm256_srai_epi32(at.a, L1L2_WARP_PHASE_BITS);
    if (components > 2)
        return (Values){_mm256_sub_epi32(whole_a, _mm256_shuffle_epi32(whole_a, _MM_SHUFFLE(1, 0, 1, 0))), at.b};
    const __m256i first = _mm256_shuffle_epi32(whole_a, 0x00);
    const __m256i a = _mm256_sub_epi32(whole_a, first);
    if (components == 2)
        return (Values){a, at.b};
    return (Values){a, _mm256_sub_epi32(_mm256_srai_epi32(at.b, L1L2_WARP_PHASE_BITS), first)};
}

/* Phases as pmulhrsw wants them: 1 is 32768. */
SPECIALIZED __m256i phase_words(Values at, const int components)
{
    const __m256i mask = _mm256_set1_epi32(L1L2_WARP_PHASES - 1);
    const Values phase = {_mm256_and_si256(at.a, mask), _mm256_and_si256(at.b, mask)};
    return _mm256_slli_epi16(spread_words(phase, components), 15 - L1L2_WARP_PHASE_BITS);
}

/* The bytes of the left taps in each half's window, as words. */
SPECIALIZED __m256i left_taps(Values columns, const int components)
{
    const __m256i offset = spread_words(columns, components);
    const __m256i zeros = _mm256_set1_epi16((short)0x8000); /* for the words' upper bytes */
    if (components == 1)
        return _mm256_or_si256(offset, zeros);
    if (components == 2)
        return _mm256_or_si256(_mm256_add_epi16(_mm256_slli_epi16(offset, 1), _mm256_set1_epi32(0x10000)), zeros);
    const __m256i component = _mm256_set1_epi64x(0x0003000200010000);
    const __m256i byte = components == 3 ? _mm256_add_epi16(_mm256_slli_epi16(offset, 1), offset)
                                         : _mm256_slli_epi16(offset, 2);
    return _mm256_or_si256(_mm256_add_epi16(byte, component), zeros);
}

SPECIALIZED __m256i lerp(__m256i a, __m256i b, __m256i share)
{
    return _mm256_add_epi16(a, _mm256_mulhrs_epi16(_mm256_sub_epi16(b, a), share));
}

SPECIALIZED __m256i lerp_row(const uint8_t *low, const uint8_t *high, __m256i left, __m256i right, __m256i share)
{
    const __m256i window = load_halves(low, high);
    return lerp(_mm256_slli_epi16(_mm256_shuffle_epi8(window, left), L1L2_WARP_U8_LINEAR_BITS),
                _mm256_slli_epi16(_mm256_shuffle_epi8(window, right), L1L2_WARP_U8_LINEAR_BITS), share);
}

SPECIALIZED void store_words(uint8_t *dst, __m256i words, const int components)
{
    const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packus_epi16(words, words), _MM_SHUFFLE(3, 1, 2, 0));
    const __m128i group = _mm256_castsi256_si128(bytes);
    if (components == 3) {
        const __m128i twelve = _mm_shuffle_epi8(group, _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14,
                                                                     -1, -1, -1, -1));
        const uint32_t last = (uint32_t)_mm_extract_epi32(twelve, 2);
        _mm_storel_epi64((void *)dst, twelve);
        memcpy(dst + 8, &last, 4);
    } else {
        _mm_storeu_si128((void *)dst, group);
    }
}

/* False: the group must be done otherwise. Always three rows, for a branch on whether two would do is often wrong. */
SPECIALIZED bool render_linear(const L1L2WarpPlane *src, const Reach *reach, const int32_t *x, const int32_t *y,
                               uint8_t *dst, const int components)
{
    const int half = components == 1 ? 8 : components == 2 ? 4 : 2; /* samples */
    const int longest = (16 - 2 * components) / components;
    const Values at_x = load_values(x, components), at_y = load_values(y, components);
    const Values columns = offsets(at_x, components), rows = offsets(at_y, components);
    /* All other rows are one below the half's first, or all are one above: the uppermost then is that one. */
    const int above = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_or_si256(rows.a, rows.b))) != 0;
    const Values down = {_mm256_add_epi32(rows.a, _mm256_set1_epi32(above)),
                         _mm256_add_epi32(rows.b, _mm256_set1_epi32(above))};
    const int low_x = first_tap(x[0], 2), high_x = first_tap(x[half], 2);
    const int low_y = first_tap(y[0], 2) - above, high_y = first_tap(y[half], 2) - above;
    if ((uint32_t)low_x >= reach->columns || (uint32_t)high_x >= reach->columns || (uint32_t)low_y >= reach->rows ||
        (uint32_t)high_y >= reach->rows || !all_within(_mm256_max_epu32(columns.a, columns.b), longest) ||
        !all_within(_mm256_max_epu32(down.a, down.b), 1))
        return false;

    const __m256i left = left_taps(columns, components);
    const __m256i right = _mm256_add_epi16(left, _mm256_set1_epi16((short)components));
    const __m256i share_x = phase_words(at_x, components), share_y = phase_words(at_y, components);
    const uint8_t *low = src->data + low_y * src->stride + (ptrdiff_t)low_x * components;
    const uint8_t *high = src->data + high_y * src->stride + (ptrdiff_t)high_x * components;
    const __m256i first = lerp_row(low, high, left, right, share_x);
    const __m256i second = lerp_row(low + src->stride, high + src->stride, left, right, share_x);
    const __m256i third = lerp_row(low + 2 * src->stride, high + 2 * src->stride, left, right, share_x);
    const __m256i one = _mm256_set1_epi32(1);
    const Values is_down = {_mm256_cmpeq_epi32(down.a, one), _mm256_cmpeq_epi32(down.b, one)};
    const __m256i mask = spread_words(is_down, components);
    const __m256i rounded = _mm256_add_epi16(lerp(_mm256_blendv_epi8(first, second, mask),
                                                  _mm256_blendv_epi8(second, third, mask), share_y),
                                             _mm256_set1_epi16(L1L2_WARP_U8_LINEAR_ROUND));
    store_words(dst, _mm256_srli_epi16(rounded, L1L2_WARP_U8_LINEAR_BITS), components);
    return true;
}

#endif

#endif
