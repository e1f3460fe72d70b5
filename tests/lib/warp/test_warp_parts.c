/* SPDX-License-Identifier: MIT */
/* The warp's parts alone: kernels, tables of inner loops, coordinate generators. */
#include "checkx.h"
#include "common/rng.h"
#include "warp/coords.h"
#include "warp/kernel.h"
#include "warp/warp_tables.h"

enum { SLACK = L1L2_WARP_RUN_SLACK };

static L1L2WarpFunctions functions, plain; /* of this processor, and plain C */

/* The loop tests' index is the interpolation. */
START_TEST(weights_sum_to_one_in_every_phase)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    ck_assert_int_eq(kernel.taps, 2 * (_i + 1));
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        int sum = 0;
        for (int k = 0; k < kernel.stride; k++)
            sum += kernel.weights[phase * kernel.stride + k];
        ck_assert_int_eq(sum, L1L2_WARP_ONE);
    }
}
END_TEST

START_TEST(phase_0_is_the_sample_itself)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    for (int k = 0; k < kernel.stride; k++)
        ck_assert_int_eq(kernel.weights[k], k == kernel.taps / 2 - 1 ? L1L2_WARP_ONE : 0);
}
END_TEST

START_TEST(weights_are_the_same_from_both_sides)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    for (int phase = 1; phase < L1L2_WARP_PHASES / 2; phase++)
        for (int k = 0; k < kernel.taps; k++)
            ck_assert_int_eq(kernel.weights[phase * kernel.stride + k],
                             kernel.weights[(L1L2_WARP_PHASES - phase) * kernel.stride + kernel.taps - 1 - k]);
}
END_TEST

/* The bounds that all analyses of fixed point start from, with a margin for the rounding of weights. */
START_TEST(weights_stay_within_the_bounds_of_the_fixed_point_analyses)
{
    static const double bounds[] = {[L1L2STAB_INTERPOLATION_BILINEAR] = 1.0,
                                    [L1L2STAB_INTERPOLATION_BICUBIC] = 1.375,
                                    [L1L2STAB_INTERPOLATION_LANCZOS] = 1.55};
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        int positive = 0, negative = 0;
        for (int k = 0; k < kernel.taps; k++) {
            const int weight = kernel.weights[phase * kernel.stride + k];
            *(weight > 0 ? &positive : &negative) += weight;
        }
        ck_assert_int_le(positive - negative, (int)(bounds[_i] * L1L2_WARP_ONE) + kernel.taps);
    }
}
END_TEST

/* Those of direct_u8.h: a row's sum with 6 fractional bits. */
START_TEST(a_row_of_bytes_fits_16_bits_however_it_overshoots)
{
    static L1L2WarpKernel kernel;
    l1l2_warp_kernel_init(&kernel, (L1L2StabInterpolation)_i);
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        int high = 0, low = 0;
        for (int k = 0; k < kernel.taps; k++) {
            const int weight = kernel.weights[phase * kernel.stride + k];
            high += weight > 0 ? weight * 255 : 0;
            low += weight < 0 ? weight * 255 : 0;
        }
        ck_assert_int_le(high >> (L1L2_WARP_WEIGHT_BITS - 6), INT16_MAX);
        ck_assert_int_ge(low >> (L1L2_WARP_WEIGHT_BITS - 6), INT16_MIN);
    }
}
END_TEST

START_TEST(every_table_is_full)
{
    const L1L2WarpFunctions *const tables[] = {&functions, &plain};
    for (int t = 0; t < 2; t++) {
        ck_assert(tables[t]->generators.affine && tables[t]->generators.mesh);
        for (int taps = 2; taps <= 6; taps += 2)
            for (int components = 1; components <= 4; components++) {
                ck_assert(l1l2_warp_scanline_run(tables[t], taps, components) != NULL);
                ck_assert(l1l2_warp_direct_run(tables[t], taps, components, 8) != NULL);
                for (int depth = 10; depth <= 16 && components != 3; depth += 6)
                    ck_assert(l1l2_warp_direct_run(tables[t], taps, components, depth) != NULL);
            }
    }
}
END_TEST

