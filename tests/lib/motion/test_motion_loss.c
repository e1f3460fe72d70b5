/* SPDX-License-Identifier: MIT */
/* Frames whose motion cannot be measured, or only in part: model selection, path starts, and frames of any size. */
#include "motion/motion_fixture.h"

START_TEST(black_frames_are_predicted_from_a_fading_motion_and_then_taken_as_still)
{
    SynthConfig cfg = synth_defaults();
    cfg.shake = cfg.roll = 0.0;
    cfg.pan_x = 10.0;
    Run run = run_new(&cfg);
    for (int t = 0; t < 10; t++)
        push_frame(&run, t);
    double before = 10.0;
    L1L2StabMotionSource last = L1L2STAB_MOTION_SOURCE_PREDICTED;
    for (int i = 0; i < 40; i++) {
        const L1L2MotionResult r = push_flat(&run, 16);
        const L1L2Mat F = in_pixels(&run, &r.F);
        ck_assert(r.model == last ||
                  (last == L1L2STAB_MOTION_SOURCE_PREDICTED && r.model == L1L2STAB_MOTION_SOURCE_IDENTITY));
        ck_assert_double_le(F.m[2], 0.9 * before);
        ck_assert_double_ge(F.m[2], 0.0);
        ck_assert(r.model == L1L2STAB_MOTION_SOURCE_PREDICTED || l1l2_mat_is_identity(&r.F));
        ck_assert_int_eq(r.inliers, 0);
        before = F.m[2];
        last = r.model;
    }
    ck_assert_int_eq(last, L1L2STAB_MOTION_SOURCE_IDENTITY);
    ck_assert_int_eq(warnings, 1); /* once, not for each frame */
    /* No point of a black frame can be tracked into the next. After that all is as before. */
    ck_assert_int_lt(push_frame(&run, 50).model, L1L2STAB_MOTION_SOURCE_TRANSLATION);
    for (int t = 51; t < 60; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert_int_eq(r.model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
        ck_assert_double_le(error_at(&run, &r, t), 0.1);
    }
    ck_assert_int_eq(warnings, 1);
    push_flat(&run, 235);
    ck_assert_int_eq(warnings, 2); /* another loss, another warning */
    run_free(&run);
}
END_TEST

START_TEST(a_frame_that_is_another_scene_is_not_measured)
{
    SynthConfig cfg = synth_defaults(), other_cfg = cfg;
    other_cfg.seed = 77;
    Run run = run_new(&cfg);
    Synth *other = synth_new(&other_cfg);
    for (int t = 0; t < 10; t++)
        push_frame(&run, t);
    synth_render_gray(other, 10, run.picture.data[0], run.picture.stride[0]);
    ck_assert_int_lt(push(run.motion, &run.picture, false).model, L1L2STAB_MOTION_SOURCE_TRANSLATION);
    for (int t = 11; t < 20; t++) {
        synth_render_gray(other, t, run.picture.data[0], run.picture.stride[0]);
        ck_assert_int_eq(push(run.motion, &run.picture, false).model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    }
    synth_free(other);
    run_free(&run);
}
END_TEST

START_TEST(after_a_reset_the_first_measured_frame_knows_no_picture_before_it)
{
    SynthConfig cfg = synth_defaults(), other_cfg = cfg;
    other_cfg.seed = 77;
    Run run = run_new(&cfg);
    Synth *other = synth_new(&other_cfg);
    L1L2MotionResult expected[3];
    for (int before = 0; before <= 20; before += 20) { /* frames of another clip before the reset */
        for (int t = 0; t < before; t++)
            push_frame(&run, t);
        l1l2_motion_reset(run.motion);
        for (int t = 0; t < 3; t++) { /* as after frames whose motion was given: no path starts */
            synth_render_gray(other, t, run.picture.data[0], run.picture.stride[0]);
            const L1L2MotionResult r = push(run.motion, &run.picture, false);
            ck_assert_int_eq(r.model, t == 0 ? L1L2STAB_MOTION_SOURCE_IDENTITY : L1L2STAB_MOTION_SOURCE_SIMILARITY);
            if (before == 0)
                expected[t] = r;
            ck_assert_mem_eq(&r.F, &expected[t].F, sizeof r.F);
        }
    }
    synth_free(other);
    run_free(&run);
}
END_TEST

/* Gray, with a small textured patch of `size` px in its middle. */
static L1L2MotionResult push_patch(Run *run, int t, int size)
{
    synth_render_gray(run->synth, t, run->picture.data[0], run->picture.stride[0]);
    for (int y = 0; y < run->cfg.height; y++)
        for (int x = 0; x < run->cfg.width; x++)
            if (abs(x - run->cfg.width / 2) > size / 2 || abs(y - run->cfg.height / 2) > size / 2)
                run->picture.data[0][run->picture.stride[0] * y + x] = 128;
    return push(run->motion, &run->picture, t == 0);
}

START_TEST(a_few_points_in_one_place_give_a_translation)
{
    SynthConfig cfg = synth_defaults();
    cfg.shake = 3.0;
    cfg.roll = 0.0;
    Run run = run_new(&cfg);
    int translations = 0;
    for (int t = 0; t < 20; t++) {
        const L1L2MotionResult r = push_patch(&run, t, 70);
        if (r.model != L1L2STAB_MOTION_SOURCE_TRANSLATION)
            continue;
        translations++;
        ck_assert(r.F.m[0] == 1.0 && r.F.m[3] == 0.0);
        ck_assert_double_le(error_at(&run, &r, t), 1.0);
    }
    ck_assert_int_ge(translations, 15);
    run_free(&run);
}
END_TEST

START_TEST(a_path_start_has_no_motion_and_the_next_frame_is_measured_from_it)
{
    const SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    for (int t = 0; t < 5; t++)
        push_frame(&run, t);
    synth_render_gray(run.synth, 200, run.picture.data[0], run.picture.stride[0]);
    L1L2MotionResult r = push(run.motion, &run.picture, true);
    ck_assert_int_eq(r.model, L1L2STAB_MOTION_SOURCE_NONE);
    ck_assert(l1l2_mat_is_identity(&r.F));
    r = push_frame(&run, 201);
    ck_assert_int_eq(r.model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    ck_assert_double_le(error_at(&run, &r, 201), 0.1);
    run_free(&run);
}
END_TEST

START_TEST(frames_of_any_size_do_no_harm)
{
    static const int sizes[][2] = {{16, 16}, {33, 17}, {8000, 16}, {16, 8000}, {64, 48}};
    SynthConfig cfg = synth_defaults();
    cfg.width = sizes[_i][0], cfg.height = sizes[_i][1];
    cfg.shake = 0.5;
    Run run = run_new(&cfg);
    for (int t = 0; t < 12; t++)
        push_frame(&run, t);
    for (int i = 0; i < 3; i++)
        push_flat(&run, 255 * i / 2);
    run_free(&run);
}
END_TEST

START_TEST(a_motion_that_no_camera_makes_is_not_accepted)
{
    SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    push_turned(&run, 0, 0.0, 1.35);
    ck_assert_int_ne(push_turned(&run, 1, 0.0, 1.35).model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    l1l2_motion_reset(run.motion);
    push_turned(&run, 0, 0.0, 1.15);
    ck_assert_int_eq(push_turned(&run, 1, 0.0, 1.15).model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    l1l2_motion_reset(run.motion);
    push_turned(&run, 0, 0.3, 1.0);
    ck_assert_int_ne(push_turned(&run, 1, 0.3, 1.0).model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
    run_free(&run);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_loss");
    TCase *tc = tcase_create("motion_loss");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, black_frames_are_predicted_from_a_fading_motion_and_then_taken_as_still);
    tcase_add_test(tc, after_a_reset_the_first_measured_frame_knows_no_picture_before_it);
    tcase_add_test(tc, a_frame_that_is_another_scene_is_not_measured);
    tcase_add_test(tc, a_few_points_in_one_place_give_a_translation);
    tcase_add_test(tc, a_path_start_has_no_motion_and_the_next_frame_is_measured_from_it);
    tcase_add_loop_test(tc, frames_of_any_size_do_no_harm, 0, 5);
    tcase_add_test(tc, a_motion_that_no_camera_makes_is_not_accepted);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
