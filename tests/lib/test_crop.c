/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "crop.h"
#include "rng.h"

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* Where the crop window's corners go, from the definition. */
static bool corners_inside(const L1L2Crop *crop, const L1L2Mat *B, double slack)
{
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {crop->ratio * (k & 1 ? crop->half_w : -crop->half_w),
                             crop->ratio * (k & 2 ? crop->half_h : -crop->half_h)};
        const L1L2Point p = l1l2_mat_apply(B, u);
        if (fabs(p.x) > crop->half_w + slack || fabs(p.y) > crop->half_h + slack)
            return false;
    }
    return true;
}

static bool near_identity(const L1L2Mat *B, double slack)
{
    return B->m[0] >= 0.9 - slack && B->m[0] <= 1.1 + slack && fabs(B->m[3]) <= 0.1 + slack;
}

START_TEST(the_frame_has_a_diagonal_of_one)
{
    const L1L2Crop crop = l1l2_crop_make(1920, 1080, 0.8);
    ck_assert_near(2.0 * hypot(crop.half_w, crop.half_h), 1.0, 1e-15);
    ck_assert_near(crop.half_w / crop.half_h, 1920.0 / 1080.0, 1e-12);
}
END_TEST

START_TEST(the_rows_say_what_the_definition_says)
{
    L1L2Rng rng = l1l2_rng_seeded(7);
    int inside = 0;
    for (int i = 0; i < 20000; i++) {
        const L1L2Crop crop = l1l2_crop_make(640, 360, uniform(&rng, 0.5, 0.99));
        const L1L2Mat B = l1l2_mat_similarity(uniform(&rng, 0.85, 1.15), uniform(&rng, -0.12, 0.12),
                                              uniform(&rng, -0.2, 0.2), uniform(&rng, -0.2, 0.2));
        const L1L2Mat C = l1l2_mat_similarity(uniform(&rng, 0.2, 3), uniform(&rng, -2, 2), uniform(&rng, -5, 5),
                                              uniform(&rng, -5, 5));
        const L1L2Mat P = l1l2_mat_mul(C, B);
        double G[L1L2_CROP_ROWS][4], lo[L1L2_CROP_ROWS], hi[L1L2_CROP_ROWS], worst = -1.0;
        l1l2_crop_rows(&crop, &C, G, lo, hi);
        for (int r = 0; r < L1L2_CROP_ROWS; r++) {
            const double v = G[r][0] * P.m[0] + G[r][1] * P.m[3] + G[r][2] * P.m[2] + G[r][3] * P.m[5];
            worst = fmax(worst, fmax(v - hi[r], lo[r] - v));
        }
        ck_assert_near(worst, l1l2_crop_excess(&crop, &B), 1e-9);
        if (worst < -1e-9)
            ck_assert(corners_inside(&crop, &B, 0.0) && near_identity(&B, 0.0));
        if (worst > 1e-9)
            ck_assert(!corners_inside(&crop, &B, 0.0) || !near_identity(&B, 0.0));
        inside += worst < 0.0;
    }
    ck_assert_int_gt(inside, 1000); /* both cases occurred */
    ck_assert_int_lt(inside, 19000);
}
END_TEST

START_TEST(what_is_admitted_is_inside_and_what_was_inside_is_unchanged)
{
    L1L2Rng rng = l1l2_rng_seeded(8);
    for (int i = 0; i < 20000; i++) {
        const L1L2Crop crop = l1l2_crop_make(640, 360, uniform(&rng, 0.5, 0.99));
        const L1L2Mat B = l1l2_mat_similarity(uniform(&rng, 0.3, 2), uniform(&rng, -1, 1), uniform(&rng, -2, 2),
                                              uniform(&rng, -2, 2));
        const L1L2Mat admitted = l1l2_crop_admit(&crop, &B);
        ck_assert(corners_inside(&crop, &admitted, 1e-12) && near_identity(&admitted, 1e-12));
        const L1L2Mat again = l1l2_crop_admit(&crop, &admitted);
        ck_assert_near(l1l2_mat_corner_distance(&admitted, &again, 0.5, 0.5), 0.0, 1e-12);
    }
}
END_TEST

START_TEST(numbers_that_are_none_become_the_identity)
{
    const L1L2Crop crop = l1l2_crop_make(640, 360, 0.8);
    const L1L2Mat B = l1l2_mat_similarity(NAN, 0.0, HUGE_VAL, 0.0);
    const L1L2Mat admitted = l1l2_crop_admit(&crop, &B);
    ck_assert(l1l2_mat_is_identity(&admitted));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("crop");
    TCase *tcase = tcase_create("crop");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_frame_has_a_diagonal_of_one);
    tcase_add_test(tcase, the_rows_say_what_the_definition_says);
    tcase_add_test(tcase, what_is_admitted_is_inside_and_what_was_inside_is_unchanged);
    tcase_add_test(tcase, numbers_that_are_none_become_the_identity);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
