/* SPDX-License-Identifier: MIT */
/* What this processor runs against plain C: the same bytes, for any positions at all. Where that is plain C itself, the
 * first two tests compare it with itself. */
#include <string.h>

#include "checkx.h"
#include "rng.h"
#include "warp_u8.h"

enum { ONE = L1L2_WARP_PHASES, MAX_COUNT = 67, GUARD_BYTES = 32, GUARD_BYTE = 0x5A };

/* Ways in which positions follow each other: starts and steps in 1/1024 samples. */
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

static void walk(const Walk *way, L1L2Rng *rng, int width, int height, int count, int32_t *x, int32_t *y)
{
    /* Starting from inside or a little outside: the way then crosses edges. */
    const int from_x = (int)l1l2_rng_below(rng, (uint32_t)((width + 20) * ONE)) - 10 * ONE;
    const int from_y = (int)l1l2_rng_below(rng, (uint32_t)((height + 20) * ONE)) - 10 * ONE;
    for (int i = 0; i < count; i++) {
        x[i] = from_x + i * way->step_x + (int)l1l2_rng_below(rng, (uint32_t)(2 * way->jitter + 1)) - way->jitter;
        y[i] = from_y + i * way->step_y + (int)l1l2_rng_below(rng, (uint32_t)(2 * way->jitter + 1)) - way->jitter;
    }
}

/* A plane whose memory ends with its last sample: reading beyond is for the sanitizer to find. */
static L1L2WarpPlane plane_new(L1L2Rng *rng, int width, int height, int components, int padding)
{
    const ptrdiff_t stride = width * components + padding;
    const size_t bytes = (size_t)(stride * (height - 1) + width * components);
    uint8_t *data = malloc(bytes);
    ck_assert_ptr_nonnull(data);
    for (size_t k = 0; k < bytes; k++)
        data[k] = (uint8_t)(l1l2_rng_below(rng, 3) ? l1l2_rng_next(rng) : l1l2_rng_below(rng, 2) * 255);
    return (L1L2WarpPlane){data, stride, width, height, 8, 0};
}

static void plane_free(L1L2WarpPlane *plane)
{
    free((void *)plane->data);
}

static void compare_runs(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x, const int32_t *y,
                         int count, int components)
{
    uint8_t fast[4 * MAX_COUNT + GUARD_BYTES], plain[4 * MAX_COUNT + GUARD_BYTES];
    memset(fast, GUARD_BYTE, sizeof fast);
    memset(plain, GUARD_BYTE, sizeof plain);
    l1l2_warp_u8_run(kernel->taps, components)(src, kernel, x, y, count, fast);
    l1l2_warp_u8_run_plain(kernel->taps, components)(src, kernel, x, y, count, plain);
    for (int i = 0; i < (int)sizeof fast; i++)
        if (fast[i] != plain[i] || (i >= count * components && fast[i] != GUARD_BYTE))
            ck_abort_msg("%d taps, %d components, %dx%d, byte %d of %d: %d, plain %d", kernel->taps, components,
                         src->width, src->height, i, count * components, fast[i], plain[i]);
}

/* The loop test's index is the interpolation. */
START_TEST(every_processor_gives_the_bytes_of_plain_c)
{
    static const int sizes[][2] = {{8, 8}, {9, 13}, {17, 9}, {40, 30}, {120, 90}};
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (int components = 1; components <= 4; components++)
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
            L1L2WarpPlane src = plane_new(&rng, sizes[s][0], sizes[s][1], components, (int)s);
            for (size_t k = 0; k < sizeof walks / sizeof walks[0]; k++)
                for (int round = 0; round < 40; round++) {
                    int32_t x[MAX_COUNT], y[MAX_COUNT];
                    const int count = 1 + (int)l1l2_rng_below(&rng, MAX_COUNT);
                    walk(&walks[k], &rng, src.width, src.height, count, x, y);
                    compare_runs(&src, &kernel, x, y, count, components);
                }
            plane_free(&src);
        }
}
END_TEST

START_TEST(every_phase_gives_the_bytes_of_plain_c)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded(99);
    for (int components = 1; components <= 4; components++) {
        L1L2WarpPlane src = plane_new(&rng, 60, 40, components, 0);
        for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
            int32_t x[16], y[16];
            for (int i = 0; i < 16; i++) {
                x[i] = (10 + i) * ONE + (phase + i) % ONE;
                y[i] = 10 * ONE + (7 * phase + i) % ONE;
            }
            compare_runs(&src, &kernel, x, y, 16, components);
        }
        plane_free(&src);
    }
}
END_TEST

/* Black and white next to each other: the overshoot must be cut off at both ends, not wrap around. */
START_TEST(overshoot_is_cut_off)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    uint8_t rows[16][32], dst[16];
    for (int v = 0; v < 16; v++)
        memset(rows[v], 0, 16), memset(rows[v] + 16, 255, 16);
    const L1L2WarpPlane src = {rows[0], 32, 32, 16, 8, 0};
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase += 31) {
        int32_t x[16], y[16];
        for (int i = 0; i < 16; i++) {
            x[i] = (8 + i) * ONE + phase;
            y[i] = 8 * ONE + phase;
        }
        l1l2_warp_u8_run(kernel.taps, 1)(&src, &kernel, x, y, 16, dst);
        for (int i = 0; i < 16; i++)
            if (i < 7 ? dst[i] > 12 : i > 7 && dst[i] < 243)
                ck_abort_msg("phase %d, sample %d: %d", phase, i, dst[i]);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("warp, 8 bits");
    TCase *tc = tcase_create("u8");
    tcase_add_loop_test(tc, every_processor_gives_the_bytes_of_plain_c, 0, 3);
    tcase_add_loop_test(tc, every_phase_gives_the_bytes_of_plain_c, 0, 3);
    tcase_add_loop_test(tc, overshoot_is_cut_off, 0, 3);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
