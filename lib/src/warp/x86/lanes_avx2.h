/* SPDX-License-Identifier: MIT */
/*
 * What the scanline sample types share for AVX2: a group is sixteen lanes of 16 bits.
 *
 * Along a scanline, a lane is a component of a sample: a group has 16, 8 or 4 samples of 1, 2 or 3..4 components, where
 * three components take four lanes. Down the columns, a lane is a component of a column, in the order of memory: a
 * group of three components has four whole columns, and four lanes that are not used.
 */
#ifndef L1L2_WARP_X86_LANES_AVX2_H
#define L1L2_WARP_X86_LANES_AVX2_H

#include <stdbool.h>
#include <string.h>

#include "warp/scanline_u8.h"
#include "warp/x86/avx2.h"

#if L1L2_AVX2 /* so that it can be compiled alone on every machine */

enum { LANES = 16 };

L1L2_INLINE int group_of(const int components)
{
    return components == 1 ? 16 : components == 2 ? 8 : 4; /* columns or samples of a group */
}

L1L2_INLINE __m256i words(int value)
{
    return _mm256_set1_epi16((short)value);
}

/* Repeats words 0..7 of v, one for each column or sample, for all of its components: three components take three lanes
 * down and four along. */
L1L2_INLINE __m256i spread_words(__m128i v, const int components, const bool down)
{
    const __m256i twice = _mm256_setr_epi8(0, 1, 0, 1, 2, 3, 2, 3, 4, 5, 4, 5, 6, 7, 6, 7,
                                           8, 9, 8, 9, 10, 11, 10, 11, 12, 13, 12, 13, 14, 15, 14, 15);
    const __m256i close = _mm256_setr_epi8(0, 1, 0, 1, 0, 1, 2, 3, 2, 3, 2, 3, 4, 5, 4, 5,
                                           4, 5, 6, 7, 6, 7, 6, 7, 6, 7, 6, 7, 6, 7, 6, 7);
    const __m256i four_times = _mm256_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 2, 3, 2, 3, 2, 3, 2, 3,
                                                4, 5, 4, 5, 4, 5, 4, 5, 6, 7, 6, 7, 6, 7, 6, 7);
    return _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(v),
                               components == 2 ? twice : components == 3 && down ? close : four_times);
}

/* The values of a group's columns or samples, 32 bits each, to lanes. The first eight are in a; sixteen are in a, b, a,
 * b by fours, which is the order that packing needs. */
L1L2_INLINE __m256i to_lanes(__m256i a, __m256i b, const int components, const bool down)
{
    if (components == 1)
        return _mm256_packs_epi32(a, b);
    return spread_words(_mm_packs_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1)), components, down);
}

/* The evenly spaced positions of a group. */
typedef struct Steps {
    int64_t at;   /* the group's first position */
    int32_t step;
    __m256i a, b; /* distances from there to its columns or samples, in the order of to_lanes() */
} Steps;

L1L2_INLINE Steps steps_of(const L1L2WarpPiece *piece, const int components)
{
    const __m256i each = _mm256_set1_epi32(piece->step), eight = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    const __m256i even = _mm256_setr_epi32(0, 1, 2, 3, 8, 9, 10, 11);
    const __m256i odd = _mm256_setr_epi32(4, 5, 6, 7, 12, 13, 14, 15);
    return (Steps){piece->at, piece->step, _mm256_mullo_epi32(each, components == 1 ? even : eight),
                   _mm256_mullo_epi32(each, odd)};
}

/* A group's positions in phases. first: its first position, counted from where none of the group's is negative. */
L1L2_INLINE __m256i positions_from(const Steps *steps, int32_t first, const int components, const bool down)
{
    enum { CUT = L1L2_WARP_STEP_BITS - L1L2_WARP_PHASE_BITS };
    const __m256i from = _mm256_set1_epi32(first);
    return to_lanes(_mm256_srli_epi32(_mm256_add_epi32(from, steps->a), CUT),
                    _mm256_srli_epi32(_mm256_add_epi32(from, steps->b), CUT), components, down);
}

/* Writes the samples of a group, one word a lane. */
L1L2_INLINE void store(uint8_t *dst, __m256i lanes, const int components)
{
    const __m128i group = _mm_packus_epi16(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
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

#endif

#endif
