/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "common/rng.h"
#include "path/constraints.h"

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* Where the crop window's corners go, from the definition. */
static bool corners_inside(const L1L2PathCropWindow *crop, const L1L2Mat *B, double slack)
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

/* G2011's proximity, of [a b x; c d y] element by element. A similarity has no skew and no stretch. */
static bool near_identity(const L1L2Mat *B, double slack)
{
    const double a = B->m[0], b = B->m[1], c = B->m[3], d = B->m[4];
    return a >= 0.9 - slack && a <= 1.1 + slack && d >= 0.9 - slack && d <= 1.1 + slack && fabs(b) <= 0.1 + slack &&
           fabs(c) <= 0.1 + slack && fabs(b + c) <= 0.05 + slack && fabs(a - d) <= 0.1 + slack;
}

/* A map of the motion model: [a b x; c d y] around the identity, or around 1.5 of it. */
static L1L2Mat random_map(L1L2Rng *rng, int dim, double zoom, double linear, double shift)
{
    L1L2Mat m = {{zoom, 0.0, 0.0, 0.0, zoom, 0.0, 0.0, 0.0, 1.0}};
    for (int i = 0; i < 6; i++) {
        const double reach = i % 3 == 2 ? shift : linear;
        m.m[i] += uniform(rng, -reach, reach);
    }
    return l1l2_mat_reduce(&m, dim);
}

START_TEST(the_frame_has_a_diagonal_of_one)
{
    const L1L2PathCropWindow crop = l1l2_path_crop_window(1920, 1080, 0.8, 4);
    ck_assert_near(2.0 * hypot(crop.half_w, crop.half_h), 1.0, 1e-15);
    ck_assert_near(crop.half_w / crop.half_h, 1920.0 / 1080.0, 1e-12);
}
END_TEST

START_TEST(the_rows_hold_exactly_where_the_definition_holds)
{
    L1L2Rng rng = l1l2_rng_seeded(7);
    for (int dim = 2; dim <= 6; dim += 2) {
        int inside = 0;
        for (int i = 0; i < 20000; i++) {
            const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, uniform(&rng, 0.5, 0.99), dim);
            const L1L2Mat B = random_map(&rng, dim, 1.0, 0.12, 0.15);
            const L1L2Mat C = random_map(&rng, dim, 1.5, 1.0, 5.0);
            const L1L2Mat P = l1l2_mat_mul(C, B);
            double G[L1L2_PATH_CONSTRAINTS][L1L2_DIM], lo[L1L2_PATH_CONSTRAINTS], hi[L1L2_PATH_CONSTRAINTS];
            double q[L1L2_DIM], worst = -1.0;
            L1L2Mat inverse;
            l1l2_mat_inverse(C, &inverse);
            const double size = 1.0 + fabs(inverse.m[0]) + fabs(inverse.m[1]) + fabs(inverse.m[3]) + fabs(inverse.m[4]);
            if (size > 100.0)
                continue; /* C is nearly singular, so rounding would decide */
            l1l2_mat_to_q(&P, q);
            l1l2_path_constraint_rows(&crop, &C, G, lo, hi);
            for (int r = 0; r < l1l2_path_constraint_count(dim); r++) {
                double v = 0.0;
                for (int j = 0; j < dim; j++)
                    v += G[r][j] * q[j];
                worst = fmax(worst, fmax(v - hi[r], lo[r] - v));
            }
            ck_assert_near(worst, l1l2_path_constraint_excess(&crop, &B), 1e-9);
            if (worst < -1e-9)
                ck_assert(corners_inside(&crop, &B, 0.0) && near_identity(&B, 0.0));
            if (worst > 1e-9)
                ck_assert(!corners_inside(&crop, &B, 0.0) || !near_identity(&B, 0.0));
            inside += worst < 0.0;
        }
        ck_assert_int_gt(inside, 500); /* both cases must have occurred */
        ck_assert_int_lt(inside, 19000);
    }
}
END_TEST

START_TEST(shrinking_moves_a_map_inside_and_leaves_one_that_is_inside_unchanged)
{
    L1L2Rng rng = l1l2_rng_seeded(8);
    for (int dim = 2; dim <= 6; dim += 2)
        for (int i = 0; i < 20000; i++) {
            const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, uniform(&rng, 0.5, 0.99), dim);
            const L1L2Mat B = random_map(&rng, dim, 1.15, 1.0, 2.0);
            const L1L2Mat shrunk = l1l2_path_constraint_shrink(&crop, &B);
            ck_assert(corners_inside(&crop, &shrunk, 1e-12) && near_identity(&shrunk, 1e-12));
            const L1L2Mat again = l1l2_path_constraint_shrink(&crop, &shrunk);
            ck_assert_near(l1l2_mat_corner_distance(&shrunk, &again, 0.5, 0.5), 0.0, 1e-12);
        }
}
END_TEST

START_TEST(a_map_that_is_not_finite_becomes_the_identity)
{
    for (int dim = 2; dim <= 6; dim += 2) {
        const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, 0.8, dim);
        const L1L2Mat B = l1l2_mat_similarity(NAN, 0.0, HUGE_VAL, 0.0);
        const L1L2Mat shrunk = l1l2_path_constraint_shrink(&crop, &B);
        ck_assert(l1l2_mat_is_identity(&shrunk));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("constraints");
    TCase *tcase = tcase_create("constraints");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_frame_has_a_diagonal_of_one);
    tcase_add_test(tcase, the_rows_hold_exactly_where_the_definition_holds);
    tcase_add_test(tcase, shrinking_moves_a_map_inside_and_leaves_one_that_is_inside_unchanged);
    tcase_add_test(tcase, a_map_that_is_not_finite_becomes_the_identity);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
