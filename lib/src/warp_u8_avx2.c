/* SPDX-License-Identifier: MIT */
/*
 * The sample type of 8 bits for AVX2: eight sums at a time, the same bytes as plain C.
 *
 * A group is eight lanes of 32 bits: 8, 4 or 2 output samples of 1, 2 or 3..4 components. Each half of it, four lanes,
 * has its taps of one row within 16 bytes of the source, its window. A shuffle puts two taps of each lane side by side,
 * pmaddwd weighs them. What does not fit (an edge, a window too short, rows too steep) is left to plain C.
 */
#include <immintrin.h>
#include <stdbool.h>
#include <string.h>

#include "warp_u8_impl.h"

enum { WINDOW = 16 }; /* bytes */

/* The weights of two taps in the 16-bit halves of each lane, for taps 0 and 1, 2 and 3, 4 and 5. */
typedef struct Weights {
    __m256i pair[L1L2_WARP_MAX_TAPS / 2];
} Weights;

SPECIALIZED __m256i join(__m128i low, __m128i high)
{
    return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

SPECIALIZED __m256i load_halves(const void *low, const void *high)
{
    return join(_mm_loadu_si128(low), _mm_loadu_si128(high));
}

/* One value a sample -> one a lane. */
SPECIALIZED __m256i spread(const int32_t *at, const int components)
{
    if (components == 1)
        return _mm256_loadu_si256((const void *)at);
    const __m256i lanes = components == 2 ? _mm256_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3)
                                          : _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
    const __m128i values = components == 2 ? _mm_loadu_si128((const void *)at) : _mm_loadl_epi64((const void *)at);
    return _mm256_permutevar8x32_epi32(_mm256_castsi128_si256(values), lanes);
}

/* Linear weights need no table: phase 0..1023 -> ONE - 16 phase, 16 phase. */
SPECIALIZED Weights weights_2(const int32_t *at, const int components)
{
    const __m256i phase = _mm256_and_si256(spread(at, components), _mm256_set1_epi32(L1L2_WARP_PHASES - 1));
    const __m256i second = _mm256_slli_epi32(phase, L1L2_WARP_WEIGHT_BITS - L1L2_WARP_PHASE_BITS);
    const __m256i first = _mm256_sub_epi32(_mm256_set1_epi32(L1L2_WARP_ONE), second);
    return (Weights){{_mm256_or_si256(first, _mm256_slli_epi32(second, 16))}};
}

/* at[]: of the group's samples. */
SPECIALIZED Weights weights_4(const L1L2WarpKernel *kernel, const int32_t *at, const int components)
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

SPECIALIZED Weights weights_6(const L1L2WarpKernel *kernel, const int32_t *at, const int components)
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

SPECIALIZED Weights load_weights(const L1L2WarpKernel *kernel, const int32_t *at, const int taps, const int components)
{
    return taps == 2 ? weights_2(at, components)
         : taps == 4 ? weights_4(kernel, at, components) : weights_6(kernel, at, components);
}

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

typedef struct Reach {
    uint32_t columns, rows; /* a first tap below these has its window and rows in the plane */
} Reach;

SPECIALIZED Reach find_reach(const L1L2WarpPlane *src, const int taps, const int components)
{
    const int window = (WINDOW + (taps == 6 ? 4 * components : 0) + components - 1) / components;
    const int columns = src->width - window + 1, rows = src->height - taps + 1;
    return (Reach){columns > 0 ? (uint32_t)columns : 0, rows > 0 ? (uint32_t)rows : 0};
}

SPECIALIZED int first_tap(int32_t at, const int taps)
{
    return (at >> L1L2_WARP_PHASE_BITS) - (taps / 2 - 1);
}

/* For each lane: samples from its half's first one, by axis. */
SPECIALIZED __m256i from_first(const int32_t *at, const int components)
{
    const __m256i whole = _mm256_srai_epi32(spread(at, components), L1L2_WARP_PHASE_BITS);
    return _mm256_sub_epi32(whole, _mm256_shuffle_epi32(whole, 0x00));
}

SPECIALIZED bool all_within(__m256i offset, int limit)
{
    const __m256i limits = _mm256_set1_epi32(limit);
    return _mm256_movemask_epi8(_mm256_cmpeq_epi32(_mm256_max_epu32(offset, limits), limits)) == -1;
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
    const Reach reach = find_reach(src, taps, components);
    const int group = components == 1 ? 8 : components == 2 ? 4 : 2;
    int i = 0;
    for (; i + group <= count; i += group)
        if (!render_group(src, kernel, &reach, x + i, y + i, dst + i * components, taps, components))
            plain(src, kernel, x + i, y + i, group, dst + i * components);
    plain(src, kernel, x + i, y + i, count - i, dst + i * components);
}

DEFINE_RUNS(l1l2_warp_u8_run_avx2)
