/* SPDX-License-Identifier: MIT */
/*
 * The sample type of 8 bits for AVX2: eight sums at a time, the same bytes as plain C.
 *
 * A group is eight lanes of 32 bits: 8, 4 or 2 output samples of 1, 2 or 3..4 components. Each half of it, four lanes,
 * has its taps of one row within 16 bytes of the source, its window. A shuffle puts two taps of each lane side by side,
 * pmaddwd weighs them. What does not fit (an edge, a window too short, rows too steep) is left to plain C.
 */
#include <string.h>

#include "warp_avx2.h"
#include "warp_u8_impl.h"
#include "warp_u8_linear_avx2.h"

enum { WINDOW = 16 }; /* bytes */

/* The weighted sum of one row's taps, before the cut. first: shuffle that brings taps 0 and 1. */
SPECIALIZED __m256i weigh_row(const uint8_t *low, const uint8_t *high, __m256i first, const Weights *wx, const int taps,
                              const int components)
{
    const __m256i window = load_halves(low, high);
    __m256i sum = _mm256_madd_epi16(_mm256_shuffle_epi8(window, first), wx->pair[0]);
    if (taps >= 4) {
        const __m256i second = _mm256_add_epi8(first, _mm256_set1_epi16((short)(2 * components)));
        sum = _mm256_add_epi32(sum, _mm256_madd_epi16(_mm256_shuffle_epi8(window, second), wx->pair[1]));
    }
    if (taps >= 6) {
        const __m256i beyond = load_halves(low + 4 * components, high + 4 * components);
        sum = _mm256_add_epi32(sum, _mm256_madd_epi16(_mm256_shuffle_epi8(beyond, first), wx->pair[2]));
    }
    return sum;
}

/* low, high: the first tap's row of each half. */
SPECIALIZED __m256i weigh(const uint8_t *low, const uint8_t *high, ptrdiff_t stride, __m256i first, const Weights *wx,
                          const Weights *wy, const int taps, const int components)
{
    __m256i sum = _mm256_set1_epi32(L1L2_WARP_U8_ROUND);
    for (int r = 0; r < taps; r += 2) {
        const __m256i a = weigh_row(low + r * stride, high + r * stride, first, wx, taps, components);
        const __m256i b = weigh_row(low + (r + 1) * stride, high + (r + 1) * stride, first, wx, taps, components);
        /* Both cut to 16 bits, side by side. */
        const __m256i rows = _mm256_blend_epi16(_mm256_srli_epi32(a, L1L2_WARP_U8_ROW_SHIFT),
                                                _mm256_slli_epi32(b, 16 - L1L2_WARP_U8_ROW_SHIFT), 0xAA);
        sum = _mm256_add_epi32(sum, _mm256_madd_epi16(rows, wy->pair[r / 2]));
    }
    return _mm256_srai_epi32(sum, L1L2_WARP_U8_SHIFT);
}

SPECIALIZED void store(uint8_t *dst, __m256i sums, const int components)
{
    const __m256i words = _mm256_packs_epi32(sums, sums);
    const __m256i bytes = _mm256_packus_epi16(words, words);
    const __m128i group = _mm_unpacklo_epi32(_mm256_castsi256_si128(bytes), _mm256_extracti128_si256(bytes, 1));
    if (components == 3) {
        const __m128i order = _mm_setr_epi8(0, 1, 2, 4, 5, 6, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1);
        const __m128i six = _mm_shuffle_epi8(group, order);
        const uint32_t four = (uint32_t)_mm_cvtsi128_si32(six);
        const uint16_t two = (uint16_t)_mm_extract_epi16(six, 2);
        memcpy(dst, &four, 4);
        memcpy(dst + 4, &two, 2);
    } else {
        _mm_storel_epi64((void *)dst, group);
    }
}

