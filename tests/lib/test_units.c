/* SPDX-License-Identifier: MIT */
/* Motions cross the public border in both directions without a change of a bit. */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "units.h"

static double uniform(L1L2Rng *rng, double low, double high)
{
    const double upper = l1l2_rng_next(rng), lower = l1l2_rng_next(rng);
    return low + (high - low) * (upper + lower / 4294967296.0) / 4294967296.0;
}

static const double sizes[][2] = {{16, 16},     {160, 96},    {640, 360},    {641, 359},
                                  {1920, 1080}, {3840, 2160}, {16384, 16384}};

START_TEST(a_reported_motion_given_back_is_the_same_to_the_bit)
{
    L1L2Rng rng = l1l2_rng_seeded(1);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int k = 0; k < 100000; k++) {
            const double diagonal_px = hypot(sizes[i][0], sizes[i][1]), reach = pow(10.0, uniform(&rng, -9.0, 1.0));
            const double x = uniform(&rng, -reach, reach), y = uniform(&rng, -reach, reach);
            const L1L2Mat measured = l1l2_mat_similarity(uniform(&rng, 0.8, 1.25), uniform(&rng, -0.2, 0.2), x, y);
            const L1L2Mat F = l1l2_units_exact_motion(&measured, diagonal_px);
            ck_assert_double_le(fabs(F.m[2] - x), 1e-15 * fabs(x));
            double px[9], again[9];
            l1l2_units_export_motion(&F, diagonal_px, px);
            const L1L2Mat back = l1l2_units_import_motion(px, diagonal_px);
            ck_assert_mem_eq(back.m, F.m, sizeof F.m);
            l1l2_units_export_motion(&back, diagonal_px, again); /* so a file of motions stays the same, too */
            ck_assert_mem_eq(again, px, sizeof px);
        }
}
END_TEST

START_TEST(a_motion_that_was_given_is_reported_as_it_was_given_but_for_the_last_places)
{
    L1L2Rng rng = l1l2_rng_seeded(2);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int k = 0; k < 10000; k++) {
            const double diagonal_px = hypot(sizes[i][0], sizes[i][1]);
            const double given[9] = {1, 0, uniform(&rng, -1e3, 1e3), 0, 1, uniform(&rng, -1, 1), 0, 0, 1};
            const L1L2Mat F = l1l2_units_import_motion(given, diagonal_px);
            double reported[9];
            l1l2_units_export_motion(&F, diagonal_px, reported);
            for (int j = 0; j < 9; j++)
                ck_assert_double_le(fabs(reported[j] - given[j]), 1e-15 * fabs(given[j]));
            const L1L2Mat back = l1l2_units_import_motion(reported, diagonal_px);
            ck_assert_mem_eq(back.m, F.m, sizeof F.m);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("units");
    TCase *tcase = tcase_create("units");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, a_reported_motion_given_back_is_the_same_to_the_bit);
    tcase_add_test(tcase, a_motion_that_was_given_is_reported_as_it_was_given_but_for_the_last_places);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
