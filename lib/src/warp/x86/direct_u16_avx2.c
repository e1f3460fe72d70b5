/* SPDX-License-Identifier: MIT */
/*
 * Samples of 9 to 16 bits for AVX2: eight sums at a time, in groups (avx2.h).
 *
 * A window is 16 bytes; with 2 or 4 components, every two taps have a window. A shuffle puts the two taps of each lane
 * side by side, pmaddwd weighs and adds them. Groups at an edge of the plane, too wide for their windows or in more
 * than two rows are left to plain C.
 */
#include "warp/direct_u16_impl.h"
#include "warp/x86/avx2.h"

/* What depends on the depth of a plane's samples. */
typedef struct Depth {
    __m128i bits, shift;     /* counts for shifts */
    __m128i rest;            /* 16 - bits */
    __m128i narrow_shift;
    __m256i round, max;
} Depth;

L1L2_INLINE Depth load_depth(const L1L2WarpPlane *src, const bool wide)
{
    const int round = wide ? L1L2_WARP_DIRECT_U16_ROUND : l1l2_warp_direct_u16_narrow_round(src->depth);
    return (Depth){
        .bits = _mm_cvtsi32_si128(src->depth),
        .shift = _mm_cvtsi32_si128(src->shift),
        .rest = _mm_cvtsi32_si128(16 - src->depth),
        .narrow_shift = _mm_cvtsi32_si128(l1l2_warp_direct_u16_narrow_shift(src->depth)),
        .round = _mm256_set1_epi32(round),
        .max = _mm256_set1_epi16((short)((1 << src->depth) - 1)),
    };
}

/* Addresses in the source for the two halves of a group. */
typedef struct Halves {
    const uint8_t *low, *high;
} Halves;

L1L2_INLINE Halves advance(Halves at, ptrdiff_t bytes)
{
    return (Halves){at.low + bytes, at.high + bytes};
}

L1L2_INLINE __m256i load_window(Halves at, const Depth *depth, const bool wide)
{
    const __m256i window = load_halves(at.low, at.high);
    return wide ? _mm256_xor_si256(window, _mm256_set1_epi16((short)L1L2_WARP_DIRECT_U16_BIAS))
                : _mm256_srl_epi16(window, depth->shift);
}

/* What the samples of a group are weighed with. */
typedef struct Weighing {
    __m256i first; /* the shuffle that brings a window's first two taps */
    Weights x, y;
} Weighing;

/* The weighted sum of one row's taps, before the cut. at: the first taps. */
L1L2_INLINE __m256i weigh_row(Halves at, const Weighing *by, const Depth *depth, const Shape shape)
{
    __m256i sum = _mm256_setzero_si256();
    for (int k = 0; k < shape.taps; k += 2) {
        /* With one component, a window has the taps 2 and 3 too. */
        const int from = shape.components == 1 ? k / 4 * 4 : k;
        const __m256i window = load_window(advance(at, from * 2 * shape.components), depth, shape.wide);
        const __m256i order = from == k ? by->first : _mm256_add_epi8(by->first, _mm256_set1_epi8(4));
        const __m256i two = _mm256_shuffle_epi8(window, order);
        sum = _mm256_add_epi32(sum, _mm256_madd_epi16(two, by->x.pair[k / 2]));
    }
    return sum;
}

/* The low words of a's lanes beside the high words of b's. */
L1L2_INLINE __m256i pair(__m256i a, __m256i b_high)
{
    return _mm256_blend_epi16(a, b_high, 0xAA);
}

/* The weighted sum of all taps, not yet limited to the depth. at: the first taps. */
L1L2_INLINE __m256i weigh(Halves at, ptrdiff_t stride, const Weighing *by, const Depth *depth, const Shape shape)
{
    __m256i sum = depth->round, lower = _mm256_setzero_si256();
    for (int r = 0; r < shape.taps; r += 2) {
        const __m256i a = weigh_row(advance(at, r * stride), by, depth, shape);
        const __m256i b = weigh_row(advance(at, (r + 1) * stride), by, depth, shape);
        if (!shape.wide) {
            const __m256i rows = pair(_mm256_srl_epi32(a, depth->bits), _mm256_sll_epi32(b, depth->rest));
            sum = _mm256_add_epi32(sum, _mm256_madd_epi16(rows, by->y.pair[r / 2]));
            continue;
        }
        enum { LOW = L1L2_WARP_DIRECT_U16_ROW_SHIFT, HIGH = LOW + L1L2_WARP_DIRECT_U16_PART_BITS };
        const __m256i upper_parts = pair(_mm256_srli_epi32(a, HIGH), _mm256_slli_epi32(b, 16 - HIGH));
        const __m256i lower_parts = _mm256_and_si256(pair(_mm256_srli_epi32(a, LOW), _mm256_slli_epi32(b, 16 - LOW)),
                                                     _mm256_set1_epi16((1 << L1L2_WARP_DIRECT_U16_PART_BITS) - 1));
        sum = _mm256_add_epi32(sum, _mm256_madd_epi16(upper_parts, by->y.pair[r / 2]));
        lower = _mm256_add_epi32(lower, _mm256_madd_epi16(lower_parts, by->y.pair[r / 2]));
    }
    if (!shape.wide)
        return _mm256_sra_epi32(sum, depth->narrow_shift);
    sum = _mm256_add_epi32(sum, _mm256_srai_epi32(lower, L1L2_WARP_DIRECT_U16_PART_BITS));
    return _mm256_add_epi32(_mm256_srai_epi32(sum, L1L2_WARP_DIRECT_U16_SHIFT),
                            _mm256_set1_epi32(L1L2_WARP_DIRECT_U16_BIAS));
}

