/* SPDX-License-Identifier: MIT */
/* Extreme motions, and parameters that change while running: every update transform meets its constraints, and the
 * work of a solve is bounded. */
#include "path/path_fixture.h"

START_TEST(every_update_transform_stays_inside_whatever_the_motion)
{
    static const double shakes[] = {1, 20, 200, 2000};
    for (int i = 0; i < 4; i++)
        for (int join = 0; join < 2; join++) {
            Setup cfg = defaults();
            cfg.window = 40, cfg.overlap = join == L1L2STAB_JOIN_BLEND ? 12 : 20;
            cfg.join = (L1L2StabJoin)join;
            cfg.crop_ratio = 0.8;
            Run *r = shaky_run(200, 2.0, shakes[i], (uint64_t)i);
            run(&cfg, r);
            assert_all_inside(&cfg, r);
            free(r);
        }
}
END_TEST

START_TEST(motions_that_no_camera_makes_give_finite_maps_inside)
{
    const Setup cfg = defaults();
    const L1L2PathCropWindow crop = l1l2_path_crop_window(cfg.width, cfg.height, cfg.crop_ratio, 4);
    Run *r = new_run(400);
    int fallbacks = 0;
    for (int t = 100; t < 250; t++)
        r->F[t] = l1l2_mat_similarity(1e-4, 0.0, 0.01, 0.0); /* C_t runs out of double's range within the window */
    run(&cfg, r);
    for (int t = 0; t < r->frames; t++) {
        ck_assert(l1l2_mat_is_finite(&r->out[t].B));
        ck_assert_double_le(l1l2_path_constraint_excess(&crop, &r->out[t].B), 1e-9);
        fallbacks += r->out[t].fallback;
    }
    ck_assert_int_gt(fallbacks, 0);
    ck_assert(!r->out[399].fallback); /* the path is normal again */
    free(r);
}
END_TEST

/* With a lambda that is not a number no solver converges, though the motion is an ordinary one. */
START_TEST(where_no_solver_converges_the_path_goes_on_without_a_jump)
{
    Setup cfg = defaults();
    const L1L2PathCropWindow crop = l1l2_path_crop_window(cfg.width, cfg.height, cfg.crop_ratio, 4);
    Run *r = shaky_run(480, 1.0, 2.0, 8);
    L1L2Path *path = new_path(&cfg, r);
    int pulled = 0, held = 0;
    for (int t = 0; t < r->frames; t++) {
        if (t == 210 || t == 215)
            cfg.lambda = t == 210 ? NAN : 0.5;
        push(path, &cfg, &r->F[t], false);
        if (t - pulled + 1 == cfg.window)
            ck_assert(pull(path, r, pulled++));
    }
    for (int t = 1; t < pulled; t++) {
        ck_assert_double_le(l1l2_path_constraint_excess(&crop, &r->out[t].B), 1e-12);
        if (r->out[t].fallback && !r->out[t - 1].fallback)
            ck_assert_near(speed_px(r, t), speed_px(r, t - 1), 0.1);
        held += r->out[t].fallback;
    }
    ck_assert_int_ge(held, 50);
    ck_assert(!r->out[pulled - 1].fallback);
    l1l2_path_free(path);
    free(r);
}
END_TEST

START_TEST(a_crop_ratio_that_changes_is_ramped_and_always_met)
{
    Setup cfg = defaults();
    Run *r = shaky_run(500, 1.0, 5.0, 4);
    L1L2Path *path = new_path(&cfg, r);
    int pulled = 0;
    double before = cfg.crop_ratio;
    for (int t = 0; t < r->frames + cfg.window; t++) {
        if (t == 200)
            cfg.crop_ratio = 0.6;
        if (t == 215)
            cfg.crop_ratio = 0.95; /* during the ramp */
        if (t < r->frames)
            push(path, &cfg, &r->F[t], false);
        else if (t == r->frames)
            l1l2_path_finish(path);
        if (t - pulled + 1 < cfg.window || pulled == r->frames)
            continue;
        const L1L2PathFrame *f = &r->out[pulled];
        ck_assert(pull(path, r, pulled));
        const L1L2PathCropWindow crop = l1l2_path_crop_window(cfg.width, cfg.height, f->crop_ratio, 4);
        ck_assert_double_le(l1l2_path_constraint_excess(&crop, &f->B), 1e-12);
        ck_assert_double_le(fabs(f->crop_ratio - before), L1L2_CROP_STEP + 1e-12);
        ck_assert(!f->fallback);
        before = f->crop_ratio;
        pulled++;
    }
    ck_assert_int_eq(pulled, r->frames);
    ck_assert_near(r->out[199].crop_ratio, 0.9, 0.0);
    ck_assert_near(r->out[214].crop_ratio, 0.825, 1e-12);
    ck_assert_near(r->out[239].crop_ratio, 0.95, 1e-12);
    l1l2_path_free(path);
    free(r);
}
END_TEST

