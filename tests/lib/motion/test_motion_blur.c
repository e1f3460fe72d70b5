/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "motion/motion_blur.h"
#include "synth_hard.h"

enum { WIDTH = 640, HEIGHT = 360, SHARP = 1, BLURRED = 3 };

static SynthHard *clip;
static SynthHardConfig cfg;
static L1L2FloatPyramid *sharp, *blurred;

static void open_clip(void)
{
    cfg = synth_hard_case_named("blur 20 px")->cfg;
    cfg.shake = 1.0;
    clip = synth_hard_new(&cfg);
    sharp = l1l2_image_float_pyramid_new(WIDTH, HEIGHT);
    blurred = l1l2_image_float_pyramid_new(WIDTH, HEIGHT);
}

static void close_clip(void)
{
    synth_hard_free(clip);
    l1l2_image_float_pyramid_free(sharp);
    l1l2_image_float_pyramid_free(blurred);
}

static void show(L1L2FloatPyramid *p, int t)
{
    static uint8_t picture[WIDTH * HEIGHT];
    synth_hard_render(clip, t, picture, WIDTH);
    l1l2_image_float_pyramid_build(p, picture, WIDTH);
}

static L1L2MotionBlur measure(double length, double noise)
{
    /* Of white noise, the shrinking and the blur of the pyramid leave this part. */
    const double left = 0.118;
    cfg.jerk_px = length, cfg.noise = noise;
    synth_hard_change(clip, &cfg);
    show(sharp, SHARP);
    show(blurred, BLURRED);
    return l1l2_motion_blur_measure(blurred, sharp, left * noise);
}

START_TEST(length_and_direction_are_found)
{
    static const struct {
        double length, tolerance, noise;
    } cases[] = {{10.0, 2.0, 0.0}, {20.0, 3.0, 5.0}, {40.0, 9.0, 2.0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const L1L2MotionBlur blur = measure(cases[k].length, cases[k].noise);
        double x, y;
        synth_hard_blur(clip, BLURRED, &x, &y);
        ck_assert_near(hypot(x, y), cases[k].length, 1.0);
        ck_assert_near(blur.length, hypot(x, y), cases[k].tolerance);
        ck_assert_near(fabs(blur.x * x + blur.y * y), hypot(x, y), 0.005 * hypot(x, y)); /* 6 degrees */
        ck_assert(blur.along < blur.across);
    }
}
END_TEST

START_TEST(a_sharp_picture_is_not_blurred)
{
    const L1L2MotionBlur blur = measure(0.001, 5.0);
    ck_assert_near(blur.length, 0.0, 0.0);
}
END_TEST

START_TEST(exposure_is_not_taken_for_blur)
{
    cfg.step_at = BLURRED, cfg.step_gain = 0.7;
    ck_assert_near(measure(20.0, 0.0).length, 20.0, 4.0);
    cfg.step_at = 0;
}
END_TEST

START_TEST(the_sharper_picture_is_known_by_its_tensor)
{
    measure(20.0, 0.0);
    const L1L2StructureTensor a = l1l2_motion_blur_tensor(sharp), b = l1l2_motion_blur_tensor(blurred);
    ck_assert_double_lt(l1l2_motion_blur_sharper(&b, &a), 0.5);
    ck_assert_double_gt(l1l2_motion_blur_sharper(&a, &b), 1.0);
}
END_TEST

START_TEST(a_flat_picture_gives_nothing_to_compare)
{
    static const uint8_t black[WIDTH * HEIGHT];
    measure(20.0, 0.0);
    l1l2_image_float_pyramid_build(sharp, black, WIDTH);
    const L1L2MotionBlur blur = l1l2_motion_blur_measure(blurred, sharp, 0.0);
    ck_assert_near(blur.length, 0.0, 0.0);
    const L1L2StructureTensor a = l1l2_motion_blur_tensor(sharp);
    ck_assert_near(l1l2_motion_blur_sharper(&a, &a), 0.0, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_blur");
    TCase *tests = tcase_create("motion_blur");
    tcase_add_unchecked_fixture(tests, open_clip, close_clip);
    tcase_add_test(tests, length_and_direction_are_found);
    tcase_add_test(tests, a_sharp_picture_is_not_blurred);
    tcase_add_test(tests, exposure_is_not_taken_for_blur);
    tcase_add_test(tests, the_sharper_picture_is_known_by_its_tensor);
    tcase_add_test(tests, a_flat_picture_gives_nothing_to_compare);
    suite_add_tcase(suite, tests);
    return checkx_run(suite);
}
