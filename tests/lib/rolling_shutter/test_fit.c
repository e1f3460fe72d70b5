/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "rolling_shutter/fit.h"
#include "rolling_shutter/similarity_by_rows.h"

enum { MAX = 200 };
static const double half_w = 0.436, half_h = 0.245; /* 16:9 */
static const double px = 1.0 / 734.0;               /* of 640x360 */
static const double threshold = 1.5 / 734.0;

typedef struct Scene {
    L1L2ShutterModel model;
    L1L2Pair pair[MAX];
    bool inlier[MAX];
    L1L2Rng rng;
} Scene;

static double uniform(L1L2Rng *rng, double least, double most)
{
    return least + (most - least) * (l1l2_rng_below(rng, 1u << 30) / (double)(1u << 30));
}

/* Close to a normal distribution. */
static double noise(L1L2Rng *rng, double sigma)
{
    return sigma * (uniform(rng, -1, 1) + uniform(rng, -1, 1) + uniform(rng, -1, 1));
}

/* Points all over the frame that move by F and by `truth`, tracked with 0.1 px of noise. */
static Scene scene_of(L1L2StabRollingShutter kind, const L1L2Mat *F, const L1L2ShutterResidual *truth)
{
    Scene s = {.model = {kind, half_w, half_h, NULL}, .rng = l1l2_rng_seeded(7)};
    for (int i = 0; i < MAX; i++) {
        const L1L2Point p = {uniform(&s.rng, -half_w, half_w), uniform(&s.rng, -half_h, half_h)};
        const L1L2Point moved = l1l2_mat_apply(F, p), r = l1l2_shutter_residual_at(&s.model, truth, p);
        s.pair[i].from = p;
        s.pair[i].to = (L1L2Point){moved.x + r.x + noise(&s.rng, 0.1 * px), moved.y + r.y + noise(&s.rng, 0.1 * px)};
        s.inlier[i] = true;
    }
    return s;
}

static double error_px(const L1L2ShutterModel *model, const L1L2ShutterResidual *a, const L1L2ShutterResidual *b)
{
    L1L2ShutterResidual difference;
    for (int i = 0; i < L1L2_SHUTTER_SIZE; i++)
        difference.p[i] = a->p[i] - b->p[i];
    return l1l2_shutter_residual_reach(model, &difference) / px;
}

static L1L2ShutterResidual some_homography(void)
{
    return (L1L2ShutterResidual){{0.004, 0.006, 0.0, -0.003, 0.002, 0.0, 0.01, -0.008}};
}

/* Rows displaced by up to 3 px. */
static L1L2ShutterResidual some_rows(void)
{
    L1L2ShutterResidual r = {{0.0}};
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        r.p[L1L2_SHUTTER_X + k] = 3.0 * px * sin(4.0 * l1l2_shutter_band_row(k));
        r.p[L1L2_SHUTTER_Y + k] = 2.0 * px * sin(4.0 * l1l2_shutter_band_row(k) + 1.0);
    }
    r.p[L1L2_SHUTTER_ROLL_BY_ROW] = 0.004;
    return r;
}

START_TEST(a_homography_is_recovered_with_40_percent_outliers)
{
    const L1L2Mat F = l1l2_mat_similarity(1.01, 0.01, 0.01, -0.02);
    const L1L2ShutterResidual truth = some_homography();
    Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY, &F, &truth);
    for (int i = 0; i < MAX; i += 5)
        for (int k = i; k < i + 2; k++) {
            s.pair[k].to.x += uniform(&s.rng, 10, 60) * px;
            s.inlier[k] = false;
        }
    L1L2ShutterMeasurement measurement;
    const int inliers = l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement);
    ck_assert_int_ge(inliers, 118);
    ck_assert_int_le(inliers, 121);
    ck_assert_double_lt(error_px(&s.model, &measurement.r, &truth), 0.5);
}
END_TEST

START_TEST(a_mixture_is_recovered)
{
    const L1L2Mat F = l1l2_mat_similarity(1.0, 0.002, 0.01, 0.01);
    const L1L2ShutterResidual truth = some_rows();
    Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &truth);
    L1L2ShutterMeasurement measurement;
    ck_assert_int_ge(l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement), MAX - 2);
    ck_assert_double_lt(error_px(&s.model, &measurement.r, &truth), 0.5);
    for (int split = 0; split < L1L2_SPLITS; split++)
        ck_assert_double_gt(measurement.explained[split], 0.9 * measurement.all[split]);
}
END_TEST

