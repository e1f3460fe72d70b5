/* SPDX-License-Identifier: MIT */
#include "motion/pyramid.h"

#include <string.h>

#include "common/mem.h"

enum {
    BORDER_X = L1L2_LK_BORDER_X,
    BORDER_Y = L1L2_LK_BORDER_Y,
    STRIP = 256, /* columns that are filtered at a time */
    SLACK = 32   /* bytes after the last row: wide loads of the tracking may begin within its border */
};

static size_t padded_pixels(int width, int height)
{
    return (size_t)(width + 2 * BORDER_X) * (size_t)(height + 2 * BORDER_Y);
}

/* Lays the levels out in p->memory. */
static void place_levels(L1L2Pyramid *p)
{
    uint8_t *grey = p->memory;
    for (int i = 0; i < p->levels; i++) {
        L1L2LkLevel *level = &p->level[i];
        const size_t pixels = padded_pixels(level->width, level->height);
        level->stride = level->slope_stride = level->width + 2 * BORDER_X;
        level->slope_stride *= 2;
        p->slope[i] = (int16_t *)(void *)grey + BORDER_Y * level->slope_stride + 2 * BORDER_X;
        grey += 2 * sizeof(int16_t) * pixels + SLACK;
        p->grey[i] = grey + BORDER_Y * level->stride + BORDER_X;
        grey += (pixels + SLACK + 15) / 16 * 16;
        level->slope = p->slope[i];
        level->grey = p->grey[i];
    }
}

L1L2Pyramid *l1l2_motion_pyramid_new(int width, int height)
{
    size_t bytes = 0;
    L1L2Pyramid *p = l1l2_mem_new(1, sizeof *p);
    if (!p)
        return NULL;
    do {
        p->level[p->levels].width = width;
        p->level[p->levels].height = height;
        bytes += (2 * sizeof(int16_t) + 1) * padded_pixels(width, height) + 2 * SLACK + 16;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    } while (++p->levels < L1L2_PYRAMID_MAX_LEVELS && width > BORDER_X && height > BORDER_Y);
    p->memory = l1l2_mem_new(bytes, 1);
    if (!p->memory) {
        l1l2_motion_pyramid_free(p);
        return NULL;
    }
    place_levels(p);
    return p;
}

void l1l2_motion_pyramid_free(L1L2Pyramid *p)
{
    if (!p)
        return;
    l1l2_mem_free(p->memory);
    l1l2_mem_free(p);
}

/* The pixel that lies at i of a row (or column) that is mirrored about its first and last pixel, again and again. */
static int mirrored(int i, int length)
{
    if (length == 1)
        return 0;
    while (i < 0 || i >= length)
        i = i < 0 ? -i : 2 * (length - 1) - i;
    return i;
}

static void fill_border(const L1L2LkLevel *level, uint8_t *grey)
{
    const int width = level->width, height = level->height;
    for (int y = 0; y < height; y++) {
        uint8_t *row = grey + y * level->stride;
        for (int i = 1; i <= BORDER_X; i++) {
            row[-i] = row[mirrored(-i, width)];
            row[width - 1 + i] = row[mirrored(width - 1 + i, width)];
        }
    }
    uint8_t *left = grey - BORDER_X;
    for (int i = 1; i <= BORDER_Y; i++) {
        memcpy(left - i * level->stride, left + mirrored(-i, height) * level->stride, (size_t)level->stride);
        memcpy(left + (height - 1 + i) * level->stride, left + mirrored(height - 1 + i, height) * level->stride,
               (size_t)level->stride);
    }
}

/* Half-size pixels [x, x + count) of one row: the five rows around `row`, weighted 1 4 6 4 1 in both directions. */
static void halve_strip(const uint8_t *row, ptrdiff_t stride, uint8_t *half, int count)
{
    uint16_t down[2 * STRIP + 4]; /* at most 16 * 255 */
    const uint8_t *a = row - 2 * stride - 2, *b = row - stride - 2, *c = row - 2;
    const uint8_t *d = row + stride - 2, *e = row + 2 * stride - 2;
    for (int x = 0; x < 2 * count + 4; x++)
        down[x] = (uint16_t)(a[x] + e[x] + 4 * (b[x] + d[x]) + 6 * c[x]);
    for (int x = 0; x < count; x++) {
        const uint16_t *t = down + 2 * x;
        half[x] = (uint8_t)((t[0] + t[4] + 4 * (t[1] + t[3]) + 6 * t[2] + 128) >> 8);
    }
}

static void halve(const L1L2LkLevel *level, const L1L2LkLevel *half, uint8_t *grey)
{
    for (int y = 0; y < half->height; y++)
        for (int x = 0; x < half->width; x += STRIP) {
            const int count = half->width - x < STRIP ? half->width - x : STRIP;
            halve_strip(level->grey + 2 * y * level->stride + 2 * x, level->stride, grey + y * half->stride + x,
                        count);
        }
}

/* Scharr's slopes of `count` pixels of one row, across and down by turns. */
static void slope_strip(const uint8_t *row, ptrdiff_t stride, int16_t *slope, int count)
{
    int16_t smooth[STRIP + 2], change[STRIP + 2];
    const uint8_t *above = row - stride - 1, *here = row - 1, *below = row + stride - 1;
    for (int x = 0; x < count + 2; x++) {
        smooth[x] = (int16_t)(3 * (above[x] + below[x]) + 10 * here[x]);
        change[x] = (int16_t)(below[x] - above[x]);
    }
    for (int x = 0; x < count; x++) {
        slope[2 * x] = (int16_t)(smooth[x + 2] - smooth[x]);
        slope[2 * x + 1] = (int16_t)(3 * (change[x] + change[x + 2]) + 10 * change[x + 1]);
    }
}

static void find_slopes(const L1L2LkLevel *level, int16_t *slope)
{
    for (int y = 0; y < level->height; y++)
        for (int x = 0; x < level->width; x += STRIP)
            slope_strip(level->grey + y * level->stride + x, level->stride, slope + y * level->slope_stride + 2 * x,
                        level->width - x < STRIP ? level->width - x : STRIP);
}

void l1l2_motion_pyramid_build(L1L2Pyramid *p)
{
    for (int i = 0; i < p->levels; i++) {
        if (i > 0)
            halve(&p->level[i - 1], &p->level[i], p->grey[i]);
        fill_border(&p->level[i], p->grey[i]);
        find_slopes(&p->level[i], p->slope[i]);
    }
}
