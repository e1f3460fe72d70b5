/* SPDX-License-Identifier: MIT */
/* What this processor runs against plain C: the same bytes, for any positions at all. Where that is plain C itself, the
 * first two tests compare it with itself. */
#include "warp_runs.h"
#include "warp_u8.h"

static RunPair pair_of(const L1L2WarpKernel *kernel, int components)
{
    return (RunPair){l1l2_warp_u8_run(kernel->taps, components), l1l2_warp_u8_run_plain(kernel->taps, components),
                     components, 8, 0};
}

/* The loop test's index is the interpolation. */
START_TEST(every_processor_gives_the_bytes_of_plain_c)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (int components = 1; components <= 4; components++) {
        const RunPair pair = pair_of(&kernel, components);
        compare_on_all_walks(&pair, &kernel, &rng);
    }
}
END_TEST

START_TEST(every_phase_gives_the_bytes_of_plain_c)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    L1L2Rng rng = l1l2_rng_seeded(99);
    for (int components = 1; components <= 4; components++) {
        const RunPair pair = pair_of(&kernel, components);
        compare_in_all_phases(&pair, &kernel, &rng);
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
