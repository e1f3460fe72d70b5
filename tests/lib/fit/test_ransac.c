/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "fit/ransac.h"

enum {
    COUNT = 200,
    TRANSLATION = L1L2STAB_MOTION_MODEL_TRANSLATION,
    SIMILARITY = L1L2STAB_MOTION_MODEL_SIMILARITY,
    AFFINE = L1L2STAB_MOTION_MODEL_AFFINE
};

/* About two pixels in a picture of 640x360, in diagonals. */
static const double threshold = 2.0 / 734.0;

static L1L2Rng rng;
static L1L2Pair pairs[COUNT];
static bool inlier[COUNT];

static double uniform(double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(&rng) / 4294967296.0);
}

/* Nearly normal: the sum of twelve uniform numbers. */
static double normal(double sigma)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += uniform(0.0, 1.0);
    return sigma * sum;
}

static L1L2Point some_point(void)
{
    return (L1L2Point){uniform(-0.43, 0.43), uniform(-0.24, 0.24)};
}

/* COUNT pairs. The last ones are outliers: they go anywhere but to where the map takes them. */
static void make_pairs(const L1L2Mat *map, double sigma, double outlier_share)
{
    rng = l1l2_rng_seeded(5);
    const int good = (int)lround(COUNT * (1.0 - outlier_share));
    for (int i = 0; i < COUNT; i++) {
        pairs[i].from = some_point();
        pairs[i].to = l1l2_mat_apply(map, pairs[i].from);
        pairs[i].to.x += normal(sigma);
        pairs[i].to.y += normal(sigma);
        if (i < good)
            continue;
        const double angle = uniform(0.0, 6.283), distance = uniform(5.0 * threshold, 0.2);
        pairs[i].to.x += distance * cos(angle);
        pairs[i].to.y += distance * sin(angle);
    }
}

/* The error of the map at the corners of the frame. */
static double error_of(const L1L2Mat *fit, const L1L2Mat *truth)
{
    return l1l2_mat_corner_distance(fit, truth, 0.436, 0.245);
}

/* The pairs without weights. */
static L1L2TrackSet tracks_of(int count)
{
    return (L1L2TrackSet){.pairs = pairs, .count = count, .threshold = threshold, .rng = &rng};
}

static int ransac(int model, int count, L1L2Mat *fit)
{
    const L1L2TrackSet tracks = tracks_of(count);
    return l1l2_ransac((L1L2StabMotionModel)model, &tracks, inlier, fit);
}

static L1L2Mat some_similarity(void)
{
    return l1l2_mat_similarity(1.03 * cos(0.05), 1.03 * sin(0.05), 0.02, -0.03);
}

START_TEST(a_similarity_is_recovered_exactly_without_noise)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit;
    make_pairs(&truth, 0.0, 0.0);
    ck_assert_int_eq(ransac(SIMILARITY, COUNT, &fit), COUNT);
    ck_assert_near(error_of(&fit, &truth), 0.0, 1e-14);
    ck_assert_int_eq(ransac(SIMILARITY, 2, &fit), 2);
    ck_assert_near(error_of(&fit, &truth), 0.0, 1e-13);
}
END_TEST

START_TEST(a_similarity_is_recovered_with_40_percent_outliers)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit;
    make_pairs(&truth, 0.1 * threshold, 0.4);
    ck_assert_int_eq(ransac(SIMILARITY, COUNT, &fit), COUNT * 6 / 10);
    for (int i = 0; i < COUNT; i++)
        ck_assert_msg(inlier[i] == (i < COUNT * 6 / 10), "pair %d", i);
    /* The mean's error is a tenth of a threshold / sqrt(120), the corners' about three times that. */
    ck_assert_near(error_of(&fit, &truth), 0.0, 0.06 * threshold);
}
END_TEST

START_TEST(a_similarity_is_recovered_with_70_percent_outliers)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit;
    make_pairs(&truth, 0.1 * threshold, 0.7);
    const int inliers = ransac(SIMILARITY, COUNT, &fit);
    ck_assert_int_ge(inliers, COUNT * 3 / 10);
    ck_assert_near(error_of(&fit, &truth), 0.0, 0.1 * threshold);
}
END_TEST

