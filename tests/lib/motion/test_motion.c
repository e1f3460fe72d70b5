/* SPDX-License-Identifier: MIT */
/* Measured motion against the truth of synthetic clips. */
#include "motion/motion_fixture.h"

static const double degree = 3.14159265358979 / 180.0;

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* shake, roll, zoom, noise, foreground, pan; then the bounds. */
typedef struct Case {
    const char *name;
    SynthConfig cfg;
    double median, worst; /* px */
} Case;

#define SMALL .width = 640, .height = 360, .fps = 30.0, .seed = 1
#define LARGE .width = 1280, .height = 720, .fps = 30.0, .seed = 1

static const Case cases[] = {
    {"tripod, nearly", {SMALL, .shake = 0.5, .roll = 0.001}, 0.02, 0.06},
    {"hand", {SMALL, .shake = 4, .roll = 0.005, .zoom = 0.01}, 0.02, 0.06},
    {"hand, noise of 5", {SMALL, .shake = 4, .roll = 0.005, .zoom = 0.01, .noise = 5}, 0.02, 0.08},
    {"run", {SMALL, .shake = 20, .roll = 0.01}, 0.02, 0.08},
    {"roll of 3 degrees", {SMALL, .shake = 4, .roll = 0.0524, .noise = 2}, 0.02, 0.08},
    {"zoom of 5 percent", {SMALL, .shake = 4, .zoom = 0.025, .noise = 2}, 0.02, 0.08},
    {"fast pan", {SMALL, .shake = 4, .roll = 0.005, .pan_x = 60, .pan_y = 10, .noise = 2}, 0.03, 0.1},
    {"large thing goes by", {SMALL, .shake = 4, .roll = 0.005, .noise = 2, .foreground = 0.35}, 0.03, 0.1},
    {"tripod, nearly, 720p", {LARGE, .shake = 1, .roll = 0.001, .noise = 2}, 0.05, 0.15},
    {"hand, 720p", {LARGE, .shake = 8, .roll = 0.005, .zoom = 0.01}, 0.05, 0.15},
    {"hand, noise of 5, 720p", {LARGE, .shake = 8, .roll = 0.005, .zoom = 0.01, .noise = 5}, 0.05, 0.15},
};

START_TEST(the_motion_is_measured_to_a_fraction_of_a_pixel)
{
    enum { FRAMES = 40 };
    const Case *c = &cases[_i];
    Run run = run_new(&c->cfg);
    double error[FRAMES];
    for (int t = 0; t < FRAMES; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert_int_eq(r.model, t ? L1L2STAB_MOTION_SOURCE_SIMILARITY : L1L2STAB_MOTION_SOURCE_NONE);
        error[t] = t ? error_at(&run, &r, t) : 0.0;
    }
    qsort(error, FRAMES, sizeof error[0], ascending);
    ck_assert_double_le(error[FRAMES / 2], c->median);
    ck_assert_double_le(error[FRAMES - 1], c->worst);
    ck_assert_int_eq(warnings, 0);
    run_free(&run);
}
END_TEST

START_TEST(the_path_of_a_hundred_frames_drifts_by_less_than_half_a_pixel)
{
    SynthConfig cfg = synth_defaults();
    cfg.noise = 3.0;
    cfg.zoom = 0.01;
    cfg.pan_x = 1.5;
    Run run = run_new(&cfg);
    L1L2Mat C = l1l2_mat_identity(), true_C = C;
    for (int t = 0; t <= 100; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        C = l1l2_mat_mul(C, in_pixels(&run, &r.F));
        true_C = l1l2_mat_mul(true_C, truth(&run, t));
    }
    ck_assert_double_le(corner_rms(&C, &true_C, &cfg), 0.5);
    run_free(&run);
}
END_TEST