START_TEST(noise_alone_passes_no_validation_split)
{
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.01);
    const L1L2ShutterResidual none = {{0.0}};
    for (int kind = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; kind <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; kind++) {
        Scene s = scene_of((L1L2StabRollingShutter)kind, &F, &none);
        L1L2ShutterMeasurement measurement;
        l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement);
        for (int split = 0; split < L1L2_SPLITS; split++)
            ck_assert_double_lt(measurement.explained[split], 0.05 * measurement.all[split]);
        ck_assert_double_lt(error_px(&s.model, &measurement.r, &none), 0.25);
    }
}
END_TEST

/* The left 40 % of the frame moves by itself, slowly or fast. */
START_TEST(a_subject_on_40_percent_of_the_frame_leaves_no_residual)
{
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.0);
    const L1L2ShutterResidual none = {{0.0}};
    const double speeds[] = {5.0, 8.0, 30.0};
    for (int kind = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; kind <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; kind++)
        for (int k = 0; k < 3; k++) {
            Scene s = scene_of((L1L2StabRollingShutter)kind, &F, &none);
            for (int i = 0; i < MAX; i++)
                if (s.pair[i].from.x < -0.2 * half_w) {
                    s.pair[i].to.x += speeds[k] * px;
                    s.inlier[i] = false;
                }
            L1L2ShutterMeasurement measurement;
            l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement);
            ck_assert_double_lt(error_px(&s.model, &measurement.r, &none), 0.8);
        }
}
END_TEST

/* The subject is so slow that all of its tracks agree with F. */
START_TEST(a_slow_subject_in_the_middle_fails_the_split_by_columns)
{
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.0);
    const L1L2ShutterResidual none = {{0.0}};
    for (int kind = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; kind <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; kind++) {
        Scene s = scene_of((L1L2StabRollingShutter)kind, &F, &none);
        for (int i = 0; i < MAX; i++)
            if (hypot(s.pair[i].from.x, s.pair[i].from.y) < 0.23)
                s.pair[i].to.x += 1.0 * px;
        L1L2ShutterMeasurement measurement;
        l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement);
        ck_assert_double_lt(measurement.explained[L1L2_SPLIT_COLUMNS], 0.0);
    }
}
END_TEST

START_TEST(inliers_in_one_corner_give_no_residual)
{
    const L1L2Mat F = l1l2_mat_identity();
    const L1L2ShutterResidual truth = some_rows();
    Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &truth);
    for (int i = 0; i < MAX; i++)
        s.inlier[i] = s.pair[i].from.x > 0.4 * half_w && s.pair[i].from.y > 0.4 * half_h;
    const bool before = s.inlier[3];
    L1L2ShutterMeasurement measurement;
    ck_assert_int_eq(l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement), 0);
    ck_assert_double_eq(l1l2_shutter_residual_reach(&s.model, &measurement.r), 0.0);
    ck_assert(s.inlier[3] == before);
}
END_TEST

START_TEST(after_the_similarity_is_extracted_none_is_left)
{
    const L1L2ShutterResidual given[] = {{{0.0}}, some_homography(), some_rows()};
    for (int kind = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; kind <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; kind++) {
        const L1L2ShutterModel model = {(L1L2StabRollingShutter)kind, half_w, half_h, NULL};
        L1L2ShutterResidual rest = given[kind];
        const L1L2Mat taken = l1l2_shutter_residual_extract_similarity(&model, &rest);
        const L1L2Point p = {0.2, -0.1}, whole = l1l2_shutter_residual_at(&model, &given[kind], p);
        const L1L2Point part = l1l2_shutter_residual_at(&model, &rest, p);
        ck_assert_near(part.x + taken.m[0] * p.x + taken.m[1] * p.y + taken.m[2], whole.x, 1e-12);
        ck_assert_near(part.y + taken.m[3] * p.x + taken.m[4] * p.y + taken.m[5], whole.y, 1e-12);
        const L1L2Mat again = l1l2_shutter_residual_extract_similarity(&model, &rest);
        for (int i = 0; i < 6; i++)
            ck_assert_near(again.m[i], 0.0, 1e-12);
    }
}
END_TEST

START_TEST(a_pair_that_is_not_finite_gives_no_residual_and_changes_no_flag)
{
    const L1L2Mat F = l1l2_mat_identity();
    const L1L2ShutterResidual truth = some_rows();
    for (int kind = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; kind <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; kind++) {
        Scene s = scene_of((L1L2StabRollingShutter)kind, &F, &truth);
        L1L2ShutterMeasurement measurement;
        s.pair[7].to.y = NAN;
        s.inlier[9] = false;
        ck_assert_int_eq(l1l2_shutter_fit(&s.model, s.pair, MAX, threshold, s.inlier, &F, &measurement), 0);
        ck_assert_double_eq(l1l2_shutter_residual_reach(&s.model, &measurement.r), 0.0);
        for (int i = 0; i < MAX; i++)
            ck_assert(s.inlier[i] == (i != 9));
    }
}
END_TEST