L1L2_INLINE void store(uint8_t *dst, __m256i sums, const Depth *depth)
{
    const __m256i words = _mm256_min_epu16(_mm256_packus_epi32(sums, sums), depth->max);
    const __m256i placed = _mm256_sll_epi16(words, depth->shift);
    _mm_storeu_si128((void *)dst,
                     _mm_unpacklo_epi64(_mm256_castsi256_si128(placed), _mm256_extracti128_si256(placed, 1)));
}

/* For each lane the bytes of two neighboring taps in its half's window. offset: of the lane's sample in the window. */
L1L2_INLINE __m256i first_shuffle(__m256i offset, const int components)
{
    const int next = 2 * components; /* bytes from tap to tap */
    const __m256i component = components == 1 ? _mm256_setzero_si256()
                            : components == 2 ? _mm256_setr_epi32(0, 2, 0, 2, 0, 2, 0, 2)
                                              : _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    const __m256i two = _mm256_slli_epi32(offset, 1), four = _mm256_slli_epi32(offset, 2);
    const __m256i byte = _mm256_add_epi32(components == 1 ? two : four, component);
    const __m256i twice = _mm256_or_si256(byte, _mm256_slli_epi32(byte, 8));
    const __m256i four_times = _mm256_or_si256(twice, _mm256_slli_epi32(twice, 16));
    return _mm256_add_epi8(four_times, _mm256_set1_epi32(0x100 | next << 16 | (next + 1) << 24));
}

L1L2_INLINE Reach find_reach(const L1L2WarpPlane *src, const int taps, const int components)
{
    const int last_window = components == 1 ? taps / 6 * 4 : taps - 2; /* samples from the first tap */
    const int columns = src->width - (last_window + 8 / components) + 1, rows = src->height - taps + 1;
    return (Reach){columns > 0 ? (uint32_t)columns : 0, rows > 0 ? (uint32_t)rows : 0};
}

/* What all groups of a run share. */
typedef struct Source {
    const L1L2WarpPlane *plane;
    const L1L2WarpKernel *kernel;
    Reach reach;
    Depth depth;
} Source;

/* Renders a group. False: it does not fit, and nothing was written. */
L1L2_INLINE bool render_group(const Source *src, const int32_t *x, const int32_t *y, uint8_t *dst, const Shape shape)
{
    const int taps = shape.taps, components = shape.components;
    const Reach *reach = &src->reach;
    const ptrdiff_t stride = src->plane->stride;
    const int half = 4 / components; /* samples */
    const int longest = components == 1 ? (taps == 2 ? 6 : 4) : 4 - components;
    const int low_x = first_tap(x[0], taps), high_x = first_tap(x[half], taps);
    const int low_y = first_tap(y[0], taps), high_y = first_tap(y[half], taps);
    const __m256i zero = _mm256_setzero_si256();
    const __m256i columns = half > 1 ? from_first(x, components) : zero;
    const __m256i rows = half > 1 ? from_first(y, components) : zero;
    if ((uint32_t)low_x >= reach->columns || (uint32_t)high_x >= reach->columns || (uint32_t)low_y >= reach->rows ||
        (uint32_t)high_y >= reach->rows || !all_within(columns, longest))
        return false;

    const Weighing by = {first_shuffle(columns, components), load_weights(src->kernel, x, taps, components),
                         load_weights(src->kernel, y, taps, components)};
    const Halves at = {src->plane->data + low_y * stride + (ptrdiff_t)low_x * 2 * components,
                       src->plane->data + high_y * stride + (ptrdiff_t)high_x * 2 * components};
    __m256i sums = weigh(at, stride, &by, &src->depth, shape);
    if (half > 1 && !_mm256_testz_si256(rows, rows)) {
        /* Some lanes are one row further, all of them up or all down: weigh that row too, and let each lane choose. */
        const int step = _mm256_movemask_ps(_mm256_castsi256_ps(rows)) ? -1 : 1;
        const __m256i here = _mm256_cmpeq_epi32(rows, zero), there = _mm256_cmpeq_epi32(rows, _mm256_set1_epi32(step));
        if (_mm256_movemask_epi8(_mm256_or_si256(here, there)) != -1 || (uint32_t)(low_y + step) >= reach->rows ||
            (uint32_t)(high_y + step) >= reach->rows)
            return false;
        const __m256i further = weigh(advance(at, step * stride), stride, &by, &src->depth, shape);
        sums = _mm256_blendv_epi8(further, sums, here);
    }
    store(dst, sums, &src->depth);
    return true;
}

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                     int count, uint8_t *dst, const Shape shape)
{
    const int taps = shape.taps, components = shape.components;
    L1L2WarpDirectRun *const plain = l1l2_warp_direct_u16_plain.run[shape.wide][taps / 2 - 1][components / 2];
    const Source source = {src, kernel, find_reach(src, taps, components), load_depth(src, shape.wide)};
    const int group = 8 / components;
    int i = 0;
    for (; i + group <= count; i += group)
        if (!render_group(&source, x + i, y + i, dst + 2 * components * i, shape))
            plain(src, kernel, x + i, y + i, group, dst + 2 * components * i);
    plain(src, kernel, x + i, y + i, count - i, dst + 2 * components * i);
}

DEFINE_RUNS(static, runs)

void l1l2_warp_direct_u16_init_avx2(L1L2WarpFunctions *functions)
{
    functions->direct_u16 = runs;
}