START_TEST(a_clip_that_repeats_its_frames_has_no_motion_there)
{
    const SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    for (int t = 0; t < 20; t++) {
        L1L2MotionResult r = push_frame(&run, t);
        r = push(run.motion, &run.picture, false);
        const L1L2Mat F = in_pixels(&run, &r.F), identity = l1l2_mat_identity();
        ck_assert_int_eq(r.model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
        ck_assert_double_le(corner_rms(&F, &identity, &cfg), 0.002);
    }
    run_free(&run);
}
END_TEST

START_TEST(two_instances_and_a_reset_one_give_equal_bits)
{
    enum { FRAMES = 25 };
    SynthConfig cfg = synth_defaults();
    cfg.noise = 12.0;
    cfg.foreground = 0.5;
    Run run = run_new(&cfg);
    L1L2Motion *other = motion_new(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
    L1L2MotionResult first[FRAMES];
    for (int t = 0; t < FRAMES; t++) {
        first[t] = push_frame(&run, t);
        const L1L2MotionResult r = push(other, &run.picture, t == 0);
        ck_assert_mem_eq(&r.F, &first[t].F, sizeof r.F);
        ck_assert_int_eq(r.inliers, first[t].inliers);
    }
    l1l2_motion_reset(run.motion);
    for (int t = 0; t < FRAMES; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert_mem_eq(&r.F, &first[t].F, sizeof r.F);
        ck_assert_int_eq(r.tracks, first[t].tracks);
    }
    l1l2_motion_free(other);
    run_free(&run);
}
END_TEST

START_TEST(packed_pictures_give_nearly_the_motion_of_their_luma)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_BGR, L1L2STAB_FORMAT_RGB, L1L2STAB_FORMAT_BGRX,
                                             L1L2STAB_FORMAT_RGBA};
    const SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    SynthPicture packed = synth_picture_new(formats[_i], cfg.width, cfg.height);
    L1L2Motion *motion = motion_new(cfg.width, cfg.height, formats[_i]);
    for (int t = 0; t < 15; t++) {
        const L1L2MotionResult gray = push_frame(&run, t);
        synth_render(run.synth, t, packed.format, packed.data, packed.stride);
        const L1L2MotionResult color = push(motion, &packed, t == 0);
        const L1L2Mat a = in_pixels(&run, &gray.F), b = in_pixels(&run, &color.F);
        ck_assert_double_le(corner_rms(&a, &b, &cfg), 0.05);
    }
    l1l2_motion_free(motion);
    synth_picture_free(&packed);
    run_free(&run);
}
END_TEST

START_TEST(a_rotation_about_the_center_does_not_move_the_center)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 1920, cfg.height = 1080;
    Run run = run_new(&cfg);
    double x = 0.0, y = 0.0; /* with the center half a tracked pixel off, these would be 0.15 px */
    for (int t = 0; t < 9; t++) {
        const L1L2MotionResult r = push_turned(&run, t, 0.1, 1.0);
        const L1L2Mat F = in_pixels(&run, &r.F);
        ck_assert(t == 0 || r.model == L1L2STAB_MOTION_SOURCE_SIMILARITY);
        ck_assert_near(atan2(F.m[3], F.m[0]), t ? 0.1 : 0.0, 2e-4);
        x += F.m[2] / 8.0;
        y += F.m[5] / 8.0;
    }
    ck_assert_near(x, 0.0, 0.08);
    ck_assert_near(y, 0.0, 0.08);
    run_free(&run);
}
END_TEST

START_TEST(new_points_come_every_ten_frames)
{
    SynthConfig cfg = synth_defaults();
    cfg.pan_x = 8.0;
    Run run = run_new(&cfg);
    int tracks[32] = {0};
    for (int t = 0; t < 32; t++)
        tracks[t] = push_frame(&run, t).tracks;
    for (int t = 11; t < 32; t += 10) { /* the points of frame t - 1 are chosen anew when frame t comes */
        ck_assert_int_gt(tracks[t], tracks[t - 1] + 5);
        for (int i = 1; i < 9; i++)
            ck_assert_int_le(tracks[t - i], tracks[t - i - 1]);
    }
    run_free(&run);
}
END_TEST

START_TEST(a_tiny_picture_is_measured_too)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 96, cfg.height = 64;
    cfg.shake = 1.0;
    Run run = run_new(&cfg);
    for (int t = 0; t < 30; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert(t == 0 || r.model == L1L2STAB_MOTION_SOURCE_SIMILARITY);
        ck_assert_double_le(error_at(&run, &r, t), 0.1);
    }
    run_free(&run);
}
END_TEST

START_TEST(sides_that_scale_unequally_do_not_bend_the_motion)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 2000, cfg.height = 64; /* 640 x 32 */
    cfg.shake = 4.0;
    cfg.roll = 0.5 * degree;
    Run run = run_new(&cfg);
    for (int t = 0; t < 20; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert_double_le(error_at(&run, &r, t), 0.3);
    }
    run_free(&run);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion");
    TCase *tc = tcase_create("motion");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, the_motion_is_measured_to_a_fraction_of_a_pixel, 0, sizeof cases / sizeof cases[0]);
    tcase_add_test(tc, the_path_of_a_hundred_frames_drifts_by_less_than_half_a_pixel);
    tcase_add_test(tc, a_clip_that_repeats_its_frames_has_no_motion_there);
    tcase_add_test(tc, two_instances_and_a_reset_one_give_equal_bits);
    tcase_add_loop_test(tc, packed_pictures_give_nearly_the_motion_of_their_luma, 0, 4);
    tcase_add_test(tc, a_rotation_about_the_center_does_not_move_the_center);
    tcase_add_test(tc, new_points_come_every_ten_frames);
    tcase_add_test(tc, a_tiny_picture_is_measured_too);
    tcase_add_test(tc, sides_that_scale_unequally_do_not_bend_the_motion);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
