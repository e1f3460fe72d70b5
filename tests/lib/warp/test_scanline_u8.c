/* SPDX-License-Identifier: MIT */
/* Scanlines: their positions, and their bytes on this processor against those of plain C. Without SIMD, the tests of
 * bytes compare plain C with itself. */
#include <math.h>
#include <sys/mman.h>

#include "warp/warp_runs.h"
#include "warp/warp_tables.h"

static L1L2WarpFunctions functions, plain_table; /* of this processor, and plain C */

static const double UNIT = 1 << L1L2_WARP_STEP_BITS;

static double between(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* A scanline that begins inside or a little outside the plane. It has pieces of random lengths: one, as for an affine
 * map, or several, as for a mesh. */
static L1L2WarpScanline random_scanline(L1L2Rng *rng, const L1L2WarpPlane *src, int taps, int pieces)
{
    L1L2WarpScanline scanline = {.count = 1 + (int)l1l2_rng_below(rng, MAX_COUNT)};
    int64_t at = (int64_t)((taps / 2 - 1 + between(rng, 0.0, 1.0)) * UNIT);
    for (int i = 0; i < scanline.count && scanline.along_pieces < pieces; scanline.along_pieces++) {
        L1L2WarpPiece *piece = &scanline.along[scanline.along_pieces];
        *piece = (L1L2WarpPiece){at, (int32_t)(between(rng, 0.0, 4.0 / 3.0) * UNIT), i};
        const int length = 1 + (int)l1l2_rng_below(rng, 40);
        at += (int64_t)length * piece->step;
        i += length;
    }
    const L1L2WarpPiece *last = &scanline.along[scanline.along_pieces - 1];
    scanline.columns = (l1l2_warp_piece_position(last, scanline.count - 1) >> L1L2_WARP_PHASE_BITS) + taps / 2 + 1;
    scanline.first = (int)l1l2_rng_below(rng, (uint32_t)src->width + 20) - 10;
    at = (int64_t)(between(rng, -10.0, src->height + 10.0) * UNIT);
    const int entries = taps == 2 ? scanline.count : scanline.columns;
    for (int i = 0; i < entries && scanline.down_pieces < pieces; scanline.down_pieces++) {
        const int k = scanline.down_pieces;
        const double slope = between(rng, -0.5, 0.5);
        const int32_t step = (int32_t)((l1l2_rng_below(rng, 2) ? slope : slope / 16) * UNIT);
        scanline.down[k] = (L1L2WarpPiece){at, step, i};
        const int next = taps > 2 ? i + 1 + (int)l1l2_rng_below(rng, 40)
                       : k + 1 < scanline.along_pieces ? scanline.along[k + 1].from : scanline.count;
        at += (int64_t)(next - i) * step;
        i = next;
    }
    return scanline;
}

static void compare_scanlines(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const L1L2WarpScanline *scanline,
                          int components)
{
    uint8_t fast[4 * L1L2_WARP_RUN_SAMPLES + GUARD_BYTES], plain[4 * L1L2_WARP_RUN_SAMPLES + GUARD_BYTES];
    memset(fast, GUARD_BYTE, sizeof fast);
    memset(plain, GUARD_BYTE, sizeof plain);
    l1l2_warp_scanline_run(&functions, kernel->taps, components)(src, kernel, scanline, fast);
    l1l2_warp_scanline_run(&plain_table, kernel->taps, components)(src, kernel, scanline, plain);
    for (int i = 0; i < (int)sizeof fast; i++)
        if (fast[i] != plain[i] || (i >= scanline->count * components && fast[i] != GUARD_BYTE))
            ck_abort_msg("%d taps, %d components, %dx%d from column %d, byte %d of %d: %d, plain %d", kernel->taps,
                         components, src->width, src->height, scanline->first, i, scanline->count * components, fast[i],
                         plain[i]);
}

/* The loop tests' index is the interpolation. */
START_TEST(every_processor_gives_the_bytes_of_plain_c)
{
    static const int sizes[][2] = {{8, 8}, {9, 13}, {17, 9}, {40, 30}, {120, 90}};
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (int components = 1; components <= 4; components++)
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
            const RunPair samples = {.components = components, .depth = 8};
            L1L2WarpPlane src = plane_new(&rng, &samples, sizes[s][0], sizes[s][1], (int)s);
            for (int round = 0; round < 400; round++) {
                const L1L2WarpScanline scanline = random_scanline(&rng, &src, kernel.taps, 1 + round % 2 * 5);
                compare_scanlines(&src, &kernel, &scanline, components);
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
    const RunPair samples = {.components = 1, .depth = 8};
    L1L2WarpPlane src = plane_new(&rng, &samples, 90, 40, 0);
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        const L1L2WarpAffine affine = {{1, 0, 10 + phase / 1024.0}, {0, 1, 10 + (7 * phase) % 1024 / 1024.0}};
        L1L2WarpScanline scanline;
        ck_assert(l1l2_warp_affine_scanline(&affine, kernel.taps, 0, 0, 64, &scanline));
        compare_scanlines(&src, &kernel, &scanline, 1);
    }
    plane_free(&src);
}
END_TEST

/* Black beside white: the overshoot must be cut off at both ends of the range, not wrap around. */
START_TEST(overshoot_is_cut_off)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    uint8_t rows[16][64], dst[16];
    for (int v = 0; v < 16; v++)
        memset(rows[v], 0, 16), memset(rows[v] + 16, 255, 48);
    const L1L2WarpPlane src = {rows[0], 64, 64, 16, 8, 0};
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase += 31) {
        const L1L2WarpAffine affine = {{1, 0, 8 + phase / 1024.0}, {0, 1, 8 + phase / 1024.0}};
        L1L2WarpScanline scanline;
        ck_assert(l1l2_warp_affine_scanline(&affine, kernel.taps, 0, 0, 16, &scanline));
        l1l2_warp_scanline_run(&functions, kernel.taps, 1)(&src, &kernel, &scanline, dst);
        for (int i = 0; i < 16; i++)
            if (i < 7 ? dst[i] > 12 : i > 7 && dst[i] < 243)
                ck_abort_msg("phase %d, sample %d: %d", phase, i, dst[i]);
    }
}
END_TEST