START_TEST(a_plane_of_full_size_has_its_samples_at_pixel_centers)
{
    const L1L2FormatInfo *format = l1l2_image_format_info(L1L2STAB_FORMAT_I420);
    const L1L2WarpGrid grid = l1l2_warp_grid(format, 0, (L1L2StabChromaSite)_i, 640, 360);
    ck_assert_double_eq(grid.first_x, 0.5);
    ck_assert_double_eq(grid.first_y, 0.5);
    ck_assert_double_eq(grid.step_x, 1.0);
    ck_assert_double_eq(grid.step_y, 1.0);
}
END_TEST

START_TEST(halved_planes_have_their_samples_at_their_site)
{
    static const double first[3][2] = {[L1L2STAB_CHROMA_SITE_LEFT] = {0.5, 1.0},
                                       [L1L2STAB_CHROMA_SITE_CENTER] = {1.0, 1.0},
                                       [L1L2STAB_CHROMA_SITE_TOP_LEFT] = {0.5, 0.5}};
    const L1L2StabChromaSite site = (L1L2StabChromaSite)_i;
    const L1L2WarpGrid both = l1l2_warp_grid(l1l2_image_format_info(L1L2STAB_FORMAT_NV12), 1, site, 640, 360);
    ck_assert_double_eq(both.first_x, first[_i][0]);
    ck_assert_double_eq(both.first_y, first[_i][1]);
    ck_assert_double_eq(both.step_x, 2.0);
    ck_assert_double_eq(both.step_y, 2.0);
    const L1L2WarpGrid across = l1l2_warp_grid(l1l2_image_format_info(L1L2STAB_FORMAT_Y42B), 1, site, 640, 360);
    ck_assert_double_eq(across.first_x, first[_i][0]);
    ck_assert_double_eq(across.first_y, 0.5);
    ck_assert_double_eq(across.step_x, 2.0);
    ck_assert_double_eq(across.step_y, 1.0);
}
END_TEST

/* Over the longest row there can be. The rounding of the step adds up to 2^-19 px. */
START_TEST(positions_are_the_maps_to_half_a_phase)
{
    enum { COUNT = 16384 };
    static int32_t x[COUNT + SLACK], y[COUNT + SLACK];
    L1L2Rng rng = l1l2_rng_seeded(1);
    for (int round = 0; round < 50; round++) {
        L1L2WarpAffine affine;
        for (int k = 0; k < 2; k++) {
            affine.x[k] = l1l2_rng_next(&rng) / 2147483648.0 - 1.0;
            affine.y[k] = l1l2_rng_next(&rng) / 2147483648.0 - 1.0;
        }
        affine.x[2] = l1l2_rng_next(&rng) / 1048576.0;
        affine.y[2] = l1l2_rng_next(&rng) / 1048576.0;
        const int v = (int)l1l2_rng_below(&rng, COUNT);
        functions.generators.affine(&affine, 0, v, COUNT, x, y);
        double worst = 0.0;
        for (int u = 0; u < COUNT; u++) {
            const double at_x = affine.x[0] * u + affine.x[1] * v + affine.x[2];
            const double at_y = affine.y[0] * u + affine.y[1] * v + affine.y[2];
            worst = fmax(worst, fabs((double)x[u] / L1L2_WARP_PHASES - at_x));
            worst = fmax(worst, fabs((double)y[u] / L1L2_WARP_PHASES - at_y));
        }
        ck_assert_double_le(worst, 0.5 / L1L2_WARP_PHASES + 2e-6);
    }
}
END_TEST

