/* SPDX-License-Identifier: MIT */
/* Samples of 9 to 16 bits: their bytes on this processor against those of plain C, and both against exact arithmetic.
 * Without SIMD, the first two tests compare plain C with itself. */
#include "formats.h"
#include "warp/direct_u16.h"
#include "warp/warp_runs.h"
#include "warp/warp_tables.h"

static L1L2WarpFunctions functions, plain_table; /* of this processor, and plain C */

static const int depths[][2] = {{9, 0}, {10, 0}, {12, 0}, {10, 6}, {12, 4}, {16, 0}}; /* and shift */

enum { DEPTHS = sizeof depths / sizeof depths[0] };

static RunPair pair_of(const L1L2WarpKernel *kernel, int components, const int depth[2])
{
    return (RunPair){l1l2_warp_direct_run(&functions, kernel->taps, components, depth[0]),
                     l1l2_warp_direct_run(&plain_table, kernel->taps, components, depth[0]), components, depth[0],
                     depth[1]};
}

/* The loop tests' index is the interpolation. */
START_TEST(every_processor_gives_the_bytes_of_plain_c)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (int d = 0; d < DEPTHS; d++)
        for (int components = 1; components <= 4; components *= 2) {
            const RunPair pair = pair_of(&kernel, components, depths[d]);
            compare_on_all_walks(&pair, &kernel, &rng);
        }
}
END_TEST

START_TEST(every_phase_gives_the_bytes_of_plain_c)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded(99);
    for (int d = 0; d < DEPTHS; d++)
        for (int components = 1; components <= 4; components *= 2) {
            const RunPair pair = pair_of(&kernel, components, depths[d]);
            compare_in_all_phases(&pair, &kernel, &rng);
        }
}
END_TEST

START_TEST(bits_above_the_depth_do_no_harm)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (int d = 0; d < DEPTHS; d++) {
        const RunPair pair = pair_of(&kernel, 1, depths[d]), noise = {.components = 1, .depth = 16};
        L1L2WarpPlane src = plane_new(&rng, &noise, 100, 40, 0);
        src.depth = pair.depth;
        src.shift = pair.shift;
        for (int v = 0; v < 30; v++) {
            int32_t x[64], y[64];
            uint16_t dst[64];
            for (int i = 0; i < 64; i++) {
                x[i] = 5 * ONE + i * (ONE + 7);
                y[i] = (5 + v) * ONE + 11 * i;
            }
            compare_runs(&pair, &src, &kernel, x, y, 64);
            pair.fast(&src, &kernel, x, y, 64, (uint8_t *)dst);
            for (int i = 0; i < 64; i++)
                ck_assert_int_le(dst[i] >> pair.shift, (1 << pair.depth) - 1);
        }
        plane_free(&src);
    }
}
END_TEST

static int level(const uint8_t *at, int shift)
{
    const int value = at[0] | at[1] << 8;
    ck_assert_int_eq(value & ((1 << shift) - 1), 0);
    return value >> shift;
}

/* The sum over the taps in doubles, with the kernel's own weights. All taps must be inside. */
static double exact(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, int32_t x, int32_t y)
{
    const int16_t *wx = kernel->weights + x % ONE * kernel->stride, *wy = kernel->weights + y % ONE * kernel->stride;
    const int lead = kernel->taps / 2 - 1;
    double sum = 0.0;
    for (int r = 0; r < kernel->taps; r++)
        for (int k = 0; k < kernel->taps; k++)
            sum += (double)wx[k] * wy[r] *
                   level(src->data + (y / ONE - lead + r) * src->stride + 2 * (x / ONE - lead + k), src->shift);
    sum /= (double)L1L2_WARP_ONE * L1L2_WARP_ONE;
    return fmin(fmax(sum, 0.0), (1 << src->depth) - 1);
}