/* Scanlines far left of, right of, above and below a plane in the lowest memory that a process may have. A pointer to
 * taps left of or above it would lie below address 0: the sanitizer reports that it wraps around. */
START_TEST(no_pointer_is_formed_to_taps_outside_the_plane)
{
    enum { WIDTH = 90, HEIGHT = 40, FAR_OUT = 100000 };
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    uint8_t *const lowest = (uint8_t *)0x10000;
    uint8_t *const memory =
        mmap(lowest, WIDTH * HEIGHT * 4, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ck_assert(memory != MAP_FAILED);
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
        memory[i] = (uint8_t)(7 * i);
    for (int components = 1; components <= 4; components++) {
        const L1L2WarpPlane src = {memory, WIDTH * components, WIDTH, HEIGHT, 8, 0};
        static const double places[][2] = {{-FAR_OUT, 10}, {FAR_OUT, 10}, {10, -FAR_OUT}, {10, FAR_OUT},
                                           {-FAR_OUT, -FAR_OUT}, {0, 0}, {-20, 0}, {WIDTH - 20, HEIGHT - 1}};
        for (size_t k = 0; k < sizeof places / sizeof places[0]; k++)
            for (int turn = -1; turn <= 1; turn++) {
                const L1L2WarpAffine affine = {{0.9, 0, places[k][0]}, {0.1 * turn, 1, places[k][1]}};
                L1L2WarpScanline scanline;
                ck_assert(l1l2_warp_affine_scanline(&affine, kernel.taps, 0, 0, 64, &scanline));
                compare_scanlines(&src, &kernel, &scanline, components);
            }
    }
    munmap(memory, WIDTH * HEIGHT * 4);
}
END_TEST

/* Not fmax(): in these loops gcc 12 for aarch64 fails with an internal error at -O3. */
static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Along, and down: at the row where the map crosses the column. */
START_TEST(the_scanline_of_an_affine_map_has_its_positions_to_half_a_phase)
{
    enum { COUNT = L1L2_WARP_RUN_SAMPLES };
    L1L2Rng rng = l1l2_rng_seeded(4);
    for (int round = 0; round < 2000; round++) {
        const double step = between(&rng, 0.01, 4.0 / 3.0), slope = between(&rng, -0.5, 0.5);
        const L1L2WarpAffine affine = {{step, between(&rng, -0.2, 0.2), between(&rng, -4000, 4000)},
                                       {slope * step, between(&rng, 0.5, 1.3), between(&rng, -4000, 4000)}};
        const int u = (int)l1l2_rng_below(&rng, 16000), v = (int)l1l2_rng_below(&rng, 16000);
        L1L2WarpScanline scanline;
        ck_assert(l1l2_warp_affine_scanline(&affine, 4, u, v, COUNT, &scanline));
        ck_assert_int_eq(scanline.along_pieces, 1);
        ck_assert_int_eq(scanline.down_pieces, 1);
        ck_assert_int_le(scanline.columns, L1L2_WARP_SCANLINE_COLUMNS);
        const double start = affine.x[1] * v + affine.x[2];
        double worst = 0.0;
        for (int i = 0; i < COUNT; i++) {
            const double x = scanline.first + (double)l1l2_warp_piece_position(scanline.along, i) / L1L2_WARP_PHASES;
            worst = larger(worst, fabs(x - (step * (u + i) + start)));
            if (floor(x) - 1 < scanline.first || floor(x) + 2 >= scanline.first + scanline.columns)
                ck_abort_msg("sample %d at %f: columns from %d, %d", i, x, scanline.first, scanline.columns);
        }
        for (int i = 0; i < scanline.columns; i++) {
            const double y = (double)l1l2_warp_piece_position(scanline.down, i) / L1L2_WARP_PHASES;
            const double at = (scanline.first + i - start) / step;
            worst = larger(worst, fabs(y - (affine.y[0] * at + affine.y[1] * v + affine.y[2])));
        }
        ck_assert_double_le(worst, 0.5 / L1L2_WARP_PHASES + 2e-6);
    }
}
END_TEST

START_TEST(maps_that_zoom_out_or_turn_far_have_no_scanline)
{
    static const L1L2WarpAffine maps[] = {
        {{1.4, 0, 5}, {0, 1.4, 5}},         {{-1, 0, 50}, {0, -1, 50}},     {{0, -1, 50}, {1, 0, 0}},
        {{0.9, -0.5, 5}, {0.5, 0.9, 5}},    {{NAN, 0, 5}, {0, 1, 5}},       {{1, 0, 1e12}, {0, 1, 5}},
        {{1, 0, 5}, {0, 1, NAN}},           {{1, 0, 5}, {INFINITY, 1, 5}},  {{1, 0, 5}, {0, 1, -INFINITY}},
        {{0, 0, 0}, {0, 0, 0}},
    };
    L1L2WarpScanline scanline;
    for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++)
        ck_assert(!l1l2_warp_affine_scanline(&maps[k], 4, 0, 0, 16, &scanline));
}
END_TEST

int main(void)
{
    functions = fast_functions(), plain_table = plain_functions();
    Suite *suite = suite_create("warp along scanlines");
    TCase *tc = tcase_create("scanline");
    tcase_add_loop_test(tc, every_processor_gives_the_bytes_of_plain_c, 0, 3);
    tcase_add_loop_test(tc, every_phase_gives_the_bytes_of_plain_c, 0, 3);
    tcase_add_loop_test(tc, overshoot_is_cut_off, 0, 3);
    tcase_add_loop_test(tc, no_pointer_is_formed_to_taps_outside_the_plane, 0, 3);
    tcase_add_test(tc, the_scanline_of_an_affine_map_has_its_positions_to_half_a_phase);
    tcase_add_test(tc, maps_that_zoom_out_or_turn_far_have_no_scanline);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
