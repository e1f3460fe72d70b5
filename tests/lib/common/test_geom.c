/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "common/geom.h"
#include "common/rng.h"

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* Any affine or projective map that is far from singular. */
static L1L2Mat some_map(L1L2Rng *rng)
{
    L1L2Mat m = l1l2_mat_identity();
    for (int i = 0; i < 8; i++)
        m.m[i] += uniform(rng, -0.3, 0.3);
    return m;
}

static L1L2Point some_point(L1L2Rng *rng)
{
    return (L1L2Point){uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5)};
}

static void assert_same_point(L1L2Point a, L1L2Point b, double tolerance)
{
    ck_assert_near(a.x, b.x, tolerance);
    ck_assert_near(a.y, b.y, tolerance);
}

static void assert_same_map(const L1L2Mat *a, const L1L2Mat *b, double tolerance)
{
    for (int i = 0; i < 9; i++)
        ck_assert_near(a->m[i], b->m[i], tolerance);
}

START_TEST(a_similarity_turns_scales_and_shifts)
{
    /* a quarter turn (x towards y, so clockwise to the eye), twice as large, then (3, 5) */
    const L1L2Mat m = l1l2_mat_similarity(0.0, 2.0, 3.0, 5.0);
    assert_same_point(l1l2_mat_apply(&m, (L1L2Point){1.0, 0.0}), (L1L2Point){3.0, 7.0}, 0.0);
    assert_same_point(l1l2_mat_apply(&m, (L1L2Point){0.0, 1.0}), (L1L2Point){1.0, 5.0}, 0.0);
}
END_TEST

START_TEST(the_identity_leaves_points_alone)
{
    L1L2Rng rng = l1l2_rng_seeded(1);
    const L1L2Mat identity = l1l2_mat_identity();
    ck_assert(l1l2_mat_is_identity(&identity));
    for (int i = 0; i < 10; i++) {
        const L1L2Point p = some_point(&rng);
        assert_same_point(l1l2_mat_apply(&identity, p), p, 0.0);
    }
    const L1L2Mat nearly = l1l2_mat_translation(1e-300, 0.0);
    ck_assert(!l1l2_mat_is_identity(&nearly));
}
END_TEST

START_TEST(a_product_applies_its_right_factor_first)
{
    L1L2Rng rng = l1l2_rng_seeded(2);
    for (int i = 0; i < 100; i++) {
        const L1L2Mat a = some_map(&rng), b = some_map(&rng), ab = l1l2_mat_mul(a, b);
        const L1L2Point p = some_point(&rng);
        assert_same_point(l1l2_mat_apply(&ab, p), l1l2_mat_apply(&a, l1l2_mat_apply(&b, p)), 1e-12);
    }
}
END_TEST

START_TEST(an_inverse_undoes_its_map_on_both_sides)
{
    L1L2Rng rng = l1l2_rng_seeded(3);
    const L1L2Mat identity = l1l2_mat_identity();
    for (int i = 0; i < 100; i++) {
        const L1L2Mat m = some_map(&rng);
        L1L2Mat inverse;
        ck_assert(l1l2_mat_inverse(m, &inverse));
        const L1L2Mat left = l1l2_mat_mul(inverse, m), right = l1l2_mat_mul(m, inverse);
        assert_same_map(&left, &identity, 1e-12);
        assert_same_map(&right, &identity, 1e-12);
    }
}
END_TEST

START_TEST(a_map_without_an_inverse_is_reported_and_gives_the_identity)
{
    L1L2Mat none[] = {l1l2_mat_diagonal(0.0, 1.0), {{0}}, l1l2_mat_identity(), l1l2_mat_identity()};
    none[2].m[4] = NAN;
    none[3].m[2] = INFINITY;
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        L1L2Mat inverse = none[i];
        ck_assert(!l1l2_mat_inverse(none[i], &inverse));
        ck_assert(l1l2_mat_is_identity(&inverse));
    }
}
END_TEST

START_TEST(a_rescaled_map_is_the_same_map_in_the_other_unit)
{
    L1L2Rng rng = l1l2_rng_seeded(4);
    const double diagonal = hypot(1920.0, 1080.0);
    for (int i = 0; i < 100; i++) {
        const L1L2Mat m = some_map(&rng), in_pixels = l1l2_mat_rescale(m, diagonal);
        const L1L2Point p = some_point(&rng), q = l1l2_mat_apply(&m, p);
        const L1L2Point q_px = l1l2_mat_apply(&in_pixels, (L1L2Point){p.x * diagonal, p.y * diagonal});
        assert_same_point(q_px, (L1L2Point){q.x * diagonal, q.y * diagonal}, 1e-9);
        const L1L2Mat back = l1l2_mat_rescale(in_pixels, 1.0 / diagonal);
        assert_same_map(&back, &m, 1e-12);
    }
}
END_TEST

START_TEST(the_corner_distance_is_that_of_the_worst_corner)
{
    const L1L2Mat identity = l1l2_mat_identity(), moved = l1l2_mat_translation(3.0, -4.0);
    ck_assert_near(l1l2_mat_corner_distance(&identity, &moved, 320.0, 180.0), 5.0, 1e-12);
    /* Turned about the frame's center, every corner moves by its distance from it; about a corner, the opposite one. */
    const double angle = 0.01, half = hypot(320.0, 180.0);
    const L1L2Mat turn = l1l2_mat_similarity(cos(angle), sin(angle), 0.0, 0.0);
    ck_assert_near(l1l2_mat_corner_distance(&identity, &turn, 320.0, 180.0), 2.0 * sin(0.5 * angle) * half, 1e-12);
    const L1L2Mat about =
        l1l2_mat_mul(l1l2_mat_translation(320.0, 180.0), l1l2_mat_mul(turn, l1l2_mat_translation(-320.0, -180.0)));
    ck_assert_near(l1l2_mat_corner_distance(&identity, &about, 320.0, 180.0), 4.0 * sin(0.5 * angle) * half, 1e-11);
}
END_TEST

START_TEST(one_number_that_is_not_finite_is_noticed)
{
    for (int i = 0; i < 9; i++) {
        L1L2Mat m = l1l2_mat_identity();
        ck_assert(l1l2_mat_is_finite(&m));
        m.m[i] = i % 2 ? NAN : -INFINITY;
        ck_assert(!l1l2_mat_is_finite(&m));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("geom");
    TCase *tc = tcase_create("geom");
    tcase_add_test(tc, a_similarity_turns_scales_and_shifts);
    tcase_add_test(tc, the_identity_leaves_points_alone);
    tcase_add_test(tc, a_product_applies_its_right_factor_first);
    tcase_add_test(tc, an_inverse_undoes_its_map_on_both_sides);
    tcase_add_test(tc, a_map_without_an_inverse_is_reported_and_gives_the_identity);
    tcase_add_test(tc, a_rescaled_map_is_the_same_map_in_the_other_unit);
    tcase_add_test(tc, the_corner_distance_is_that_of_the_worst_corner);
    tcase_add_test(tc, one_number_that_is_not_finite_is_noticed);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
