/* SPDX-License-Identifier: MIT */
/*
 * Sums down the columns first, then across the rows.
 *
 * Source rows are added up in the order in which they lie in memory, so the source is read once, in order. The pass
 * across then works on one row of sums for each output row.
 *
 * Sizes from : to are reduced to coprime numbers total : unit. With every source sample cut into `unit` parts, each
 * output covers exactly `total` of these parts, and all weights are whole numbers.
 */
#include "image/area_scale.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/cpu.h"
#include "common/mem.h"
#include "image/area_scale_row.h"

enum { COLUMN_MAX = INT16_MAX, WEIGHT_MAX = INT16_MAX };

/* `from` source samples become `to` outputs. A source sample has `unit` parts, an output covers `total` of them. */
typedef struct Axis {
    int from, to, unit, total;
} Axis;

struct L1L2AreaScaler {
    L1L2AreaScaleFunctions functions;
    bool deep;          /* samples have 16 bits */
    bool copy;          /* the output is the source: same size, one component of 8 bits */
    bool narrow;        /* samples are bytes, and a column's weighted sum of them fits 15 bits */
    bool pairs;         /* one component, half as wide: an output is the sum of two samples */
    int components;     /* of a pixel */
    Axis x, y;
    L1L2FormatInfo format;
    uint32_t base;      /* subtracted from a column's sum; a negative result becomes 0 */
    int shift;          /* number of low bits that are rounded off a column's sum, so that it fits 15 bits */
    int whole;          /* the sum of the weights of an output across */
    int taps;           /* samples that an output sums across, rounded up to a whole block */
    int count;          /* outputs of a row, rounded up to a whole block */
    float half, scale;  /* output = (sum across + half) * scale, cut to an integer */
    int32_t *first;     /* [count]: the first sample of each output */
    int16_t *weight;    /* [count * taps], in the order of area_scale_row.h */
    uint32_t *sum;      /* [samples of a row]: weighted sums down the columns */
    int16_t *column;    /* [samples of a row + taps]: these sums in 15 bits, then zeros */
    int32_t *across;    /* [count]: sums across */
};

static Axis axis_new(int from, int to)
{
    int a = from, b = to;
    while (b) {
        const int rest = a % b;
        a = b, b = rest;
    }
    return (Axis){.from = from, .to = to, .unit = to / a, .total = from / a};
}

/* The first source sample that output i covers. */
static int first_covered(const Axis *axis, int i)
{
    return (int)((int64_t)i * axis->total / axis->unit);
}

/* The number of parts of source sample j that output i covers. */
static int covered(const Axis *axis, int i, int j)
{
    const int64_t start = (int64_t)i * axis->total, low = (int64_t)j * axis->unit;
    const int64_t end = start + axis->total, high = low + axis->unit;
    const int64_t parts = (end < high ? end : high) - (start > low ? start : low);
    return parts > 0 ? (int)parts : 0;
}

/* Sets the weights across. The running sum of the exact weights is rounded at each tap, and a weight is the difference
 * of two neighboring sums. So the weights of every output have the same sum, which is returned. */
static int set_weights(L1L2AreaScaler *s, const double *gray)
{
    const int whole = s->components == 1 ? s->x.total : WEIGHT_MAX, block = L1L2_AREA_SCALE_BLOCK;
    for (int x = 0; x < s->x.to; x++) {
        const int first = first_covered(&s->x, x);
        double exact = 0.0;
        int so_far = 0;
        s->first[x] = first * s->components;
        for (int k = 0; k < s->taps; k++) {
            const double part = s->components == 1 ? 1.0 : gray[k % s->components];
            exact += part * covered(&s->x, x, first + k / s->components) * whole / s->x.total;
            const int weight = (int)lround(exact) - so_far;
            so_far += weight;
            s->weight[(x / block * s->taps + k / block * block + x % block) * block + k % block] = (int16_t)weight;
        }
    }
    return whole;
}

/* With one component, only the levels in the range have to fit 15 bits. With several, which are mixed, all levels have
 * to. */
void l1l2_image_scale_set_levels(L1L2AreaScaler *s, L1L2Levels levels)
{
    const bool stretched = !l1l2_image_levels_equal(levels, l1l2_image_levels_full(&s->format));
    const bool cut = stretched && s->components == 1;
    const uint32_t total = (uint32_t)s->y.total, highest = ((1u << s->format.depth) - 1) << s->format.shift;
    const uint32_t most = total * (cut ? (uint32_t)(levels.high - levels.low) : highest);
    s->base = cut ? (uint32_t)levels.low * total : 0;
    s->shift = 0;
    while ((most + (1u << s->shift >> 1)) >> s->shift > COLUMN_MAX)
        s->shift++;
    s->narrow = !s->deep && s->shift == 0;
    const double level = ldexp((double)s->whole * s->y.total, -s->shift);
    const double unit = level * (levels.high - levels.low) / 256.0;
    const double offset = cut ? 0.0 : level * levels.low;
    /* The margin makes exact halves round up despite the rounding of float. */
    const double margin = stretched ? fmin(0.25, unit / 256.0) : 0.25;
    s->scale = (float)(1.0 / unit);
    s->half = (float)(0.5 * unit + margin - offset);
}