START_TEST(positions_do_not_depend_on_where_a_run_begins)
{
    enum { COUNT = 1000 };
    static int32_t x[COUNT + SLACK], y[COUNT + SLACK], part_x[COUNT + SLACK], part_y[COUNT + SLACK];
    const L1L2WarpAffine near = {{0.913, -0.017, 3.3}, {0.017, 0.913, -5.1}};
    const L1L2WarpAffine far = {{1e3, -0.017, 3.3}, {0.017, 0.913, 1e7}};
    const L1L2WarpAffine *const maps[] = {&near, &far};
    for (int k = 0; k < 2; k++) {
        functions.generators.affine(maps[k], 0, 77, COUNT, x, y);
        for (int u = 0; u < COUNT; u += 37) {
            functions.generators.affine(maps[k], u, 77, COUNT - u, part_x, part_y);
            ck_assert_mem_eq(part_x, x + u, (size_t)(COUNT - u) * sizeof *x);
            ck_assert_mem_eq(part_y, y + u, (size_t)(COUNT - u) * sizeof *y);
        }
    }
}
END_TEST

START_TEST(positions_far_outside_stay_far_outside)
{
    enum { COUNT = 100 };
    static int32_t x[COUNT + SLACK], y[COUNT + SLACK];
    const L1L2WarpAffine affine = {{1e12, 0.0, 1e12}, {-0.5, 0.0, -1e300}};
    functions.generators.affine(&affine, 0, 3, COUNT, x, y);
    for (int u = 0; u < COUNT; u++) {
        ck_assert_int_gt(x[u] / L1L2_WARP_PHASES, 500000);
        ck_assert_int_lt(y[u] / L1L2_WARP_PHASES, -500000);
    }
}
END_TEST

START_TEST(every_processor_gives_the_positions_of_plain_c)
{
    enum { COUNT = 1000 };
    static int32_t x[COUNT + SLACK], y[COUNT + SLACK], plain_x[COUNT + SLACK], plain_y[COUNT + SLACK];
    L1L2Rng rng = l1l2_rng_seeded(2);
    for (int round = 0; round < 2000; round++) {
        L1L2WarpAffine affine;
        for (int k = 0; k < 3; k++) {
            const double size = k == 2 ? 0.25 : 1073741824.0;
            affine.x[k] = l1l2_rng_next(&rng) / size - 2.0;
            affine.y[k] = l1l2_rng_next(&rng) / size - 2.0;
        }
        const int u = (int)l1l2_rng_below(&rng, 16000), v = (int)l1l2_rng_below(&rng, 16000);
        const int count = 1 + (int)l1l2_rng_below(&rng, COUNT);
        functions.generators.affine(&affine, u, v, count, x, y);
        plain.generators.affine(&affine, u, v, count, plain_x, plain_y);
        ck_assert_mem_eq(x, plain_x, (size_t)count * sizeof *x);
        ck_assert_mem_eq(y, plain_y, (size_t)count * sizeof *y);
    }
}
END_TEST

int main(void)
{
    functions = fast_functions(), plain = plain_functions();
    Suite *suite = suite_create("the warp's parts");
    TCase *tc = tcase_create("kernel");
    tcase_add_loop_test(tc, weights_sum_to_one_in_every_phase, 0, 3);
    tcase_add_loop_test(tc, phase_0_is_the_sample_itself, 0, 3);
    tcase_add_loop_test(tc, weights_are_the_same_from_both_sides, 0, 3);
    tcase_add_loop_test(tc, weights_stay_within_the_bounds_of_the_fixed_point_analyses, 0, 3);
    tcase_add_loop_test(tc, a_row_of_bytes_fits_16_bits_however_it_overshoots, 0, 3);
    suite_add_tcase(suite, tc);
    tc = tcase_create("tables");
    tcase_add_test(tc, every_table_is_full);
    suite_add_tcase(suite, tc);
    tc = tcase_create("coordinates");
    tcase_add_loop_test(tc, a_plane_of_full_size_has_its_samples_at_pixel_centers, 0, 3);
    tcase_add_loop_test(tc, halved_planes_have_their_samples_at_their_site, 0, 3);
    tcase_add_test(tc, positions_are_the_maps_to_half_a_phase);
    tcase_add_test(tc, positions_do_not_depend_on_where_a_run_begins);
    tcase_add_test(tc, every_processor_gives_the_positions_of_plain_c);
    tcase_add_test(tc, positions_far_outside_stay_far_outside);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
