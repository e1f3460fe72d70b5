/* SPDX-License-Identifier: MIT */
/*
 * Bilinear scanlines for AVX2: groups of sixteen lanes of 16 bits (lanes_avx2.h).
 *
 * Each half of a group has the taps of a row within 16 bytes of the source, its window. A shuffle puts the two taps of
 * a lane side by side.
 */
#include <stdlib.h>

#include "warp/bilinear_u8_impl.h"
#include "warp/x86/lanes_avx2.h"

/* The taps of a group. */
typedef struct Taps {
    const uint8_t *low, *high; /* the two halves' windows in the uppermost row */
    ptrdiff_t stride;
    __m256i pairs;             /* the shuffle that brings each lane's two taps of a row */
    __m256i share_x, share_y;  /* weights of the right and of the lower tap, 15 fractional bits */
    __m256i y;                 /* position from the uppermost row, in phases */
} Taps;

L1L2_INLINE __m256i lerp(__m256i a, __m256i b, __m256i share)
{
    return _mm256_add_epi16(a, _mm256_mulhrs_epi16(_mm256_sub_epi16(b, a), share));
}

L1L2_INLINE __m256i load_row(const Taps *taps, int row)
{
    return _mm256_shuffle_epi8(load_halves(taps->low + row * taps->stride, taps->high + row * taps->stride),
                               taps->pairs);
}

/* pairs: left taps in the lower bytes of each word, right ones in the upper bytes. */
L1L2_INLINE __m256i lerp_row(const Taps *taps, __m256i pairs)
{
    const __m256i left = _mm256_slli_epi16(_mm256_and_si256(pairs, words(255)), L1L2_WARP_BILINEAR_BITS);
    const __m256i right = _mm256_and_si256(_mm256_srli_epi16(pairs, 8 - L1L2_WARP_BILINEAR_BITS),
                                           words(255 << L1L2_WARP_BILINEAR_BITS));
    return lerp(left, right, taps->share_x);
}

/* The group lies in at most two rows. There is no branch: where a scanline crosses a row changes from row to row, and
 * would be predicted badly. */
L1L2_INLINE __m256i weigh_crossing(const Taps *taps)
{
    const __m256i down = _mm256_srai_epi16(_mm256_slli_epi16(taps->y, 15 - L1L2_WARP_PHASE_BITS), 15);
    const __m256i first = load_row(taps, 0), second = load_row(taps, 1), third = load_row(taps, 2);
    return lerp(lerp_row(taps, _mm256_blendv_epi8(first, second, down)),
                lerp_row(taps, _mm256_blendv_epi8(second, third, down)), taps->share_y);
}

/* The group lies in the uppermost row and in up to `more` further ones. */
L1L2_INLINE __m256i weigh_steep(const Taps *taps, int more)
{
    const __m256i further = _mm256_srli_epi16(taps->y, L1L2_WARP_PHASE_BITS);
    __m256i sum = _mm256_setzero_si256(), upper = lerp_row(taps, load_row(taps, 0));
    for (int row = 0; row <= more; row++) {
        const __m256i lower = lerp_row(taps, load_row(taps, row + 1));
        sum = _mm256_blendv_epi8(sum, lerp(upper, lower, taps->share_y), _mm256_cmpeq_epi16(further, words(row)));
        upper = lower;
    }
    return sum;
}

/* along, down: the group's steps, counted from the plane's corner. row: the uppermost row. */
L1L2_INLINE Taps find_taps(const L1L2WarpPlane *src, const Steps *along, const Steps *down, int64_t row,
                           const int components)
{
    const __m256i mask = words(0x7FFF);
    const int64_t column = along->at >> L1L2_WARP_STEP_BITS;
    const int64_t half = (along->at + (int64_t)(group_of(components) / 2) * along->step) >> L1L2_WARP_STEP_BITS;
    const __m256i x = positions_from(along, (int32_t)(along->at & ((1 << L1L2_WARP_STEP_BITS) - 1)), components, false);
    const __m256i y = positions_from(down, (int32_t)(down->at - (row << L1L2_WARP_STEP_BITS)), components, false);
    const __m256i columns = _mm256_srli_epi16(x, L1L2_WARP_PHASE_BITS);
    const __m256i offset = _mm256_sub_epi16(columns, _mm256_shuffle_epi8(columns, words(0x0100)));
    const __m256i component = components == 1 ? words(0) : components == 2 ? _mm256_set1_epi32(0x01010000)
                                                         : _mm256_set1_epi64x(0x0303020201010000);
    const uint8_t *first = src->data + row * src->stride;
    return (Taps){
        .low = first + column * components,
        .high = first + half * components,
        .stride = src->stride,
        .pairs = _mm256_add_epi16(_mm256_mullo_epi16(offset, words(components * 0x0101)),
                                  _mm256_add_epi16(component, words(components << 8))),
        .share_x = _mm256_and_si256(_mm256_slli_epi16(x, 15 - L1L2_WARP_PHASE_BITS), mask),
        .share_y = _mm256_and_si256(_mm256_slli_epi16(y, 15 - L1L2_WARP_PHASE_BITS), mask),
        .y = y,
    };
}

