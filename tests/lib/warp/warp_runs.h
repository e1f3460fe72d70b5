/* SPDX-License-Identifier: MIT */
/* What the tests of the sample types share: two functions that must give the same bytes for any positions. */
#ifndef WARP_RUNS_H
#define WARP_RUNS_H

#include <stdlib.h>
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "warp/sample.h"

enum { ONE = L1L2_WARP_PHASES, MAX_COUNT = 67, GUARD_BYTES = 32, GUARD_BYTE = 0x5A };

/* How positions follow each other, in 1/1024 samples. */
typedef struct Walk {
    int step_x, step_y;
    int jitter; /* each position is off by up to this much */
} Walk;

static const Walk walks[] = {
    {ONE, 0, 0},           {ONE * 9 / 10, 17, 0},      {ONE * 11 / 10, -40, 0},    {ONE * 9 / 10, 250, 0},
    {ONE, -400, 0},        {0, ONE, 0},                {-ONE, 3, 0},               {ONE * 3, ONE / 3, 0},
    {ONE * 4, 0, ONE * 2}, {ONE / 50, -ONE / 50, 0},   {ONE, 0, ONE},              {0, 0, 60 * ONE},
    {ONE / 2, 100, ONE},   {ONE * 2, ONE * 2, 0},
};

static inline void walk(const Walk *way, L1L2Rng *rng, int width, int height, int count, int32_t *x, int32_t *y)
{
    /* Starts inside or a little outside, so that the positions cross edges. */
    const int from_x = (int)l1l2_rng_below(rng, (uint32_t)((width + 20) * ONE)) - 10 * ONE;
    const int from_y = (int)l1l2_rng_below(rng, (uint32_t)((height + 20) * ONE)) - 10 * ONE;
    for (int i = 0; i < count; i++) {
        x[i] = from_x + i * way->step_x + (int)l1l2_rng_below(rng, (uint32_t)(2 * way->jitter + 1)) - way->jitter;
        y[i] = from_y + i * way->step_y + (int)l1l2_rng_below(rng, (uint32_t)(2 * way->jitter + 1)) - way->jitter;
    }
}

/* Two functions for the same planes, and those planes. */
typedef struct RunPair {
    L1L2WarpDirectRun *fast, *plain;
    int components, depth, shift;
} RunPair;

static inline int sample_bytes(const RunPair *pair)
{
    return pair->components * (pair->depth > 8 ? 2 : 1);
}

/* A plane whose memory ends with its last sample, so that the sanitizer reports reads beyond it. */
static inline L1L2WarpPlane plane_new(L1L2Rng *rng, const RunPair *pair, int width, int height, int padding)
{
    const uint32_t max = (1u << pair->depth) - 1;
    const ptrdiff_t row = (ptrdiff_t)width * sample_bytes(pair), stride = row + padding;
    uint8_t *data = malloc((size_t)(stride * (height - 1) + row));
    ck_assert_ptr_nonnull(data);
    for (int v = 0; v < height; v++)
        for (int k = 0; k < width * pair->components; k++) {
            const uint32_t level = l1l2_rng_below(rng, 3) ? l1l2_rng_next(rng) & max : l1l2_rng_below(rng, 2) * max;
            uint8_t *at = data + v * stride + k * sample_bytes(pair) / pair->components;
            at[0] = (uint8_t)(level << pair->shift);
            if (pair->depth > 8)
                at[1] = (uint8_t)(level << pair->shift >> 8);
        }
    return (L1L2WarpPlane){data, stride, width, height, pair->depth, pair->shift};
}

static inline void plane_free(L1L2WarpPlane *plane)
{
    free((void *)plane->data);
}

static inline void compare_runs(const RunPair *pair, const L1L2WarpPlane *src, const L1L2WarpKernel *kernel,
                                const int32_t *x, const int32_t *y, int count)
{
    uint8_t fast[8 * MAX_COUNT + GUARD_BYTES], plain[8 * MAX_COUNT + GUARD_BYTES];
    memset(fast, GUARD_BYTE, sizeof fast);
    memset(plain, GUARD_BYTE, sizeof plain);
    pair->fast(src, kernel, x, y, count, fast);
    pair->plain(src, kernel, x, y, count, plain);
    for (int i = 0; i < (int)sizeof fast; i++)
        if (fast[i] != plain[i] || (i >= count * sample_bytes(pair) && fast[i] != GUARD_BYTE))
            ck_abort_msg("%d taps, %d components of %d bits, %dx%d, byte %d of %d: %d, plain %d", kernel->taps,
                         pair->components, pair->depth, src->width, src->height, i, count * sample_bytes(pair), fast[i],
                         plain[i]);
}

static inline void compare_on_all_walks(const RunPair *pair, const L1L2WarpKernel *kernel, L1L2Rng *rng)
{
    static const int sizes[][2] = {{8, 8}, {9, 13}, {17, 9}, {40, 30}, {120, 90}};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        L1L2WarpPlane src = plane_new(rng, pair, sizes[s][0], sizes[s][1], (int)s);
        for (size_t k = 0; k < sizeof walks / sizeof walks[0]; k++)
            for (int round = 0; round < 40; round++) {
                int32_t x[MAX_COUNT], y[MAX_COUNT];
                const int count = 1 + (int)l1l2_rng_below(rng, MAX_COUNT);
                walk(&walks[k], rng, src.width, src.height, count, x, y);
                compare_runs(pair, &src, kernel, x, y, count);
            }
        plane_free(&src);
    }
}

static inline void compare_in_all_phases(const RunPair *pair, const L1L2WarpKernel *kernel, L1L2Rng *rng)
{
    L1L2WarpPlane src = plane_new(rng, pair, 60, 40, 0);
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        int32_t x[16], y[16];
        for (int i = 0; i < 16; i++) {
            x[i] = (10 + i) * ONE + (phase + i) % ONE;
            y[i] = 10 * ONE + (7 * phase + i) % ONE;
        }
        compare_runs(pair, &src, kernel, x, y, 16);
    }
    plane_free(&src);
}

#endif
