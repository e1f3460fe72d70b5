/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "rolling_shutter/fit.h"

enum { MAX = 200 };
static const double half_w = 0.436, half_h = 0.245; /* 16:9 */
static const double px = 1.0 / 734.0;               /* of 640x360 */
static const double threshold = 1.5 / 734.0;

typedef struct Scene {
    L1L2ShutterModel shape;
    L1L2Pair pair[MAX];
    bool inlier[MAX];
    L1L2Rng rng;
} Scene;

static double uniform(L1L2Rng *rng, double least, double most)
{
    return least + (most - least) * (l1l2_rng_below(rng, 1u << 30) / (double)(1u << 30));
}

/* Near enough to normal. */
static double noise(L1L2Rng *rng, double sigma)
{
    return sigma * (uniform(rng, -1, 1) + uniform(rng, -1, 1) + uniform(rng, -1, 1));
}

/* Points all over the frame, which move by F and then by `truth`, seen with 0.1 px of noise. */
static Scene scene_of(L1L2StabRollingShutter model, const L1L2Mat *F, const L1L2ShutterResidual *truth)
{
    Scene s = {.shape = {model, half_w, half_h, NULL}, .rng = l1l2_rng_seeded(7)};
    for (int i = 0; i < MAX; i++) {
        const L1L2Point p = {uniform(&s.rng, -half_w, half_w), uniform(&s.rng, -half_h, half_h)};
        const L1L2Point moved = l1l2_mat_apply(F, p), r = l1l2_shutter_residual_at(&s.shape, truth, p);
        s.pair[i].from = p;
        s.pair[i].to = (L1L2Point){moved.x + r.x + noise(&s.rng, 0.1 * px), moved.y + r.y + noise(&s.rng, 0.1 * px)};
        s.inlier[i] = true;
    }
    return s;
}

static double error_px(const L1L2ShutterModel *shape, const L1L2ShutterResidual *a, const L1L2ShutterResidual *b)
{
    L1L2ShutterResidual difference;
    for (int i = 0; i < L1L2_SHUTTER_SIZE; i++)
        difference.p[i] = a->p[i] - b->p[i];
    return l1l2_shutter_residual_reach(shape, &difference) / px;
}

static L1L2ShutterResidual some_homography(void)
{
    return (L1L2ShutterResidual){{0.004, 0.006, 0.0, -0.003, 0.002, 0.0, 0.01, -0.008}};
}

/* Rows that swing to and fro, 3 px each way. */
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
    L1L2ShutterMeasurement step;
    const int inliers = l1l2_shutter_fit(&s.shape, s.pair, MAX, threshold, s.inlier, &F, &step);
    ck_assert_int_ge(inliers, 118);
    ck_assert_int_le(inliers, 121);
    ck_assert_double_lt(error_px(&s.shape, &step.r, &truth), 0.5);
}
END_TEST

START_TEST(rows_that_move_by_themselves_are_recovered)
{
    const L1L2Mat F = l1l2_mat_similarity(1.0, 0.002, 0.01, 0.01);
    const L1L2ShutterResidual truth = some_rows();
    Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &truth);
    L1L2ShutterMeasurement step;
    ck_assert_int_ge(l1l2_shutter_fit(&s.shape, s.pair, MAX, threshold, s.inlier, &F, &step), MAX - 2);
    ck_assert_double_lt(error_px(&s.shape, &step.r, &truth), 0.5);
    for (int division = 0; division < L1L2_SPLITS; division++)
        ck_assert_double_gt(step.explained[division], 0.9 * step.all[division]);
}
END_TEST

START_TEST(noise_alone_explains_nothing)
{
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.01);
    const L1L2ShutterResidual none = {{0.0}};
    for (int model = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; model <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; model++) {
        Scene s = scene_of((L1L2StabRollingShutter)model, &F, &none);
        L1L2ShutterMeasurement step;
        l1l2_shutter_fit(&s.shape, s.pair, MAX, threshold, s.inlier, &F, &step);
        for (int division = 0; division < L1L2_SPLITS; division++)
            ck_assert_double_lt(step.explained[division], 0.05 * step.all[division]);
        ck_assert_double_lt(error_px(&s.shape, &step.r, &none), 0.25);
    }
}
END_TEST

