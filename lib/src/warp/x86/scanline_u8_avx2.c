/* SPDX-License-Identifier: MIT */
/*
 * Scanlines for AVX2: groups of sixteen lanes of 16 bits (lanes_avx2.h).
 *
 * Down, a lane is a component of a column, and rows are added up one by one. Along, a group has four quarters of four
 * lanes. Two neighboring taps of a quarter's lanes lie within eight values of the scanline, its window: a shuffle puts
 * them side by side, pmaddwd weighs and adds them.
 */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "warp/scanline_u8_impl.h"
#include "warp/x86/lanes_avx2.h"

typedef struct TapWeights {
    __m256i tap[L1L2_WARP_MAX_TAPS];
} TapWeights;

/* The weights of sixteen phases: set_cubic() of kernel.c, operation by operation. */
L1L2_INLINE TapWeights weigh_cubic(__m256i phase)
{
    const __m256i t = _mm256_slli_epi16(phase, 15 - L1L2_WARP_PHASE_BITS);
    /* Where t is 0, n = 2^15 wraps to -2^15: then all products are 0 in either case. */
    const __m256i n = _mm256_sub_epi16(words(-32768), t);
    const __m256i q = _mm256_mulhrs_epi16(t, n);
    const __m256i qt = _mm256_mulhrs_epi16(q, t), qn = _mm256_mulhrs_epi16(q, n);
    const __m256i quarter = _mm256_mulhrs_epi16(q, words(4096));
    const __m256i before = _mm256_mulhrs_epi16(qn, words(-12288)), after = _mm256_mulhrs_epi16(qt, words(-12288));
    const __m256i left = _mm256_add_epi16(_mm256_sub_epi16(_mm256_srli_epi16(n, 1), quarter),
                                          _mm256_mulhrs_epi16(qn, words(20480)));
    const __m256i right = _mm256_add_epi16(_mm256_sub_epi16(_mm256_srli_epi16(t, 1), quarter),
                                           _mm256_mulhrs_epi16(qt, words(20480)));
    const __m256i rest = _mm256_sub_epi16(words(L1L2_WARP_ONE),
                                          _mm256_add_epi16(_mm256_add_epi16(before, after),
                                                           _mm256_add_epi16(left, right)));
    const __m256i is_right = _mm256_cmpgt_epi16(t, words(1 << 14));
    return (TapWeights){{before, _mm256_add_epi16(left, _mm256_andnot_si256(is_right, rest)),
                      _mm256_add_epi16(right, _mm256_and_si256(is_right, rest)), after}};
}

/* The weights of sixteen phases from the table: its rows are transposed to one vector for each of the six taps. The
 * phases are computed once more by scalar code, which is faster than taking them out of a vector. */
L1L2_INLINE TapWeights weigh_lanczos(const L1L2WarpKernel *kernel, const Steps *steps, const int components,
                                  const bool down)
{
    enum { CUT = L1L2_WARP_STEP_BITS - L1L2_WARP_PHASE_BITS };
    __m256i row[8];
    for (int i = 0; i < 8; i++) {
        const int lanes = components == 3 && !down ? 4 : components; /* of a sample */
        const int64_t low = steps->at + (int64_t)(i / lanes) * steps->step;
        const int64_t high = steps->at + (int64_t)((i + 8) / lanes) * steps->step;
        row[i] = load_halves(kernel->weights + (low >> CUT & (L1L2_WARP_PHASES - 1)) * 8,
                             kernel->weights + (high >> CUT & (L1L2_WARP_PHASES - 1)) * 8);
    }
    __m256i two[8], four[6];
    for (int i = 0; i < 8; i += 2) {
        two[i] = _mm256_unpacklo_epi16(row[i], row[i + 1]);     /* taps 0..3 */
        two[i + 1] = _mm256_unpackhi_epi16(row[i], row[i + 1]); /* taps 4, 5 */
    }
    for (int i = 0; i < 2; i++) {
        four[3 * i] = _mm256_unpacklo_epi32(two[4 * i], two[4 * i + 2]);         /* taps 0, 1 */
        four[3 * i + 1] = _mm256_unpackhi_epi32(two[4 * i], two[4 * i + 2]);     /* taps 2, 3 */
        four[3 * i + 2] = _mm256_unpacklo_epi32(two[4 * i + 1], two[4 * i + 3]); /* taps 4, 5 */
    }
    TapWeights w;
    for (int k = 0; k < 3; k++) {
        w.tap[2 * k] = _mm256_unpacklo_epi64(four[k], four[3 + k]);
        w.tap[2 * k + 1] = _mm256_unpackhi_epi64(four[k], four[3 + k]);
    }
    return w;
}