/* Renders whole groups. All of their taps are in the plane. */
L1L2_INLINE void render_groups(const L1L2WarpPlane *src, const Samples *samples, uint8_t *dst, const int components,
                               const bool steep)
{
    const L1L2WarpScanline *scanline = samples->scanline;
    const int group = group_of(components), k = samples->k, from = samples->from, to = samples->to;
    Steps along = steps_of(&scanline->along[k], components), down = steps_of(&scanline->down[k], components);
    const int64_t across = (int64_t)(group - 1) * down.step, to_low = down.step < 0 ? across : 0;
    along.at += (int64_t)(from - scanline->along[k].from) * along.step;
    along.at += scanline->first * ((int64_t)1 << L1L2_WARP_STEP_BITS);
    down.at += (int64_t)(from - scanline->down[k].from) * down.step;
    for (int i = from; i < to; i += group) {
        const int64_t row = (down.at + to_low) >> L1L2_WARP_STEP_BITS;
        const Taps taps = find_taps(src, &along, &down, row, components);
        const __m256i lanes = steep ? weigh_steep(&taps, (int)((llabs(across) >> L1L2_WARP_STEP_BITS) + 1))
                                    : weigh_crossing(&taps);
        store(dst + i * components,
              _mm256_srli_epi16(_mm256_add_epi16(lanes, words(L1L2_WARP_BILINEAR_ROUND)), L1L2_WARP_BILINEAR_BITS),
              components);
        along.at += (int64_t)group * along.step;
        down.at += (int64_t)group * down.step;
    }
}

L1L2_INLINE int column_of(const L1L2WarpScanline *scanline, int k, int i)
{
    return (l1l2_warp_piece_position(&scanline->along[k], i) >> L1L2_WARP_PHASE_BITS) + scanline->first;
}

L1L2_INLINE int row_of(const L1L2WarpScanline *scanline, int k, int i)
{
    return l1l2_warp_piece_position(&scanline->down[k], i) >> L1L2_WARP_PHASE_BITS;
}

/* Renders the k-th pieces: groups where all taps are in the plane, plain C before and after them. A group may write
 * beyond the pieces' end; the next piece then overwrites that. */
L1L2_INLINE void render_piece(const L1L2WarpPlane *src, const L1L2WarpScanline *scanline, int k, uint8_t *dst,
                              const int components)
{
    const int group = group_of(components), begin = scanline->along[k].from, end = end_of_samples(scanline, k);
    int from = begin, to = begin + (end - begin + group - 1) / group * group;
    if (to > scanline->count)
        to -= group;
    const int row = row_of(scanline, k, from), last = row_of(scanline, k, to + group), low = row < last ? row : last;
    const int spare = src->height - 3 - (row < last ? last : row);
    const bool steep = abs(scanline->down[k].step) > (1 << L1L2_WARP_STEP_BITS) / group;
    if (low < 0 || spare < (steep ? 1 : 0))
        to = from;
    while (from < to && column_of(scanline, k, from) < 0)
        from += group;
    while (from < to && (column_of(scanline, k, to) - src->width) * components + LANES > 0)
        to -= group;
    const Samples before = {scanline, k, begin, from < end ? from : end}, groups = {scanline, k, from, to};
    const Samples after = {scanline, k, to > from ? to : from, end};
    bilinear_plain(src, &before, dst, components);
    if (steep)
        render_groups(src, &groups, dst, components, true);
    else
        render_groups(src, &groups, dst, components, false);
    bilinear_plain(src, &after, dst, components);
}

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpScanline *scanline, uint8_t *dst, const int components)
{
    for (int k = 0; k < scanline->along_pieces; k++)
        render_piece(src, scanline, k, dst, components);
}

DEFINE_BILINEAR_RUNS(l1l2_warp_bilinear_u8_init_avx2)
