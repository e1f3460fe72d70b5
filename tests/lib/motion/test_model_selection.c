/* SPDX-License-Identifier: MIT */
/* Model selection and track weights, on synthetic tracks. */
#include <math.h>
#include <string.h>

#include "checkx.h"
#include "fit/ransac.h"
#include "motion/model_selection.h"

enum { COUNT = 200 };

static const double half_w = 0.4358, half_h = 0.2451; /* 16:9 */
static const double threshold = 1.5 / 734.0, pixel = 1.0 / 734.0;

static L1L2Rng rng;
static L1L2Pair pairs[COUNT];
static int age[COUNT];
static bool inlier[COUNT], core[COUNT];
static double consensus_weights[COUNT], fit_weights[COUNT];
static L1L2TrackWeights weights;

static double uniform(double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(&rng) / 4294967296.0);
}

/* Pairs first .. first + n - 1: points of the area [x0, x1] x [y0, y1], in halves of the frame, that F moves. */
static void place(int first, int n, double x0, double y0, double x1, double y1, const L1L2Mat *F, double scatter)
{
    for (int i = first; i < first + n; i++) {
        pairs[i].from = (L1L2Point){half_w * uniform(x0, x1), half_h * uniform(y0, y1)};
        pairs[i].to = l1l2_mat_apply(F, pairs[i].from);
        pairs[i].to.x += uniform(-scatter, scatter);
        pairs[i].to.y += uniform(-scatter, scatter);
    }
}

static void setup(void)
{
    rng = l1l2_rng_seeded(3);
    memset(age, 0, sizeof age);
    weights = (L1L2TrackWeights){.parameters = &l1l2_motion_defaults, .half_w = half_w, .half_h = half_h};
    l1l2_motion_weights_reset(&weights);
}

static L1L2ModelSelection selection_new(L1L2StabMotionModel highest)
{
    L1L2ModelSelection l = {
        .parameters = &l1l2_motion_defaults, .highest = highest, .threshold = threshold, .measured_share = 1.0};
    l1l2_motion_model_reset(&l);
    return l;
}

static L1L2SelectedModel measure(L1L2ModelSelection *l, int count)
{
    l1l2_motion_weights_assign(&weights, pairs, age, count, consensus_weights, fit_weights);
    const L1L2TrackSet tracks = {.pairs = pairs, .consensus_weights = consensus_weights, .fit_weights = fit_weights,
                                 .count = count, .threshold = threshold, .rng = &rng};
    return l1l2_motion_model_select(l, &weights, &tracks, true, inlier, core);
}

static double error_of(const L1L2SelectedModel *r, const L1L2Mat *truth)
{
    return l1l2_mat_corner_distance(&r->F, truth, half_w, half_h) / pixel;
}

static const L1L2Mat camera = {{1.001, -0.002, 0.006, 0.002, 1.001, -0.004, 0.0, 0.0, 1.0}};
static const L1L2Mat walker = {{1.0, 0.0, 0.03, 0.0, 1.0, 0.001, 0.0, 0.0, 1.0}};

START_TEST(a_textured_walker_does_not_outweigh_a_spread_background)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    setup();
    place(0, 50, -1, -1, 1, 1, &camera, 0.1 * pixel);
    place(50, 150, -0.4, -0.6, 0.4, 0.9, &walker, 0.1 * pixel); /* three of four points, on 30 % of the frame */
    const L1L2SelectedModel r = measure(&l, COUNT);
    ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    ck_assert(error_of(&r, &camera) < 0.2);
    ck_assert(r.quality < 0.7);
}
END_TEST

START_TEST(tracks_that_moved_with_the_camera_before_count_more)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    setup();
    place(0, 80, -1, -1, -0.2, 1, &camera, 0.1 * pixel); /* 40 %, known for long */
    place(80, 120, -0.2, -1, 1, 1, &walker, 0.1 * pixel);
    for (int i = 0; i < 80; i++)
        age[i] = 30;
    const L1L2SelectedModel known = measure(&l, COUNT);
    ck_assert_int_eq(known.source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    ck_assert(error_of(&known, &camera) < 0.2);
    /* And so do places in which they did. */
    memset(age, 0, sizeof age);
    for (int i = 0; i < 20; i++)
        l1l2_motion_weights_learn(&weights, pairs, inlier, COUNT);
    const L1L2SelectedModel again = measure(&l, COUNT);
    ck_assert(error_of(&again, &camera) < 0.2);
}
END_TEST

START_TEST(of_two_motions_of_equal_weight_neither_is_followed)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    setup();
    place(0, 100, -1, -1, 0, 1, &camera, 0.1 * pixel);
    place(100, 100, 0, -1, 1, 1, &walker, 0.1 * pixel);
    const L1L2SelectedModel r = measure(&l, COUNT);
    ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_NONE);
    ck_assert(r.quality < 0.12);
}
END_TEST

