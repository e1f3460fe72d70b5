/* SPDX-License-Identifier: MIT */
/* Windows, joins, cuts and ends, on camera paths that are known exactly. */
#include <stdio.h>

#include "path/path_fixture.h"

/* The largest third difference of the smooth path at the joins of windows, and elsewhere, px/frame^3. */
static void third_differences(const Run *r, int every, double *at_joins, double *inside)
{
    *at_joins = *inside = 0.0;
    for (int t = 160; t < r->frames - 160; t++) {
        const double d3 = fabs(speed_px(r, t + 1) - 2.0 * speed_px(r, t) + speed_px(r, t - 1)) +
                          fabs(r->out[t + 1].S.m[5] - 2.0 * r->out[t].S.m[5] + r->out[t - 1].S.m[5]) * diagonal_px;
        double *worst = (t + 1) % every <= 2 ? at_joins : inside;
        *worst = fmax(*worst, d3);
    }
}

START_TEST(as_many_frames_come_out_as_went_in)
{
    Setup cfg = defaults();
    cfg.window = 8, cfg.overlap = 5;
    for (int frames = 0; frames <= 40; frames++) {
        Run *r = shaky_run(frames, 1.0, 2.0, 1);
        run(&cfg, r);
        for (int t = 0; t < frames; t++) {
            ck_assert_uint_eq(r->out[t].path_index, (uint64_t)t);
            ck_assert(!r->out[t].fallback);
        }
        free(r);
    }
}
END_TEST

START_TEST(the_longest_window_and_sliding_ones_work)
{
    static const struct {
        int window, overlap, frames;
    } cases[] = {{900, 600, 1300}, {40, 39, 120}, {4, 3, 60}, {5, 3, 60}};
    for (int i = 0; i < 4; i++) {
        Setup cfg = defaults();
        cfg.window = cases[i].window, cfg.overlap = cases[i].overlap;
        Run *r = shaky_run(cases[i].frames, 0.7, 4.0, 3);
        run(&cfg, r);
        for (int t = 0; t < r->frames; t++)
            ck_assert(!r->out[t].fallback);
        free(r);
    }
}
END_TEST

START_TEST(a_constant_path_is_returned_unchanged)
{
    Setup cfg = defaults();
    Run *r = new_run(400);
    for (int join = 0; join < 2; join++) {
        cfg.join = (L1L2StabJoin)join;
        cfg.overlap = join == L1L2STAB_JOIN_BLEND ? 30 : 100;
        run(&cfg, r);
        const L1L2Mat identity = l1l2_mat_identity();
        for (int t = 0; t < r->frames; t++)
            ck_assert_near(l1l2_mat_corner_distance(&r->out[t].B, &identity, 0.5, 0.5), 0.0, 1e-6);
    }
    free(r);
}
END_TEST

START_TEST(a_steady_pan_keeps_its_speed_by_the_defaults)
{
    static const double speeds[] = {0.2, 0.5, 1.0, 2.0}, tolerance[] = {0.2, 0.05, 0.05, 0.05};
    const Setup cfg = defaults();
    for (int i = 0; i < 4; i++) {
        Run *r = shaky_run(750, speeds[i], 0.0, 1); /* windows every 50 frames: 10 after the first */
        run(&cfg, r);
        for (int t = 150; t < 600; t++)
            ck_assert_near(speed_px(r, t) / speeds[i], 1.0, tolerance[i]);
        free(r);
    }
}
END_TEST

START_TEST(shake_on_a_steady_pan_is_removed)
{
    const Setup cfg = defaults();
    Run *r = shaky_run(600, 1.0, 6.0, 5);
    run(&cfg, r);
    double acceleration = 0.0;
    for (int t = 151; t < 450; t++)
        acceleration += fabs(speed_px(r, t) - speed_px(r, t - 1)) / 299.0;
    ck_assert_msg(acceleration < 0.05, "mean acceleration left %g px/frame^2, shake +-6 px", acceleration);
    free(r);
}
END_TEST

START_TEST(a_shaky_still_camera_gives_constant_pieces)
{
    const Setup cfg = defaults();
    Run *r = shaky_run(600, 0.0, 3.0, 9);
    run(&cfg, r);
    int still = 0;
    for (int t = 1; t < r->frames; t++)
        still += fabs(r->out[t].S.m[2]) < 1e-7 && fabs(r->out[t].S.m[5]) < 1e-7;
    ck_assert_int_gt(still, r->frames / 2);
    free(r);
}
END_TEST

START_TEST(the_continuous_join_has_no_seam_and_blend_is_rougher)
{
    double at_joins[2], inside[2];
    for (int join = 0; join < 2; join++) {
        Setup cfg = defaults();
        cfg.join = (L1L2StabJoin)join;
        cfg.overlap = join == L1L2STAB_JOIN_BLEND ? 30 : 100;
        Run *r = drifting_run(1500, 0.7, 40.0, 4.0, 3);
        run(&cfg, r);
        third_differences(r, cfg.window - cfg.overlap, &at_joins[join], &inside[join]);
        free(r);
    }
    ck_assert_msg(at_joins[0] <= inside[0], "continuous: %g at joins, %g inside", at_joins[0], inside[0]);
    ck_assert_msg(at_joins[0] < 0.25 * at_joins[1], "blend %g, continuous %g at joins", at_joins[1], at_joins[0]);
}
END_TEST