START_TEST(least_squares_is_better_than_any_two_pairs)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit;
    make_pairs(&truth, 0.25 * threshold, 0.0);
    ck_assert_int_ge(ransac(SIMILARITY, COUNT, &fit), COUNT * 95 / 100);
    ck_assert_near(error_of(&fit, &truth), 0.0, 0.1 * threshold);
}
END_TEST

START_TEST(the_larger_of_two_motions_wins)
{
    const L1L2Mat large = some_similarity(), small = l1l2_mat_similarity(1.0, -0.01, -0.04, 0.02);
    L1L2Mat fit;
    make_pairs(&large, 0.1 * threshold, 0.0);
    for (int i = 0; i < COUNT * 45 / 100; i++)
        pairs[i].to = l1l2_mat_apply(&small, pairs[i].from);
    ck_assert_int_ge(ransac(SIMILARITY, COUNT, &fit), COUNT * 55 / 100);
    ck_assert_near(error_of(&fit, &large), 0.0, 0.3 * threshold);
}
END_TEST

START_TEST(a_translation_is_recovered_with_60_percent_outliers)
{
    const L1L2Mat truth = l1l2_mat_translation(0.05, -0.02);
    L1L2Mat fit;
    make_pairs(&truth, 0.1 * threshold, 0.6);
    ck_assert_int_ge(ransac(TRANSLATION, COUNT, &fit), COUNT * 4 / 10);
    ck_assert_near(error_of(&fit, &truth), 0.0, 0.05 * threshold);
    ck_assert(fit.m[0] == 1.0 && fit.m[3] == 0.0);
    ck_assert_int_eq(ransac(TRANSLATION, 1, &fit), 1);
}
END_TEST

START_TEST(an_affine_map_is_recovered_with_40_percent_outliers)
{
    const L1L2Mat truth = {{1.04, 0.03, 0.02, -0.01, 0.97, -0.03, 0.0, 0.0, 1.0}};
    L1L2Mat fit;
    make_pairs(&truth, 0.0, 0.0);
    ck_assert_int_eq(ransac(AFFINE, COUNT, &fit), COUNT);
    ck_assert_near(error_of(&fit, &truth), 0.0, 1e-14);
    make_pairs(&truth, 0.1 * threshold, 0.4);
    ck_assert_int_eq(ransac(AFFINE, COUNT, &fit), COUNT * 6 / 10);
    ck_assert_near(error_of(&fit, &truth), 0.0, 0.08 * threshold);
    for (int i = 0; i < COUNT; i++) /* all in one line */
        pairs[i].from = pairs[i].to = (L1L2Point){0.004 * i - 0.4, 0.002 * i - 0.2};
    ck_assert_int_eq(ransac(AFFINE, COUNT, &fit), 0);
}
END_TEST

START_TEST(consensus_weights_decide_which_of_two_motions_wins)
{
    const L1L2Mat large = some_similarity(), small = l1l2_mat_similarity(1.0, -0.01, -0.04, 0.02);
    double weights[COUNT];
    L1L2Mat fit;
    make_pairs(&large, 0.1 * threshold, 0.0);
    for (int i = 0; i < COUNT; i++) {
        weights[i] = i < COUNT / 4 ? 4.0 : 1.0;
        if (i < COUNT / 4)
            pairs[i].to = l1l2_mat_apply(&small, pairs[i].from);
    }
    L1L2TrackSet tracks = tracks_of(COUNT);
    tracks.consensus_weights = weights;
    l1l2_ransac(L1L2STAB_MOTION_MODEL_SIMILARITY, &tracks, inlier, &fit);
    ck_assert_near(error_of(&fit, &small), 0.0, 0.3 * threshold);
    ransac(SIMILARITY, COUNT, &fit);
    ck_assert_near(error_of(&fit, &large), 0.0, 0.3 * threshold);
}
END_TEST