L1L2_INLINE TapWeights weigh(const L1L2WarpKernel *kernel, const Steps *steps, __m256i position, const Shape shape,
                             const bool down)
{
    const __m256i phase = _mm256_and_si256(position, words(L1L2_WARP_PHASES - 1));
    return shape.taps == 4 ? weigh_cubic(phase) : weigh_lanczos(kernel, steps, shape.components, down);
}

/* Sixteen lanes' weighted sums down `rows` rows, all lanes from the same first row. */
L1L2_INLINE __m256i sum_down(const uint8_t *first, ptrdiff_t stride, const __m256i *weight, const int rows)
{
    const __m256i to_upper_bytes = _mm256_setr_epi8(-1, 0, -1, 1, -1, 2, -1, 3, -1, 4, -1, 5, -1, 6, -1, 7,
                                                    -1, 8, -1, 9, -1, 10, -1, 11, -1, 12, -1, 13, -1, 14, -1, 15);
    __m256i sum = _mm256_setzero_si256();
    for (int r = 0; r < rows; r++) {
        const __m256i bytes = _mm256_broadcastsi128_si256(_mm_loadu_si128((const void *)(first + r * stride)));
        const __m256i sample = _mm256_xor_si256(_mm256_shuffle_epi8(bytes, to_upper_bytes), words(-32768));
        sum = _mm256_add_epi16(sum, _mm256_mulhrs_epi16(sample, weight[r]));
    }
    return sum;
}

/* The same where the scanline crosses a row once: lanes whose `further` is 1, not 0, have their taps one row further
 * down. There is no branch: where a scanline crosses a row changes from row to row, and would be predicted badly. */
L1L2_INLINE __m256i sum_across(const uint8_t *first, ptrdiff_t stride, const TapWeights *w, __m256i further,
                               const int taps)
{
    const __m256i down = _mm256_sub_epi16(_mm256_setzero_si256(), further);
    __m256i weight[L1L2_WARP_MAX_TAPS + 1];
    weight[0] = _mm256_andnot_si256(down, w->tap[0]);
    for (int r = 1; r < taps; r++)
        weight[r] = _mm256_blendv_epi8(w->tap[r], w->tap[r - 1], down);
    weight[taps] = _mm256_and_si256(down, w->tap[taps - 1]);
    return sum_down(first, stride, weight, taps + 1);
}

/* The source rows that a group's columns are at. */
typedef struct Rows {
    const uint8_t *first; /* the topmost taps of the group's columns */
    ptrdiff_t stride;
    int64_t row;          /* the uppermost row that a lane is at */
    int more;             /* rows from there to the lowest one, if the piece is steep */
} Rows;

/* The same where it crosses several rows: `further` is 0 .. rows->more. Every first row is summed, and each lane takes
 * its own. */
L1L2_INLINE __m256i sum_steep(const Rows *rows, const TapWeights *w, __m256i further, const int taps)
{
    __m256i sum = _mm256_setzero_si256();
    for (int row = 0; row <= rows->more; row++)
        sum = _mm256_blendv_epi8(sum, sum_down(rows->first + row * rows->stride, rows->stride, w->tap, taps),
                                 _mm256_cmpeq_epi16(further, words(row)));
    return sum;
}

/* How often a group of a piece crosses a row of the source: never, at most once, more often. */
enum { FLAT, CROSSING, STEEP };

/* The sums of a group's columns. */
L1L2_INLINE __m256i group_down(const Rows *rows, const L1L2WarpKernel *kernel, const Steps *steps, const Shape shape,
                               const int crossing)
{
    const int32_t from_row = (int32_t)(steps->at - rows->row * ((int64_t)1 << L1L2_WARP_STEP_BITS));
    const __m256i position = positions_from(steps, from_row, shape.components, true);
    const __m256i further = _mm256_srai_epi16(position, L1L2_WARP_PHASE_BITS);
    const TapWeights w = weigh(kernel, steps, position, shape, true);
    if (crossing == FLAT)
        return sum_down(rows->first, rows->stride, w.tap, shape.taps);
    if (crossing == CROSSING)
        return sum_across(rows->first, rows->stride, &w, further, shape.taps);
    return sum_steep(rows, &w, further, shape.taps);
}