/* The same scene on more tracks than RANSAC takes. */
START_TEST(the_number_of_pairs_has_no_limit)
{
    enum { COPIES = 10 };
    const L1L2Mat F = l1l2_mat_similarity(1.0, 0.002, 0.01, 0.01);
    const L1L2ShutterResidual truth = some_rows();
    const Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &truth);
    static L1L2Pair pairs[COPIES * MAX];
    static bool inlier[COPIES * MAX];
    L1L2ShutterMeasurement measurement;
    for (int i = 0; i < COPIES * MAX; i++)
        pairs[i] = s.pair[i % MAX], inlier[i] = true;
    ck_assert_int_ge(l1l2_shutter_fit(&s.model, pairs, COPIES * MAX, threshold, inlier, &F, &measurement),
                     COPIES * (MAX - 2));
    ck_assert_double_lt(error_px(&s.model, &measurement.r, &truth), 0.5);
    for (int split = 0; split < L1L2_SPLITS; split++)
        ck_assert_double_gt(measurement.explained[split], 0.9 * measurement.all[split]);
}
END_TEST

/* Each row has a shift of its own, which is the same in all columns. */
static void displace_rows(Scene *s)
{
    for (int i = 0; i < MAX; i++)
        s->pair[i].to.x += 6.0 * px * sin(3.0 * s->pair[i].from.y / half_h);
}

START_TEST(rows_that_are_displaced_smoothly_have_a_similarity_and_two_surfaces_have_none)
{
    const L1L2Mat F = l1l2_mat_similarity(1.0, 0.01, 0.02, 0.01);
    const L1L2ShutterResidual none = {{0.0}};
    double consensus_weights[MAX];
    for (int i = 0; i < MAX; i++)
        consensus_weights[i] = 1.0;
    for (int surfaces = 0; surfaces < 2; surfaces++) {
        Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &none);
        const L1L2ShutterRowTracks tracks = {s.pair, consensus_weights, MAX, half_h, threshold, NULL};
        L1L2Mat fit;
        if (surfaces) {
            for (int i = 0; i < MAX; i += 2)
                s.pair[i].to.x += 6.0 * px;
        } else {
            displace_rows(&s);
        }
        const int inliers = l1l2_shutter_similarity_by_rows(&tracks, s.inlier, &fit);
        if (surfaces) {
            ck_assert_int_eq(inliers, 0);
        } else {
            ck_assert_int_ge(inliers, MAX * 9 / 10);
            ck_assert_near(fit.m[3], F.m[3], 1e-3);
        }
    }
}
END_TEST

START_TEST(more_pairs_than_the_similarity_by_rows_takes_are_refused)
{
    enum { MANY = L1L2_SHUTTER_ROWS_MAX_PAIRS + MAX };
    const L1L2Mat F = l1l2_mat_identity();
    const L1L2ShutterResidual none = {{0.0}};
    Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &none);
    static L1L2Pair pairs[MANY];
    static double consensus_weights[MANY];
    static bool inlier[MANY];
    displace_rows(&s);
    for (int i = 0; i < MANY; i++)
        pairs[i] = s.pair[i % MAX], consensus_weights[i] = 1.0;
    const L1L2ShutterRowTracks tracks = {pairs, consensus_weights, MANY, half_h, threshold, NULL};
    L1L2Mat fit;
    ck_assert_int_eq(l1l2_shutter_similarity_by_rows(&tracks, inlier, &fit), 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fit");
    TCase *tcase = tcase_create("fit");
    tcase_add_test(tcase, a_homography_is_recovered_with_40_percent_outliers);
    tcase_add_test(tcase, a_mixture_is_recovered);
    tcase_add_test(tcase, noise_alone_passes_no_validation_split);
    tcase_add_test(tcase, a_subject_on_40_percent_of_the_frame_leaves_no_residual);
    tcase_add_test(tcase, a_slow_subject_in_the_middle_fails_the_split_by_columns);
    tcase_add_test(tcase, inliers_in_one_corner_give_no_residual);
    tcase_add_test(tcase, after_the_similarity_is_extracted_none_is_left);
    tcase_add_test(tcase, a_pair_that_is_not_finite_gives_no_residual_and_changes_no_flag);
    tcase_add_test(tcase, the_number_of_pairs_has_no_limit);
    tcase_add_test(tcase, rows_that_are_displaced_smoothly_have_a_similarity_and_two_surfaces_have_none);
    tcase_add_test(tcase, more_pairs_than_the_similarity_by_rows_takes_are_refused);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