START_TEST(a_cut_ends_one_path_and_starts_another)
{
    const Setup cfg = defaults();
    Run *both = shaky_run(500, 1.0, 4.0, 2), *first = shaky_run(230, 1.0, 4.0, 2), *second = new_run(270);
    both->starts[230] = true;
    for (int t = 0; t < 270; t++)
        second->F[t] = both->F[230 + t];
    run(&cfg, both);
    run(&cfg, first);
    run(&cfg, second);
    for (int t = 0; t < 500; t++) { /* as if each were a video of its own */
        const L1L2PathFrame *alone = t < 230 ? &first->out[t] : &second->out[t - 230];
        ck_assert_mem_eq(both->out[t].B.m, alone->B.m, sizeof alone->B.m);
        ck_assert_uint_eq(both->out[t].path_index, alone->path_index);
    }
    ck_assert(l1l2_mat_is_identity(&both->out[230].S));
    free(both);
    free(first);
    free(second);
}
END_TEST

START_TEST(cuts_at_every_place_in_a_window_lose_no_frame)
{
    Setup cfg = defaults();
    cfg.window = 10, cfg.overlap = 6;
    for (int cut = 1; cut < 30; cut++)
        for (int next = 1; next < 4; next++) {
            Run *r = shaky_run(40, 1.0, 4.0, 2);
            r->starts[cut] = r->starts[cut + next] = true;
            run(&cfg, r);
            ck_assert_uint_eq(r->out[cut].path_index, 0);
            ck_assert_uint_eq(r->out[cut + next].path_index, 0);
            ck_assert_uint_eq(r->out[cut + next + 1].path_index, 1);
            free(r);
        }
}
END_TEST

START_TEST(lambda_means_the_same_at_every_frame_rate)
{
    /* The same walk sampled at 30 and at 60 frames/s; window and overlap doubled, as the documentation says. */
    Setup slow = defaults(), fast = defaults();
    fast.frame_rate = 60, fast.window = 300, fast.overlap = 200;
    Run *a = new_run(600), *b = new_run(1200);
    L1L2Mat before = l1l2_mat_identity(), inverse;
    for (int t = 0; t < 1200; t++) {
        const double s = t / 60.0;
        const L1L2Mat pose = l1l2_mat_translation(
            (30.0 * s + 6.0 * sin(11.0 * s) + 3.0 * sin(23.0 * s)) / diagonal_px, 5.0 * sin(13.0 * s) / diagonal_px);
        l1l2_mat_inverse(before, &inverse);
        b->F[t] = l1l2_mat_mul(inverse, pose);
        before = pose;
    }
    for (int t = 0; t < 600; t++)
        a->F[t] = t == 0 ? b->F[0] : l1l2_mat_mul(b->F[2 * t - 1], b->F[2 * t]);
    run(&slow, a);
    run(&fast, b);
    double rms = 0.0;
    for (int t = 0; t < 600; t++)
        rms += pow(diagonal_px * l1l2_mat_corner_distance(&a->out[t].B, &b->out[2 * t].B, 0.436, 0.245), 2) / 600.0;
    printf("the same walk at 30 and 60 frames/s: %.3f px rms between the two paths\n", sqrt(rms));
    ck_assert_msg(sqrt(rms) < 1.0, "paths at 30 and 60 frames/s differ by %g px rms", sqrt(rms));
    free(a);
    free(b);
}
END_TEST

START_TEST(a_reset_path_is_as_good_as_new)
{
    const Setup cfg = defaults();
    Run *r = shaky_run(330, 1.0, 4.0, 6), *fresh = shaky_run(330, 1.0, 4.0, 6);
    run(&cfg, fresh);
    L1L2Path *path = new_path(&cfg, r);
    for (int t = 0; t < 140; t++)
        push(path, &cfg, &r->F[139 - t], false);
    l1l2_path_reset(path);
    int pulled = 0;
    for (int t = 0; t < r->frames; t++) {
        push(path, &cfg, &r->F[t], false);
        if (t - pulled + 1 == cfg.window)
            ck_assert(pull(path, r, pulled++));
    }
    for (int t = 0; t < pulled; t++)
        ck_assert_mem_eq(r->out[t].B.m, fresh->out[t].B.m, sizeof fresh->out[t].B.m);
    l1l2_path_free(path);
    free(r);
    free(fresh);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("path");
    TCase *tcase = tcase_create("path");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, as_many_frames_come_out_as_went_in);
    tcase_add_test(tcase, the_longest_window_and_sliding_ones_work);
    tcase_add_test(tcase, a_constant_path_is_returned_unchanged);
    tcase_add_test(tcase, a_steady_pan_keeps_its_speed_by_the_defaults);
    tcase_add_test(tcase, shake_on_a_steady_pan_is_removed);
    tcase_add_test(tcase, a_shaky_still_camera_gives_constant_pieces);
    tcase_add_test(tcase, the_continuous_join_has_no_seam_and_blend_is_rougher);
    tcase_add_test(tcase, a_cut_ends_one_path_and_starts_another);
    tcase_add_test(tcase, cuts_at_every_place_in_a_window_lose_no_frame);
    tcase_add_test(tcase, lambda_means_the_same_at_every_frame_rate);
    tcase_add_test(tcase, a_reset_path_is_as_good_as_new);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
