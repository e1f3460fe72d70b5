/* SPDX-License-Identifier: MIT */
#include "image/float_pyramid.h"

#include <stdbool.h>
#include <string.h>

#include "common/mem.h"

/* The blur of level 0: a Gaussian of sigma 1.2 samples, sampled at the integers and normalized. After it the brightness
 * between two samples is nearly linear, which Gauss-Newton and bilinear lookup assume. It also removes most of the
 * noise and of the compression artifacts. */
enum { RADIUS = 4 };
static const float kernel[RADIUS + 1] = {0.3324903f, 0.2349537f, 0.0829072f, 0.0146086f, 0.0012854f};

L1L2FloatPyramid *l1l2_image_float_pyramid_new(int width, int height)
{
    L1L2FloatPyramid *p = l1l2_mem_new(1, sizeof *p);
    if (!p)
        return NULL;
    p->width = width, p->height = height;
    int w = width, h = height, step = 1;
    while ((w > L1L2_FLOAT_PYRAMID_SIDE || h > L1L2_FLOAT_PYRAMID_SIDE) && w / 2 >= L1L2_FLOAT_PYRAMID_MIN_SIDE &&
           h / 2 >= L1L2_FLOAT_PYRAMID_MIN_SIDE)
        w /= 2, h /= 2, step *= 2;
    const size_t largest = (size_t)w * (size_t)h;
    p->halved = l1l2_mem_new((size_t)width * (size_t)height / 4 + 1, sizeof *p->halved);
    p->row = l1l2_mem_new(largest, sizeof *p->row);
    bool complete = p->halved && p->row;
    while (complete && p->levels < L1L2_FLOAT_PYRAMID_MAX_LEVELS && w >= L1L2_FLOAT_PYRAMID_MIN_SIDE &&
           h >= L1L2_FLOAT_PYRAMID_MIN_SIDE) {
        float *sample = l1l2_mem_new((size_t)w * (size_t)h, sizeof *sample);
        p->level[p->levels++] = (L1L2FloatLevel){sample, w, h, step};
        complete = sample != NULL;
        w /= 2, h /= 2, step *= 2;
    }
    if (!complete) {
        l1l2_image_float_pyramid_free(p);
        return NULL;
    }
    return p;
}

void l1l2_image_float_pyramid_free(L1L2FloatPyramid *p)
{
    if (!p)
        return;
    for (int i = 0; i < p->levels; i++)
        l1l2_mem_free(p->level[i].sample);
    l1l2_mem_free(p->halved);
    l1l2_mem_free(p->row);
    l1l2_mem_free(p);
}

/* The sums of 2 x 2 bytes, in quarters of a gray level. */
static void halve_bytes(const uint8_t *gray, ptrdiff_t stride, int width, int height, uint16_t *out)
{
    for (int y = 0; y < height; y++) {
        const uint8_t *restrict a = gray + 2 * y * stride, *restrict b = a + stride;
        uint16_t *restrict to = out + (ptrdiff_t)y * width;
        for (int x = 0; x < width; x++)
            to[x] = (uint16_t)(a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
    }
}

/* Halves in place. A result is written where all samples have been read already, or where its own inputs lie. */
static void halve_again(uint16_t *sums, int from_width, int width, int height)
{
    for (int y = 0; y < height; y++) {
        const uint16_t *a = sums + (ptrdiff_t)2 * y * from_width, *b = a + from_width;
        for (int x = 0; x < width; x++)
            sums[(ptrdiff_t)y * width + x] =
                (uint16_t)((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
    }
}

/* The picture at level 0's size, not yet blurred. */
static void shrink(L1L2FloatPyramid *p, const uint8_t *gray, ptrdiff_t stride)
{
    const L1L2FloatLevel *to = p->level;
    if (to->step == 1) {
        for (int y = 0; y < to->height; y++)
            for (int x = 0; x < to->width; x++)
                p->row[(ptrdiff_t)y * to->width + x] = (float)gray[y * stride + x];
        return;
    }
    int w = p->width / 2, h = p->height / 2;
    halve_bytes(gray, stride, w, h, p->halved);
    for (int step = 2; step < to->step; step *= 2) {
        halve_again(p->halved, w, w / 2, h / 2);
        w /= 2, h /= 2;
    }
    for (ptrdiff_t i = 0; i < (ptrdiff_t)w * h; i++)
        p->row[i] = 0.25f * (float)p->halved[i];
}

static int clamped(int i, int count)
{
    return i < 0 ? 0 : i >= count ? count - 1 : i;
}

/* Down the columns, from p->row to level 0. Beyond the edge, the edge is repeated. */
static void blur_columns(const float *from, float *to, int width, int height)
{
    for (int y = 0; y < height; y++) {
        const float *in[2 * RADIUS + 1];
        float *restrict out = to + (ptrdiff_t)y * width;
        for (int k = -RADIUS; k <= RADIUS; k++)
            in[k + RADIUS] = from + (ptrdiff_t)clamped(y + k, height) * width;
        for (int x = 0; x < width; x++)
            out[x] = kernel[0] * in[4][x] + kernel[1] * (in[3][x] + in[5][x]) + kernel[2] * (in[2][x] + in[6][x]) +
                     kernel[3] * (in[1][x] + in[7][x]) + kernel[4] * (in[0][x] + in[8][x]);
    }
}

/* Along the rows of level 0, in place. `line` is working memory: a row, with its end samples repeated on both sides. */
static void blur_rows(float *sample, float *line, int width, int height)
{
    for (int y = 0; y < height; y++) {
        float *restrict row = sample + (ptrdiff_t)y * width;
        memcpy(line + RADIUS, row, (size_t)width * sizeof *row);
        for (int k = 0; k < RADIUS; k++)
            line[k] = row[0], line[RADIUS + width + k] = row[width - 1];
        const float *restrict in = line + RADIUS;
        for (int x = 0; x < width; x++)
            row[x] = kernel[0] * in[x] + kernel[1] * (in[x - 1] + in[x + 1]) + kernel[2] * (in[x - 2] + in[x + 2]) +
                     kernel[3] * (in[x - 3] + in[x + 3]) + kernel[4] * (in[x - 4] + in[x + 4]);
    }
}

static void halve_level(const L1L2FloatLevel *from, const L1L2FloatLevel *to)
{
    for (int y = 0; y < to->height; y++) {
        const float *restrict a = from->sample + (ptrdiff_t)2 * y * from->width, *restrict b = a + from->width;
        float *restrict out = to->sample + (ptrdiff_t)y * to->width;
        for (int x = 0; x < to->width; x++)
            out[x] = 0.25f * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
    }
}

void l1l2_image_float_pyramid_build(L1L2FloatPyramid *p, const uint8_t *gray, ptrdiff_t stride)
{
    const L1L2FloatLevel *first = p->level;
    shrink(p, gray, stride);
    blur_columns(p->row, first->sample, first->width, first->height);
    blur_rows(first->sample, p->row, first->width, first->height); /* the rows are not needed any more */
    for (int i = 1; i < p->levels; i++)
        halve_level(p->level + i - 1, p->level + i);
}
