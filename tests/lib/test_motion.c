/* SPDX-License-Identifier: MIT */
/* Measured motion against the truth of synthetic clips. Errors are the root mean square over the frame's four corners,
 * in pixels of the frame. */
#include <string.h>

#include "checkx.h"
#include "motion.h"
#include "synth.h"

static const double degree = 3.14159265358979 / 180.0;

static int warnings;

static void count_warning(void *cookie, L1L2StabLogLevel level, const char *message)
{
    warnings += level == L1L2STAB_LOG_WARN;
}

static const L1L2StabLogger logger = {count_warning, NULL, L1L2STAB_LOG_TRACE};

/* A clip and the motion that is measured in it. */
typedef struct Run {
    SynthConfig cfg;
    Synth *synth;
    SynthPicture picture;
    L1L2Motion *motion;
} Run;

static L1L2Motion *motion_new(int width, int height, int components, L1L2Luma luma)
{
    const L1L2MotionConfig cfg = {width, height, components, luma, 640, 1, &logger};
    L1L2Motion *m;
    ck_assert_int_eq(l1l2_motion_create(&m, &cfg), L1L2STAB_OK);
    return m;
}

static Run run_new(const SynthConfig *cfg)
{
    warnings = 0;
    return (Run){*cfg, synth_new(cfg), synth_picture_new(L1L2STAB_FORMAT_GRAY8, cfg->width, cfg->height),
                 motion_new(cfg->width, cfg->height, 1, L1L2_LUMA_PLANE)};
}

static void run_free(Run *run)
{
    l1l2_motion_free(run->motion);
    synth_picture_free(&run->picture);
    synth_free(run->synth);
}

/* Every result is usable, whatever the picture. */
static L1L2MotionResult push(L1L2Motion *m, const SynthPicture *p, bool starts_path)
{
    L1L2MotionResult r;
    L1L2Mat inverse;
    ck_assert_int_eq(l1l2_motion_push(m, p->data[0], p->stride[0], starts_path, &r), L1L2STAB_OK);
    ck_assert(l1l2_mat_is_finite(&r.F));
    ck_assert(l1l2_mat_inverse(r.F, &inverse));
    ck_assert_int_le(r.inliers, r.tracks);
    ck_assert(r.scale_ns >= 0 && r.track_ns >= 0 && r.fit_ns >= 0);
    return r;
}

static L1L2MotionResult push_frame(Run *run, int t)
{
    synth_render_gray(run->synth, t, run->picture.data[0], run->picture.stride[0]);
    return push(run->motion, &run->picture, t == 0);
}

static L1L2MotionResult push_flat(Run *run, int level)
{
    memset(run->picture.data[0], level, run->picture.size);
    return push(run->motion, &run->picture, false);
}

static double corner_rms(const L1L2Mat *a, const L1L2Mat *b, const SynthConfig *cfg)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {(k & 1 ? 0.5 : -0.5) * cfg->width, (k & 2 ? 0.5 : -0.5) * cfg->height};
        const L1L2Point p = l1l2_mat_apply(a, u), q = l1l2_mat_apply(b, u);
        sum += (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
    }
    return sqrt(0.25 * sum);
}

static L1L2Mat in_pixels(const Run *run, const L1L2Mat *F)
{
    return l1l2_mat_rescale(*F, hypot(run->cfg.width, run->cfg.height));
}

static L1L2Mat truth(const Run *run, int t)
{
    L1L2Mat F;
    synth_motion(run->synth, t, F.m);
    return F;
}

static double error_at(const Run *run, const L1L2MotionResult *r, int t)
{
    const L1L2Mat F = in_pixels(run, &r->F), true_F = truth(run, t);
    return corner_rms(&F, &true_F, &run->cfg);
}

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
        ck_assert_int_eq(r.model, t ? L1L2STAB_MODEL_SIMILARITY : L1L2STAB_MODEL_NONE);
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
        ck_assert_int_eq(r.model, L1L2STAB_MODEL_SIMILARITY);
        ck_assert_double_le(corner_rms(&F, &identity, &cfg), 0.002);
    }
    run_free(&run);
}
END_TEST