L1L2AreaScaler *l1l2_image_scale_new(const L1L2FormatInfo *format, int width, int height, int out_width, int out_height)
{
    L1L2AreaScaler *s = l1l2_mem_new(1, sizeof *s);
    if (!s)
        return NULL;
    const int block = L1L2_AREA_SCALE_BLOCK;
    l1l2_image_scale_functions_init(&s->functions, l1l2_cpu_features());
    s->format = *format;
    s->deep = format->depth > 8;
    s->components = l1l2_image_format_pixel_components(format);
    s->x = axis_new(width, out_width);
    s->y = axis_new(height, out_height);
    s->copy = !s->deep && s->components == 1 && s->x.total == 1 && s->y.total == 1;
    s->pairs = s->components == 1 && s->x.total == 2 && s->x.unit == 1;
    /* An output that begins within a sample covers a part of one more sample. */
    const int pixels = (s->x.total + s->x.unit - 1) / s->x.unit + (s->x.unit > 1);
    s->taps = (pixels * s->components + block - 1) / block * block;
    s->count = (out_width + block - 1) / block * block;
    const size_t samples = (size_t)width * (size_t)s->components;
    s->first = l1l2_mem_new((size_t)s->count, sizeof *s->first);
    s->weight = l1l2_mem_new((size_t)s->count * (size_t)s->taps, sizeof *s->weight);
    s->sum = l1l2_mem_new(samples, sizeof *s->sum);
    s->column = l1l2_mem_new(samples + (size_t)s->taps, sizeof *s->column);
    s->across = l1l2_mem_new((size_t)s->count, sizeof *s->across);
    if (!s->first || !s->weight || !s->sum || !s->column || !s->across) {
        l1l2_image_scale_free(s);
        return NULL;
    }
    s->whole = set_weights(s, format->gray);
    l1l2_image_scale_set_levels(s, l1l2_image_levels_full(format));
    return s;
}

void l1l2_image_scale_free(L1L2AreaScaler *s)
{
    if (!s)
        return;
    l1l2_mem_free(s->first);
    l1l2_mem_free(s->weight);
    l1l2_mem_free(s->sum);
    l1l2_mem_free(s->column);
    l1l2_mem_free(s->across);
    l1l2_mem_free(s);
}

/* Rows may begin at any address, so words are not read through a pointer to words. */
static inline uint16_t load_byte(const uint8_t *row, int i)
{
    return row[i];
}

static inline uint16_t load_word(const uint8_t *row, int i)
{
    uint16_t word;
    memcpy(&word, row + 2 * (ptrdiff_t)i, sizeof word);
    return word;
}

/* sum = weight * row if it is the first row of an output, else sum += weight * row. count: samples. */
#define DEFINE_ADD(name, load, Sum)                                                                                   \
    static void name(const uint8_t *row, uint16_t weight, int count, bool first, Sum *restrict sum)                   \
    {                                                                                                                 \
        if (first)                                                                                                    \
            for (int i = 0; i < count; i++)                                                                           \
                sum[i] = (Sum)((uint32_t)weight * load(row, i));                                                      \
        else                                                                                                          \
            for (int i = 0; i < count; i++)                                                                           \
                sum[i] = (Sum)(sum[i] + (uint32_t)weight * load(row, i));                                             \
    }
DEFINE_ADD(add_narrow, load_byte, int16_t)
DEFINE_ADD(add_bytes, load_byte, uint32_t)
DEFINE_ADD(add_words, load_word, uint32_t)

/* Sums to 15 bits, rounded. Samples with bits set above their depth saturate. */
static void round_columns(const uint32_t *sum, int count, int shift, int16_t *restrict column)
{
    const uint32_t half = 1u << shift >> 1;
    for (int i = 0; i < count; i++) {
        const uint32_t rounded = (sum[i] + half) >> shift;
        column[i] = (int16_t)(rounded < COLUMN_MAX ? rounded : COLUMN_MAX);
    }
}

/* The same, after `base` is subtracted. */
static void round_columns_above(const uint32_t *sum, uint32_t base, int count, int shift, int16_t *restrict column)
{
    const uint32_t half = 1u << shift >> 1;
    for (int i = 0; i < count; i++) {
        const uint32_t rounded = ((sum[i] > base ? sum[i] - base : 0) + half) >> shift;
        column[i] = (int16_t)(rounded < COLUMN_MAX ? rounded : COLUMN_MAX);
    }
}

static void add_pairs(const int16_t *column, int count, int32_t *restrict across)
{
    for (int x = 0; x < count; x++)
        across[x] = column[2 * x] + column[2 * x + 1];
}

static void round_outputs(const int32_t *across, int count, float half, float scale, uint8_t *restrict out)
{
    for (int x = 0; x < count; x++) {
        const int32_t level = (int32_t)(((float)across[x] + half) * scale);
        out[x] = (uint8_t)(level < 0 ? 0 : level < UINT8_MAX ? level : UINT8_MAX);
    }
}

void l1l2_image_scale_run(L1L2AreaScaler *s, const uint8_t *data, ptrdiff_t stride, uint8_t *out, ptrdiff_t out_stride)
{
    const int samples = s->x.from * s->components;
    for (int y = 0; y < s->y.to; y++, out += out_stride) {
        const int first = first_covered(&s->y, y);
        if (s->copy) {
            memcpy(out, data + stride * y, (size_t)samples);
            continue;
        }
        for (int j = first; j < s->y.from && covered(&s->y, y, j) > 0; j++) {
            const uint8_t *row = data + stride * j;
            const uint16_t weight = (uint16_t)covered(&s->y, y, j);
            if (s->narrow)
                add_narrow(row, weight, samples, j == first, s->column);
            else if (s->deep)
                add_words(row, weight, samples, j == first, s->sum);
            else
                add_bytes(row, weight, samples, j == first, s->sum);
        }
        if (s->base > 0)
            round_columns_above(s->sum, s->base, samples, s->shift, s->column);
        else if (!s->narrow)
            round_columns(s->sum, samples, s->shift, s->column);
        if (s->pairs)
            add_pairs(s->column, s->x.to, s->across);
        else
            s->functions.row(s->column, s->first, s->weight, s->taps, s->count, s->across);
        round_outputs(s->across, s->x.to, s->half, s->scale, out);
    }
}