START_TEST(two_depths_of_one_scene_do_not_compete)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    const L1L2Mat farther = {{1.0, 0.0, 2.5 * pixel, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
    const L1L2Mat still = l1l2_mat_identity();
    setup();
    place(0, 100, -1, -1, 0, 1, &still, 0.1 * pixel);
    place(100, 100, 0, -1, 1, 1, &farther, 0.1 * pixel);
    ck_assert_int_eq(measure(&l, COUNT).source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
}
END_TEST

START_TEST(a_motion_within_the_noise_is_reduced_to_none)
{
    const L1L2Mat still = l1l2_mat_identity();
    double given = 0.0, fitted = 0.0;
    setup();
    for (int t = 0; t < 50; t++) {
        L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
        L1L2SelectedModel raw;
        place(0, 80, -1, -1, 1, 1, &still, 2.0 * pixel);
        const L1L2TrackSet tracks = {.pairs = pairs, .count = 80, .threshold = threshold, .rng = &rng};
        l1l2_ransac(L1L2STAB_MOTION_MODEL_SIMILARITY, &tracks, inlier, &raw.F);
        const L1L2SelectedModel r = measure(&l, 80);
        given += error_of(&r, &still) * error_of(&r, &still);
        fitted += error_of(&raw, &still) * error_of(&raw, &still);
        ck_assert(r.quality < 0.9);
    }
    ck_assert_msg(given < 0.1 * fitted, "rms %g px, fitted %g px", sqrt(given / 50), sqrt(fitted / 50));
    /* One that does is followed. */
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    place(0, 80, -1, -1, 1, 1, &walker, 1.0 * pixel);
    const L1L2SelectedModel r = measure(&l, 80);
    ck_assert(error_of(&r, &walker) < 0.6);
}
END_TEST

/* The rows' shift in a rolling shutter that shakes within the frame: two thirds of a wave. */
static void shake_rows(double amplitude)
{
    for (int i = 0; i < COUNT; i++) {
        const double phase = 2.1 * pairs[i].from.y / half_h;
        pairs[i].to.x += amplitude * cos(phase + 1.0);
        pairs[i].to.y += amplitude * sin(phase);
    }
}

START_TEST(rows_that_move_differently_are_not_taken_for_a_subject)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    setup();
    for (int t = 0; t < 20; t++) {
        place(0, COUNT, -1, -1, 1, 1, &camera, 0.3 * pixel);
        shake_rows(5.0 * pixel);
        const L1L2SelectedModel r = measure(&l, COUNT);
        ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
        ck_assert_int_ge(r.inliers, COUNT * 9 / 10);
    }
    /* A subject shares its rows with the background. */
    place(0, 100, -1, -1, 1, 1, &camera, 0.3 * pixel);
    place(100, 100, -0.5, -0.8, 0.7, 0.9, &walker, 0.3 * pixel);
    ck_assert_int_le(measure(&l, COUNT).inliers, 110);
}
END_TEST

START_TEST(twenty_tracks_determine_a_translation_and_seven_determine_nothing)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    const L1L2Mat shift = l1l2_mat_translation(0.02, -0.01);
    setup();
    place(0, 20, -1, -1, 1, 1, &shift, 0.2 * pixel);
    const L1L2SelectedModel few = measure(&l, 20);
    ck_assert_int_eq(few.source, L1L2STAB_MOTION_SOURCE_TRANSLATION);
    ck_assert(error_of(&few, &shift) < 0.2);
    ck_assert_int_eq(measure(&l, 7).source, L1L2STAB_MOTION_SOURCE_NONE);
    /* Points of nothing but noise agree with no shift. */
    place(0, 20, -1, -1, 1, 1, &shift, 4.0 * pixel);
    ck_assert_int_eq(measure(&l, 20).source, L1L2STAB_MOTION_SOURCE_NONE);
}
END_TEST

START_TEST(the_model_does_not_flip_from_frame_to_frame)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    const L1L2Mat shift = l1l2_mat_translation(0.02, -0.01);
    int flips = 0;
    L1L2StabMotionSource last = L1L2STAB_MOTION_SOURCE_SIMILARITY;
    setup();
    for (int t = 0; t < 60; t++) { /* to and fro across the gate of 30 */
        const int count = t % 2 ? 28 : 32;
        place(0, count, -1, -1, 1, 1, &shift, 0.2 * pixel);
        const L1L2StabMotionSource model = measure(&l, count).source;
        flips += model != last;
        last = model;
    }
    ck_assert_int_eq(flips, 1);
    place(0, 60, -1, -1, 1, 1, &shift, 0.2 * pixel);
    ck_assert_int_eq(measure(&l, 60).source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
}
END_TEST