/* Rounding alone costs at most 1/2, and half-way values may go either way. */
START_TEST(the_arithmetic_is_exact_to_a_small_part_of_a_level)
{
    if (format_left_out(L1L2STAB_FORMAT_GRAY16_LE))
        return;
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded(7);
    for (int d = 0; d < DEPTHS; d++) {
        const RunPair pair = pair_of(&kernel, 1, depths[d]);
        L1L2WarpPlane src = plane_new(&rng, &pair, 60, 40, 0);
        /* Cutting a row takes off up to one unit of its fraction, of which half is added again. The sum of the column's
         * |weights|, at most 1.55, multiplies the error. */
        const double cut = depths[d][0] > L1L2_WARP_DIRECT_U16_NARROW ? 0.02 : 0.78 / (1 << (14 - depths[d][0]));
        double mean = 0.0;
        for (int round = 0; round < 4000; round++) {
            const int32_t x = 3 * ONE + (int)l1l2_rng_below(&rng, 54 * ONE);
            const int32_t y = 3 * ONE + (int)l1l2_rng_below(&rng, 34 * ONE);
            uint8_t dst[2];
            pair.fast(&src, &kernel, &x, &y, 1, dst);
            const double error = level(dst, src.shift) - exact(&src, &kernel, x, y);
            if (fabs(error) > 0.5 + cut)
                ck_abort_msg("%d bits at %d, %d: %f off", src.depth, x, y, error);
            mean += error / 4000;
        }
        ck_assert_near(mean, 0.0, 0.02);
        plane_free(&src);
    }
}
END_TEST

/* Black beside white: the overshoot must be cut off at both ends of the depth, not wrap around. */
START_TEST(overshoot_is_cut_off)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    for (int d = 0; d < DEPTHS; d++) {
        const RunPair pair = pair_of(&kernel, 1, depths[d]);
        const int max = (1 << pair.depth) - 1;
        uint16_t rows[16][32], dst[16];
        for (int v = 0; v < 16; v++)
            for (int u = 0; u < 32; u++)
                rows[v][u] = u < 16 ? 0 : (uint16_t)(max << pair.shift);
        const L1L2WarpPlane src = {(const uint8_t *)rows, 64, 32, 16, pair.depth, pair.shift};
        for (int phase = 0; phase < L1L2_WARP_PHASES; phase += 31) {
            int32_t x[16], y[16];
            for (int i = 0; i < 16; i++) {
                x[i] = (8 + i) * ONE + phase;
                y[i] = 8 * ONE + phase;
            }
            pair.fast(&src, &kernel, x, y, 16, (uint8_t *)dst);
            for (int i = 0; i < 16; i++)
                if (i < 7 ? dst[i] >> pair.shift > max / 20 : i > 7 && dst[i] >> pair.shift < max - max / 20)
                    ck_abort_msg("%d bits, phase %d, sample %d: %d", pair.depth, phase, i, dst[i]);
        }
    }
}
END_TEST

START_TEST(phase_0_copies)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    for (int d = 0; d < DEPTHS; d++) {
        const RunPair pair = pair_of(&kernel, 1, depths[d]);
        for (int first = 0; first < 1 << pair.depth; first += 32) {
            uint16_t row[32], dst[32];
            int32_t x[32], y[32] = {0};
            for (int u = 0; u < 32; u++) {
                row[u] = (uint16_t)((first + u) << pair.shift);
                x[u] = u * ONE;
            }
            const L1L2WarpPlane src = {(const uint8_t *)row, 64, 32, 1, pair.depth, pair.shift};
            pair.fast(&src, &kernel, x, y, 32, (uint8_t *)dst);
            ck_assert_mem_eq(dst, row, sizeof row);
        }
    }
}
END_TEST

int main(void)
{
    functions = fast_functions(), plain_table = plain_functions();
    Suite *suite = suite_create("warp, 16 bits");
    TCase *tc = tcase_create("u16");
    tcase_add_loop_test(tc, every_processor_gives_the_bytes_of_plain_c, 0, 3);
    tcase_add_loop_test(tc, every_phase_gives_the_bytes_of_plain_c, 0, 3);
    tcase_add_loop_test(tc, bits_above_the_depth_do_no_harm, 0, 3);
    tcase_add_loop_test(tc, the_arithmetic_is_exact_to_a_small_part_of_a_level, 0, 3);
    tcase_add_loop_test(tc, overshoot_is_cut_off, 0, 3);
    tcase_add_loop_test(tc, phase_0_copies, 0, 3);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