START_TEST(the_unit_does_not_matter)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit, fit_px;
    make_pairs(&truth, 0.2 * threshold, 0.3);
    L1L2Rng again = rng = l1l2_rng_seeded(1);
    const int inliers = ransac(SIMILARITY, COUNT, &fit);
    for (int i = 0; i < COUNT; i++)
        pairs[i] = (L1L2Pair){{pairs[i].from.x * 1024.0, pairs[i].from.y * 1024.0},
                              {pairs[i].to.x * 1024.0, pairs[i].to.y * 1024.0}};
    L1L2TrackSet tracks = tracks_of(COUNT);
    tracks.threshold *= 1024.0;
    tracks.rng = &again;
    const int again_inliers = l1l2_ransac(L1L2STAB_MOTION_MODEL_SIMILARITY, &tracks, inlier, &fit_px);
    ck_assert_int_eq(again_inliers, inliers);
    const L1L2Mat back = l1l2_mat_rescale(fit_px, 1.0 / 1024.0);
    ck_assert_near(error_of(&fit, &back), 0.0, 1e-14);
}
END_TEST

START_TEST(equal_seeds_give_equal_bits)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit[2];
    bool flags[2][COUNT];
    make_pairs(&truth, 0.3 * threshold, 0.5);
    for (int i = 0; i < 2; i++) {
        rng = l1l2_rng_seeded(9);
        const L1L2TrackSet tracks = tracks_of(COUNT);
        l1l2_ransac(L1L2STAB_MOTION_MODEL_SIMILARITY, &tracks, flags[i], &fit[i]);
    }
    ck_assert_mem_eq(&fit[0], &fit[1], sizeof fit[0]);
    ck_assert_mem_eq(flags[0], flags[1], sizeof flags[0]);
}
END_TEST

static void assert_no_similarity(int count)
{
    L1L2Mat fit;
    memset(inlier, true, sizeof inlier);
    ck_assert_int_eq(ransac(SIMILARITY, count, &fit), 0);
    ck_assert(l1l2_mat_is_identity(&fit));
    for (int i = 0; i < count; i++)
        ck_assert(!inlier[i]);
}

START_TEST(the_identity_is_returned_if_no_similarity_exists)
{
    const L1L2Mat identity = l1l2_mat_identity();
    make_pairs(&identity, 0.0, 0.0);
    assert_no_similarity(0);
    assert_no_similarity(1);
    for (int i = 0; i < COUNT; i++) /* all nearly in one place */
        pairs[i].from = pairs[i].to = (L1L2Point){0.1 + 0.1 * threshold * (i % 7), 0.1};
    assert_no_similarity(COUNT);
    for (int i = 0; i < COUNT; i++)
        pairs[i].to.x = i % 2 ? NAN : INFINITY;
    assert_no_similarity(COUNT);
}
END_TEST

START_TEST(pairs_that_are_not_finite_are_outliers)
{
    const L1L2Mat truth = some_similarity();
    L1L2Mat fit;
    make_pairs(&truth, 0.0, 0.0);
    for (int i = 0; i < COUNT; i += 3)
        pairs[i].to.y = i % 2 ? NAN : INFINITY;
    ck_assert_int_eq(ransac(SIMILARITY, COUNT, &fit), COUNT - (COUNT + 2) / 3);
    ck_assert_near(error_of(&fit, &truth), 0.0, 1e-14);
    pairs[0] = (L1L2Pair){{0.0, 0.0}, {NAN, 0.0}};
    ck_assert_int_eq(ransac(TRANSLATION, 1, &fit), 0);
    ck_assert(l1l2_mat_is_identity(&fit));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("ransac");
    TCase *tc = tcase_create("ransac");
    tcase_add_test(tc, a_similarity_is_recovered_exactly_without_noise);
    tcase_add_test(tc, a_similarity_is_recovered_with_40_percent_outliers);
    tcase_add_test(tc, a_similarity_is_recovered_with_70_percent_outliers);
    tcase_add_test(tc, least_squares_is_better_than_any_two_pairs);
    tcase_add_test(tc, the_larger_of_two_motions_wins);
    tcase_add_test(tc, a_translation_is_recovered_with_60_percent_outliers);
    tcase_add_test(tc, an_affine_map_is_recovered_with_40_percent_outliers);
    tcase_add_test(tc, consensus_weights_decide_which_of_two_motions_wins);
    tcase_add_test(tc, the_unit_does_not_matter);
    tcase_add_test(tc, equal_seeds_give_equal_bits);
    tcase_add_test(tc, the_identity_is_returned_if_no_similarity_exists);
    tcase_add_test(tc, pairs_that_are_not_finite_are_outliers);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