/* What a group of columns may reach beyond the plane. */
enum { BLOCK_ROWS = L1L2_WARP_MAX_TAPS + 9, BLOCK_BYTES = LANES }; /* 16 columns go up or down by 8 rows at most */

/* Copies the rows of a group, with the plane's edge repeated beyond it. */
static void copy_block(const L1L2WarpPlane *src, int64_t row, int64_t column, int count, const int components,
                       uint8_t *block)
{
    const bool whole = column >= 0 && column * components + BLOCK_BYTES <= (int64_t)src->width * components;
    for (int r = 0; r < count; r++, block += BLOCK_BYTES) {
        const uint8_t *line = src->data + l1l2_warp_clamp((int)(row + r), src->height) * src->stride;
        if (whole) {
            memcpy(block, line + column * components, BLOCK_BYTES);
            continue;
        }
        for (int i = 0; i < BLOCK_BYTES / components; i++)
            memcpy(block + i * components,
                   line + (ptrdiff_t)l1l2_warp_clamp((int)(column + i), src->width) * components, (size_t)components);
    }
}

/* Groups of columns of a piece, and what the last group has beyond. A group that reaches beyond the plane reads a copy
 * of its taps, since a pointer to what is not there would lie outside the plane. */
L1L2_INLINE void piece_down(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int first_column, Entries columns,
                            int16_t *values, const Shape shape, const int crossing)
{
    const L1L2WarpPiece *piece = columns.piece;
    const int components = shape.components, group = group_of(components), lead = shape.taps / 2 - 1;
    /* A group has all of its columns, and sixteen bytes, in the plane if it begins before this one. */
    const int outside = src->width - (LANES + components - 1) / components + 1;
    const int64_t across = (int64_t)(group - 1) * piece->step, to_low = piece->step < 0 ? across : 0;
    uint8_t block[BLOCK_ROWS * BLOCK_BYTES];
    Steps steps = steps_of(piece, components);
    for (int i = columns.from; i < columns.to; i += group) {
        const int64_t low = steps.at + to_low, row = low >> L1L2_WARP_STEP_BITS;
        const ptrdiff_t column = first_column + i;
        Rows rows = {
            .row = row,
            .more = (int)(((low == steps.at ? low + across : steps.at) >> L1L2_WARP_STEP_BITS) - row),
        };
        const int count = shape.taps + (crossing == FLAT ? 0 : crossing == CROSSING ? 1 : rows.more);
        if (column >= 0 && column < outside && row >= lead && row - lead + count <= src->height) {
            rows.first = src->data + (row - lead) * src->stride + column * components;
            rows.stride = src->stride;
        } else {
            copy_block(src, row - lead, column, count, components, block);
            rows.first = block;
            rows.stride = BLOCK_BYTES;
        }
        const __m256i sum = group_down(&rows, kernel, &steps, shape, crossing);
        _mm256_storeu_si256((void *)(values + i * components), sum);
        steps.at += (int64_t)group * piece->step;
    }
}

L1L2_INLINE int row_of(const L1L2WarpPiece *piece, int i)
{
    return l1l2_warp_piece_position(piece, i) >> L1L2_WARP_PHASE_BITS;
}

L1L2_INLINE void run_down(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *scanline,
                          int16_t *values, const Shape shape)
{
    const int group = group_of(shape.components);
    for (int k = 0; k < scanline->down_pieces; k++) {
        const L1L2WarpPiece *piece = &scanline->down[k];
        const Entries columns = {piece, piece->from, end_of(scanline->down, k, scanline->down_pieces,
                                                            scanline->columns)};
        if (scanline->down_pieces == 1 && row_of(piece, columns.from) == row_of(piece, columns.to + group - 1))
            piece_down(src, kernel, scanline->first, columns, values, shape, FLAT);
        else if (abs(piece->step) <= (1 << L1L2_WARP_STEP_BITS) / group)
            piece_down(src, kernel, scanline->first, columns, values, shape, CROSSING);
        else
            piece_down(src, kernel, scanline->first, columns, values, shape, STEEP);
    }
}