/* The left 40 % of the picture moves by itself, slowly or fast. */
START_TEST(a_mover_of_40_percent_bends_nothing)
{
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.0);
    const L1L2ShutterResidual none = {{0.0}};
    const double speeds[] = {5.0, 8.0, 30.0};
    for (int model = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; model <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; model++)
        for (int k = 0; k < 3; k++) {
            Scene s = scene_of((L1L2StabRollingShutter)model, &F, &none);
            for (int i = 0; i < MAX; i++)
                if (s.pair[i].from.x < -0.2 * half_w) {
                    s.pair[i].to.x += speeds[k] * px;
                    s.inlier[i] = false;
                }
            L1L2ShutterMeasurement step;
            l1l2_shutter_fit(&s.shape, s.pair, MAX, threshold, s.inlier, &F, &step);
            ck_assert_double_lt(error_px(&s.shape, &step.r, &none), 0.8);
        }
}
END_TEST

/* A slow one, of which all agree with F, too. */
START_TEST(what_moves_in_the_middle_of_the_rows_is_not_told_by_their_ends)
{
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.0);
    const L1L2ShutterResidual none = {{0.0}};
    for (int model = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; model <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; model++) {
        Scene s = scene_of((L1L2StabRollingShutter)model, &F, &none);
        for (int i = 0; i < MAX; i++)
            if (hypot(s.pair[i].from.x, s.pair[i].from.y) < 0.23)
                s.pair[i].to.x += 1.0 * px;
        L1L2ShutterMeasurement step;
        l1l2_shutter_fit(&s.shape, s.pair, MAX, threshold, s.inlier, &F, &step);
        ck_assert_double_lt(step.explained[L1L2_SPLIT_COLUMNS], 0.0);
    }
}
END_TEST

START_TEST(points_in_one_corner_give_no_residual)
{
    const L1L2Mat F = l1l2_mat_identity();
    const L1L2ShutterResidual truth = some_rows();
    Scene s = scene_of(L1L2STAB_ROLLING_SHUTTER_MIXTURE, &F, &truth);
    for (int i = 0; i < MAX; i++)
        s.inlier[i] = s.pair[i].from.x > 0.4 * half_w && s.pair[i].from.y > 0.4 * half_h;
    const bool before = s.inlier[3];
    L1L2ShutterMeasurement step;
    ck_assert_int_eq(l1l2_shutter_fit(&s.shape, s.pair, MAX, threshold, s.inlier, &F, &step), 0);
    ck_assert_double_eq(l1l2_shutter_residual_reach(&s.shape, &step.r), 0.0);
    ck_assert(s.inlier[3] == before);
}
END_TEST

START_TEST(what_is_split_off_leaves_no_similarity)
{
    const L1L2ShutterResidual given[] = {{{0.0}}, some_homography(), some_rows()};
    for (int model = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; model <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; model++) {
        const L1L2ShutterModel shape = {(L1L2StabRollingShutter)model, half_w, half_h, NULL};
        L1L2ShutterResidual rest = given[model];
        const L1L2Mat taken = l1l2_shutter_residual_extract_similarity(&shape, &rest);
        const L1L2Point p = {0.2, -0.1}, whole = l1l2_shutter_residual_at(&shape, &given[model], p);
        const L1L2Point part = l1l2_shutter_residual_at(&shape, &rest, p);
        ck_assert_near(part.x + taken.m[0] * p.x + taken.m[1] * p.y + taken.m[2], whole.x, 1e-12);
        ck_assert_near(part.y + taken.m[3] * p.x + taken.m[4] * p.y + taken.m[5], whole.y, 1e-12);
        const L1L2Mat again = l1l2_shutter_residual_extract_similarity(&shape, &rest);
        for (int i = 0; i < 6; i++)
            ck_assert_near(again.m[i], 0.0, 1e-12);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_residual");
    TCase *tcase = tcase_create("fit");
    tcase_add_test(tcase, a_homography_is_recovered_with_40_percent_outliers);
    tcase_add_test(tcase, rows_that_move_by_themselves_are_recovered);
    tcase_add_test(tcase, noise_alone_explains_nothing);
    tcase_add_test(tcase, a_mover_of_40_percent_bends_nothing);
    tcase_add_test(tcase, what_moves_in_the_middle_of_the_rows_is_not_told_by_their_ends);
    tcase_add_test(tcase, points_in_one_corner_give_no_residual);
    tcase_add_test(tcase, what_is_split_off_leaves_no_similarity);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