START_TEST(a_higher_model_returns_at_its_third_acceptable_frame)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    const L1L2Mat shift = l1l2_mat_translation(0.02, -0.01);
    setup();
    place(0, 28, -1, -1, 1, 1, &shift, 0.2 * pixel); /* too few for a similarity */
    ck_assert_int_eq(measure(&l, 28).source, L1L2STAB_MOTION_SOURCE_TRANSLATION);
    for (int t = 0; t < 10; t++) {
        place(0, 35, -1, -1, 1, 1, &shift, 0.2 * pixel);
        ck_assert_int_eq(measure(&l, 35).source,
                         t < 2 ? L1L2STAB_MOTION_SOURCE_TRANSLATION : L1L2STAB_MOTION_SOURCE_SIMILARITY);
    }
}
END_TEST

START_TEST(a_higher_model_returns_at_once_if_no_lower_one_fits)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    const L1L2Mat shift = l1l2_mat_translation(0.02, -0.01);
    const L1L2Mat turn = l1l2_mat_similarity(cos(0.05), sin(0.05), 0.01, 0.0);
    setup();
    place(0, 28, -1, -1, 1, 1, &shift, 0.2 * pixel);
    ck_assert_int_eq(measure(&l, 28).source, L1L2STAB_MOTION_SOURCE_TRANSLATION);
    place(0, 35, -1, -1, 1, 1, &turn, 0.2 * pixel);
    const L1L2SelectedModel r = measure(&l, 35);
    ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    ck_assert_int_eq(r.inliers, 35);
    ck_assert(error_of(&r, &turn) < 0.5);
}
END_TEST

START_TEST(an_affine_motion_needs_tracks_all_over_the_frame)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_AFFINE);
    const L1L2Mat shear = {{1.03, 0.01, 0.01, 0.02, 0.98, 0.0, 0.0, 0.0, 1.0}};
    setup();
    place(0, COUNT, -1, -1, 1, 1, &shear, 0.1 * pixel);
    const L1L2SelectedModel r = measure(&l, COUNT);
    ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_AFFINE);
    ck_assert(error_of(&r, &shear) < 0.2);
    place(0, COUNT, -0.2, -0.2, 0.2, 0.2, &camera, 0.1 * pixel);
    ck_assert_int_eq(measure(&l, COUNT).source, L1L2STAB_MOTION_SOURCE_SIMILARITY);
}
END_TEST

START_TEST(an_unmeasured_motion_is_predicted_and_decays)
{
    L1L2ModelSelection l = selection_new(L1L2STAB_MOTION_MODEL_SIMILARITY);
    setup();
    place(0, COUNT, -1, -1, 1, 1, &walker, 0.0);
    measure(&l, COUNT);
    double last = walker.m[2];
    for (int t = 0; t < 15; t++) {
        const L1L2SelectedModel r = l1l2_motion_model_predict(&l);
        ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_PREDICTED);
        ck_assert(r.F.m[2] > 0.0 && r.F.m[2] < last);
        last = r.F.m[2];
    }
    const L1L2SelectedModel r = l1l2_motion_model_predict(&l);
    ck_assert_int_eq(r.source, L1L2STAB_MOTION_SOURCE_IDENTITY);
    ck_assert(l1l2_mat_is_identity(&r.F));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("model_selection");
    TCase *tcase = tcase_create("model_selection");
    tcase_add_test(tcase, a_textured_walker_does_not_outweigh_a_spread_background);
    tcase_add_test(tcase, tracks_that_moved_with_the_camera_before_count_more);
    tcase_add_test(tcase, of_two_motions_of_equal_weight_neither_is_followed);
    tcase_add_test(tcase, two_depths_of_one_scene_do_not_compete);
    tcase_add_test(tcase, a_motion_within_the_noise_is_reduced_to_none);
    tcase_add_test(tcase, rows_that_move_differently_are_not_taken_for_a_subject);
    tcase_add_test(tcase, twenty_tracks_determine_a_translation_and_seven_determine_nothing);
    tcase_add_test(tcase, the_model_does_not_flip_from_frame_to_frame);
    tcase_add_test(tcase, a_higher_model_returns_at_its_third_acceptable_frame);
    tcase_add_test(tcase, a_higher_model_returns_at_once_if_no_lower_one_fits);
    tcase_add_test(tcase, an_affine_motion_needs_tracks_all_over_the_frame);
    tcase_add_test(tcase, an_unmeasured_motion_is_predicted_and_decays);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