/* Eight sums along. first_low, first_high: the first values of two quarters' windows. */
L1L2_INLINE __m256i sum_along(const int16_t *first_low, const int16_t *first_high, __m256i pairs, const __m256i *weight,
                              const Shape shape)
{
    __m256i sum = _mm256_set1_epi32(L1L2_WARP_SCANLINE_ROUND);
    for (int k = 0; k < shape.taps / 2; k++) {
        const int step = 2 * k * shape.components;
        const __m256i window = load_halves(first_low + step, first_high + step);
        sum = _mm256_add_epi32(sum, _mm256_madd_epi16(_mm256_shuffle_epi8(window, pairs), weight[k]));
    }
    return _mm256_srai_epi32(sum, L1L2_WARP_SCANLINE_SHIFT);
}

/* Renders the samples of a group. */
L1L2_INLINE void group_along(const L1L2WarpKernel *kernel, const Steps *steps, const int16_t *values, uint8_t *dst,
                             const Shape shape)
{
    const int taps = shape.taps, components = shape.components;
    const int64_t at = steps->at, quarter_step = (int64_t)group_of(components) / 4 * steps->step;
    const __m256i position = positions_from(steps, (int32_t)(at & ((1 << L1L2_WARP_STEP_BITS) - 1)), components, false);
    const __m256i column = _mm256_srai_epi16(position, L1L2_WARP_PHASE_BITS);
    const TapWeights w = weigh(kernel, steps, position, shape, false);

    /* The bytes of the first two taps in a quarter's window. */
    const __m256i offset = _mm256_sub_epi16(column, _mm256_shufflehi_epi16(_mm256_shufflelo_epi16(column, 0), 0));
    const __m256i component = components == 1 ? words(0) : components == 2 ? _mm256_set1_epi32(0x02020000)
                                                         : _mm256_set1_epi64x(0x0606040402020000);
    const __m256i left = _mm256_add_epi16(_mm256_mullo_epi16(offset, words(components * 0x0202)),
                                          _mm256_add_epi16(component, words(0x0100)));
    const __m256i right = _mm256_add_epi16(left, words(components * 0x0202));
    __m256i low[L1L2_WARP_MAX_TAPS / 2], high[L1L2_WARP_MAX_TAPS / 2];
    for (int k = 0; k < taps / 2; k++) {
        low[k] = _mm256_unpacklo_epi16(w.tap[2 * k], w.tap[2 * k + 1]);
        high[k] = _mm256_unpackhi_epi16(w.tap[2 * k], w.tap[2 * k + 1]);
    }
    const int16_t *first[4];
    for (int q = 0; q < 4; q++)
        first[q] = values + ((at + q * quarter_step) >> L1L2_WARP_STEP_BITS) * components - (taps / 2 - 1) * components;
    store(dst, _mm256_packs_epi32(
        sum_along(first[0], first[2], _mm256_unpacklo_epi16(left, right), low, shape),
        sum_along(first[1], first[3], _mm256_unpackhi_epi16(left, right), high, shape)), components);
}

/* A group may write beyond a piece's end; the next piece then overwrites that. Plain C renders the rest of the last
 * one. */
L1L2_INLINE void run_along(const L1L2WarpKernel *kernel, const L1L2WarpScanline *scanline, const int16_t *values,
                           uint8_t *dst, const Shape shape)
{
    const int components = shape.components, group = group_of(components), count = scanline->count;
    for (int k = 0; k < scanline->along_pieces; k++) {
        const L1L2WarpPiece *piece = &scanline->along[k];
        Steps steps = steps_of(piece, components);
        const int end = end_of(scanline->along, k, scanline->along_pieces, count);
        int i = piece->from;
        for (; i < end && i + group <= count; i += group, steps.at += (int64_t)group * steps.step)
            group_along(kernel, &steps, values, dst + i * components, shape);
        along_plain(kernel, (Entries){piece, i, end}, values, dst, shape);
    }
}

L1L2_INLINE void run(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *scanline,
                     uint8_t *dst, const Shape shape)
{
    int16_t values[SCANLINE_VALUES];
    run_down(src, kernel, scanline, values, shape);
    run_along(kernel, scanline, values, dst, shape);
}

DEFINE_RUNS(l1l2_warp_scanline_u8_init_avx2)