START_TEST(lambda_belongs_to_the_frames_that_it_was_set_for)
{
    Setup cfg = defaults();
    Run *r = shaky_run(600, 0.5, 5.0, 4);
    L1L2Path *path = new_path(&cfg, r);
    double left[2] = {0.0, 0.0};
    int pulled = 0;
    for (int t = 0; t < r->frames; t++) {
        if (t == 300)
            cfg.lambda = 100.0;
        push(path, &cfg, &r->F[t], false);
        if (t - pulled + 1 == cfg.window)
            ck_assert(pull(path, r, pulled++));
    }
    for (int t = 2; t < pulled; t++) {
        ck_assert_near(r->out[t].lambda, t < 300 ? 0.5 : 100.0, 0.0);
        left[t >= 300] += fabs(speed_px(r, t) - speed_px(r, t - 1));
    }
    ck_assert_double_gt(left[1] / (pulled - 300), 5.0 * left[0] / 298); /* it follows the shake */
    l1l2_path_free(path);
    free(r);
}
END_TEST

START_TEST(a_motion_that_is_not_finite_or_not_invertible_counts_as_no_motion)
{
    const Setup cfg = defaults();
    Run *r = shaky_run(300, 1.0, 4.0, 8);
    r->F[50].m[2] = NAN;
    r->F[120] = l1l2_mat_similarity(0.0, 0.0, 0.0, 0.0);
    run(&cfg, r);
    for (int t = 0; t < r->frames; t++)
        ck_assert(l1l2_mat_is_finite(&r->out[t].B) && !r->out[t].fallback);
    ck_assert(l1l2_mat_is_identity(&r->out[50].F) && l1l2_mat_is_identity(&r->out[120].F));
    free(r);
}
END_TEST

START_TEST(a_zoom_of_ten_and_jumps_of_half_a_frame_are_solved)
{
    const Setup cfg = defaults();
    Run *zoom = drifting_run(450, 0.5, 10.0, 3.0, 5), *jumps = shaky_run(450, 0.5, 3.0, 5);
    for (int t = 100; t < 250; t++)
        zoom->F[t] = l1l2_mat_mul(zoom->F[t], l1l2_mat_similarity(pow(10.0, 1.0 / 150.0), 0.0, 0.0, 0.0));
    for (int t = 20; t < 450; t += 37)
        jumps->F[t] = l1l2_mat_mul(jumps->F[t], l1l2_mat_translation(t % 2 ? 0.436 : -0.436, t % 3 ? 0.245 : -0.245));
    run(&cfg, zoom);
    run(&cfg, jumps);
    assert_all_inside(&cfg, zoom);
    assert_all_inside(&cfg, jumps);
    free(zoom);
    free(jumps);
}
END_TEST

/* A zoom of 1.5 a frame: C_t grows to 10^26 within a window of 150 frames, and neither solver converges. The expected
 * bound on OSQP's work, in iterations times components, is 240,000 a window, 6,000 for each emitted frame. */
START_TEST(a_window_that_does_not_converge_costs_a_bounded_number_of_iterations)
{
    static const struct {
        int window, overlap, frames;
    } cases[] = {{150, 100, 200}, {150, 149, 160}, {60, 40, 140}, {20, 19, 60}, {900, 600, 900}};
    for (int i = 0; i < 5; i++) {
        Setup cfg = defaults();
        cfg.window = cases[i].window, cfg.overlap = cases[i].overlap;
        Run *r = new_run(cases[i].frames);
        int fallbacks = 0;
        for (int t = 0; t < r->frames; t++)
            r->F[t] = l1l2_mat_similarity(1.5, 0.0, 0.0, 0.0);
        run(&cfg, r);
        for (int t = 0; t < r->frames; t++) {
            const L1L2PathSolverReport *report = &r->out[t].report;
            const bool last_window = t >= r->frames - cfg.window; /* it may be shorter, and emits all that is left */
            const int emitted = last_window ? cfg.window : cfg.window - cfg.overlap;
            const int count = last_window ? 1 : cfg.window;
            ck_assert_int_le(report->predictor_iterations, 60);
            ck_assert_int_le(report->osqp_iterations * 4 * count, emitted < 40 ? 6000 * emitted : 240000);
            fallbacks += r->out[t].fallback;
        }
        if (cfg.window >= 150)
            ck_assert_int_gt(fallbacks, 0);
        free(r);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("path_limits");
    TCase *tcase = tcase_create("path_limits");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, every_update_transform_stays_inside_whatever_the_motion);
    tcase_add_test(tcase, motions_that_no_camera_makes_give_finite_maps_inside);
    tcase_add_test(tcase, where_no_solver_converges_the_path_goes_on_without_a_jump);
    tcase_add_test(tcase, a_crop_ratio_that_changes_is_ramped_and_always_met);
    tcase_add_test(tcase, lambda_belongs_to_the_frames_that_it_was_set_for);
    tcase_add_test(tcase, a_motion_that_is_not_finite_or_not_invertible_counts_as_no_motion);
    tcase_add_test(tcase, a_zoom_of_ten_and_jumps_of_half_a_frame_are_solved);
    tcase_add_test(tcase, a_window_that_does_not_converge_costs_a_bounded_number_of_iterations);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