/* For each lane the bytes of taps 0 and 1 in the half's window, as words. offset: of the lane's sample, samples. */
SPECIALIZED __m256i first_shuffle(__m256i offset, const int components)
{
    const int c = components; /* from tap to tap */
    const __m256i component = c == 1 ? _mm256_setzero_si256()
                            : c == 2 ? _mm256_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1)
                                     : _mm256_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3);
    const __m256i byte = _mm256_add_epi32(c == 2 ? _mm256_slli_epi32(offset, 1) : offset, component);
    const __m256i twice = _mm256_or_si256(byte, _mm256_slli_epi32(byte, 16));
    return _mm256_add_epi8(twice, _mm256_set1_epi32((int)(0x80008000u | (uint32_t)c << 16)));
}

SPECIALIZED Reach find_reach(const L1L2WarpPlane *src, const int taps, const int components)
{
    const int window = (WINDOW + (taps == 6 ? 4 * components : 0) + components - 1) / components;
    const int columns = src->width - window + 1, rows = src->height - taps + 1;
    return (Reach){columns > 0 ? (uint32_t)columns : 0, rows > 0 ? (uint32_t)rows : 0};
}

/* False: the group must be done otherwise. */
SPECIALIZED bool render_group(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const Reach *reach,
                              const int32_t *x, const int32_t *y, uint8_t *dst, const int taps, const int components)
{
    const int half = components == 1 ? 4 : components == 2 ? 2 : 1; /* samples */
    const int longest = (WINDOW - components * (taps == 2 ? 2 : 4)) / components;
    const int low_x = first_tap(x[0], taps), high_x = first_tap(x[half], taps);
    const int low_y = first_tap(y[0], taps), high_y = first_tap(y[half], taps);
    const __m256i zero = _mm256_setzero_si256();
    const __m256i columns = half > 1 ? from_first(x, components) : zero;
    const __m256i rows = half > 1 ? from_first(y, components) : zero;
    if ((uint32_t)low_x >= reach->columns || (uint32_t)high_x >= reach->columns || (uint32_t)low_y >= reach->rows ||
        (uint32_t)high_y >= reach->rows || !all_within(columns, longest))
        return false;

    const Weights wx = load_weights(kernel, x, taps, components), wy = load_weights(kernel, y, taps, components);
    const __m256i first = first_shuffle(columns, components);
    const uint8_t *low = src->data + low_y * src->stride + (ptrdiff_t)low_x * components;
    const uint8_t *high = src->data + high_y * src->stride + (ptrdiff_t)high_x * components;
    __m256i sums = weigh(low, high, src->stride, first, &wx, &wy, taps, components);
    if (half > 1 && !_mm256_testz_si256(rows, rows)) {
        /* Some lanes are a row further, all of them up or all down: weigh that row too, and let each lane choose. */
        const int step = _mm256_movemask_ps(_mm256_castsi256_ps(rows)) ? -1 : 1;
        const __m256i here = _mm256_cmpeq_epi32(rows, zero), there = _mm256_cmpeq_epi32(rows, _mm256_set1_epi32(step));
        if (_mm256_movemask_epi8(_mm256_or_si256(here, there)) != -1 || (uint32_t)(low_y + step) >= reach->rows ||
            (uint32_t)(high_y + step) >= reach->rows)
            return false;
        const __m256i further = weigh(low + step * src->stride, high + step * src->stride, src->stride, first, &wx, &wy,
                                      taps, components);
        sums = _mm256_blendv_epi8(further, sums, here);
    }
    store(dst, sums, components);
    return true;
}

SPECIALIZED void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                     int count, uint8_t *dst, const int taps, const int components)
{
    L1L2WarpRun *const plain = l1l2_warp_u8_run_plain(taps, components);
    Reach reach = find_reach(src, taps, components);
    if (taps == 2 && reach.rows > 0)
        reach.rows--; /* three rows */
    const int lanes = taps == 2 ? 16 : 8, group = components == 1 ? lanes : components == 2 ? lanes / 2 : lanes / 4;
    int i = 0;
    for (; i + group <= count; i += group)
        if (!(taps == 2 ? render_linear(src, &reach, x + i, y + i, dst + i * components, components)
                        : render_group(src, kernel, &reach, x + i, y + i, dst + i * components, taps, components)))
            plain(src, kernel, x + i, y + i, group, dst + i * components);
    plain(src, kernel, x + i, y + i, count - i, dst + i * components);
}

DEFINE_RUNS(l1l2_warp_u8_run_avx2)