START_TEST(black_frames_are_predicted_from_a_fading_motion_and_then_taken_as_still)
{
    SynthConfig cfg = synth_defaults();
    cfg.shake = cfg.roll = 0.0;
    cfg.pan_x = 10.0;
    Run run = run_new(&cfg);
    for (int t = 0; t < 10; t++)
        push_frame(&run, t);
    double before = 10.0;
    L1L2StabModel last = L1L2STAB_MODEL_PREDICTED;
    for (int i = 0; i < 40; i++) {
        const L1L2MotionResult r = push_flat(&run, 16);
        const L1L2Mat F = in_pixels(&run, &r.F);
        ck_assert(r.model == last || (last == L1L2STAB_MODEL_PREDICTED && r.model == L1L2STAB_MODEL_IDENTITY));
        ck_assert_double_le(F.m[2], 0.9 * before);
        ck_assert_double_ge(F.m[2], 0.0);
        ck_assert(r.model == L1L2STAB_MODEL_PREDICTED || l1l2_mat_is_identity(&r.F));
        ck_assert_int_eq(r.inliers, 0);
        before = F.m[2];
        last = r.model;
    }
    ck_assert_int_eq(last, L1L2STAB_MODEL_IDENTITY);
    ck_assert_int_eq(warnings, 1); /* once, not for each frame */
    /* From black to the scene nothing can be followed; from there on, all is as before. */
    ck_assert_int_lt(push_frame(&run, 50).model, L1L2STAB_MODEL_TRANSLATION);
    for (int t = 51; t < 60; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert_int_eq(r.model, L1L2STAB_MODEL_SIMILARITY);
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
    ck_assert_int_lt(push(run.motion, &run.picture, false).model, L1L2STAB_MODEL_TRANSLATION);
    for (int t = 11; t < 20; t++) {
        synth_render_gray(other, t, run.picture.data[0], run.picture.stride[0]);
        ck_assert_int_eq(push(run.motion, &run.picture, false).model, L1L2STAB_MODEL_SIMILARITY);
    }
    synth_free(other);
    run_free(&run);
}
END_TEST

/* Grey, with a small textured patch of `size` px in its middle. */
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
        if (r.model != L1L2STAB_MODEL_TRANSLATION)
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
    ck_assert_int_eq(r.model, L1L2STAB_MODEL_NONE);
    ck_assert(l1l2_mat_is_identity(&r.F));
    r = push_frame(&run, 201);
    ck_assert_int_eq(r.model, L1L2STAB_MODEL_SIMILARITY);
    ck_assert_double_le(error_at(&run, &r, 201), 0.1);
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
    L1L2Motion *other = motion_new(cfg.width, cfg.height, 1, L1L2_LUMA_PLANE);
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
    static const L1L2Luma lumas[] = {L1L2_LUMA_BGR, L1L2_LUMA_RGB, L1L2_LUMA_BGR, L1L2_LUMA_RGB};
    const SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    SynthPicture packed = synth_picture_new(formats[_i], cfg.width, cfg.height);
    L1L2Motion *motion = motion_new(cfg.width, cfg.height, _i < 2 ? 3 : 4, lumas[_i]);
    for (int t = 0; t < 15; t++) {
        const L1L2MotionResult grey = push_frame(&run, t);
        synth_render(run.synth, t, packed.format, packed.data, packed.stride);
        const L1L2MotionResult colour = push(motion, &packed, t == 0);
        const L1L2Mat a = in_pixels(&run, &grey.F), b = in_pixels(&run, &colour.F);
        ck_assert_double_le(corner_rms(&a, &b, &cfg), 0.05);
    }
    l1l2_motion_free(motion);
    synth_picture_free(&packed);
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

/* Frame t is frame 0 turned and scaled t times about its centre. */
static L1L2MotionResult push_turned(Run *run, int t, double angle, double scale)
{
    const double zoom = pow(scale, t), a = zoom * cos(angle * t), b = zoom * sin(angle * t);
    const double M[9] = {a, -b, 0.0, b, a, 0.0, 0.0, 0.0, 1.0};
    synth_render_view(run->synth, M, run->cfg.width, run->cfg.height, run->picture.format, run->picture.data,
                      run->picture.stride);
    return push(run->motion, &run->picture, t == 0);
}

START_TEST(a_turn_about_the_centre_leaves_the_centre_where_it_is)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 1920, cfg.height = 1080;
    Run run = run_new(&cfg);
    double x = 0.0, y = 0.0; /* with the centre half a tracked pixel off, these would be 0.15 px */
    for (int t = 0; t < 9; t++) {
        const L1L2MotionResult r = push_turned(&run, t, 0.1, 1.0);
        const L1L2Mat F = in_pixels(&run, &r.F);
        ck_assert(t == 0 || r.model == L1L2STAB_MODEL_SIMILARITY);
        ck_assert_near(atan2(F.m[3], F.m[0]), t ? 0.1 : 0.0, 2e-4);
        x += F.m[2] / 8.0;
        y += F.m[5] / 8.0;
    }
    ck_assert_near(x, 0.0, 0.08);
    ck_assert_near(y, 0.0, 0.08);
    run_free(&run);
}
END_TEST

START_TEST(a_motion_that_no_camera_makes_is_not_believed)
{
    SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    push_turned(&run, 0, 0.0, 1.35);
    ck_assert_int_ne(push_turned(&run, 1, 0.0, 1.35).model, L1L2STAB_MODEL_SIMILARITY);
    l1l2_motion_reset(run.motion);
    push_turned(&run, 0, 0.0, 1.15);
    ck_assert_int_eq(push_turned(&run, 1, 0.0, 1.15).model, L1L2STAB_MODEL_SIMILARITY);
    l1l2_motion_reset(run.motion);
    push_turned(&run, 0, 0.3, 1.0);
    ck_assert_int_ne(push_turned(&run, 1, 0.3, 1.0).model, L1L2STAB_MODEL_SIMILARITY);
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

START_TEST(a_thumbnail_is_measured_too)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 96, cfg.height = 64;
    cfg.shake = 1.0;
    Run run = run_new(&cfg);
    for (int t = 0; t < 30; t++) {
        const L1L2MotionResult r = push_frame(&run, t);
        ck_assert(t == 0 || r.model == L1L2STAB_MODEL_SIMILARITY);
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
    tcase_add_test(tc, black_frames_are_predicted_from_a_fading_motion_and_then_taken_as_still);
    tcase_add_test(tc, a_frame_that_is_another_scene_is_not_measured);
    tcase_add_test(tc, a_few_points_in_one_place_give_a_translation);
    tcase_add_test(tc, a_path_start_has_no_motion_and_the_next_frame_is_measured_from_it);
    tcase_add_test(tc, two_instances_and_a_reset_one_give_equal_bits);
    tcase_add_loop_test(tc, packed_pictures_give_nearly_the_motion_of_their_luma, 0, 4);
    tcase_add_loop_test(tc, frames_of_any_size_do_no_harm, 0, 5);
    tcase_add_test(tc, a_turn_about_the_centre_leaves_the_centre_where_it_is);
    tcase_add_test(tc, a_motion_that_no_camera_makes_is_not_believed);
    tcase_add_test(tc, new_points_come_every_ten_frames);
    tcase_add_test(tc, a_thumbnail_is_measured_too);
    tcase_add_test(tc, sides_that_scale_unequally_do_not_bend_the_motion);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
