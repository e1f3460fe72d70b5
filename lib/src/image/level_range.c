/* SPDX-License-Identifier: MIT */
#include "image/level_range.h"

#include <string.h>

/* The grid of pixels that are sampled: enough for percentiles, and few enough to cost almost no time. */
enum { COLUMNS = 64, ROWS = 36, SAMPLES = COLUMNS * ROWS, TAIL = SAMPLES / 100 };
/* The ends of the range are rounded to multiples of a power of two, which is at most 1 / STEPS of the range. */
enum { STEPS = 8 };
/* A range is stretched if it is below 1 / MIN_PART of the full range. A picture whose percentiles are less than
 * MIN_STEPS steps of the format apart counts as empty. */
enum { MIN_PART = 8, MIN_STEPS = 32 };

L1L2Levels l1l2_image_levels_full(const L1L2FormatInfo *format)
{
    return (L1L2Levels){0, (int32_t)1 << (format->depth + format->shift)};
}

bool l1l2_image_levels_equal(L1L2Levels a, L1L2Levels b)
{
    return a.low == b.low && a.high == b.high;
}

/* The gray level of the pixel at p, whose components have two bytes. */
static uint16_t gray_of(const L1L2FormatInfo *format, const uint8_t *p)
{
    const int components = l1l2_image_format_pixel_components(format);
    double gray = 0.0;
    for (int k = 0; k < components; k++) {
        uint16_t level;
        memcpy(&level, p + 2 * k, sizeof level);
        if (components == 1)
            return level;
        gray += format->gray[k] * level;
    }
    return (uint16_t)(gray + 0.5);
}

/* The sample of this rank in ascending order, from 0. Found by a histogram of the high bytes, then by one of the low
 * bytes of the samples with the right high byte. */
static int32_t ranked(const uint16_t *sample, int rank)
{
    int high[256] = {0}, low[256] = {0}, h = 0, l = 0;
    for (int i = 0; i < SAMPLES; i++)
        high[sample[i] >> 8]++;
    while (rank >= high[h])
        rank -= high[h++];
    for (int i = 0; i < SAMPLES; i++)
        if (sample[i] >> 8 == h)
            low[sample[i] & 255]++;
    while (rank >= low[l])
        rank -= low[l++];
    return h << 8 | l;
}

static L1L2Levels percentiles(const L1L2FormatInfo *format, const uint8_t *data, ptrdiff_t stride, int width,
                              int height)
{
    uint16_t sample[SAMPLES];
    const int pixel = 2 * l1l2_image_format_pixel_components(format);
    for (int i = 0; i < SAMPLES; i++) {
        const int x = (2 * (i % COLUMNS) + 1) * width / (2 * COLUMNS);
        const int y = (2 * (i / COLUMNS) + 1) * height / (2 * ROWS);
        sample[i] = gray_of(format, data + stride * y + (ptrdiff_t)x * pixel);
    }
    return (L1L2Levels){ranked(sample, TAIL), ranked(sample, SAMPLES - 1 - TAIL)};
}

static L1L2Levels union_of(const L1L2LevelRange *range)
{
    L1L2Levels all = range->own[0];
    for (int i = 1; i < range->count; i++) {
        all.low = range->own[i].low < all.low ? range->own[i].low : all.low;
        all.high = range->own[i].high > all.high ? range->own[i].high : all.high;
    }
    return all;
}

/* The range with its margins, rounded outwards. */
static L1L2Levels widened(L1L2Levels levels)
{
    const int32_t span = levels.high - levels.low, margin = span / 4;
    int32_t step = 1;
    while (2 * step * STEPS <= span)
        step *= 2;
    const int32_t low = levels.low > margin ? levels.low - margin : 0, high = levels.high + margin;
    return (L1L2Levels){low / step * step, (high / step + 1) * step};
}

L1L2Levels l1l2_image_levels_push(L1L2LevelRange *range, const L1L2FormatInfo *format, const uint8_t *data,
                                  ptrdiff_t stride, int width, int height)
{
    const L1L2Levels full = l1l2_image_levels_full(format);
    if (format->depth <= 8)
        return full;
    range->own[range->next] = percentiles(format, data, stride, width, height);
    range->next = (range->next + 1) % L1L2_LEVEL_FRAMES;
    range->count += range->count < L1L2_LEVEL_FRAMES;
    const L1L2Levels used = union_of(range), wide = widened(used);
    const bool empty = used.high - used.low < (int32_t)MIN_STEPS << format->shift;
    return empty || wide.high - wide.low >= full.high / MIN_PART ? full : wide;
}
