/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "synth_hard.h"

enum { WIDTH = 160, HEIGHT = 90 };

static uint8_t a[WIDTH * HEIGHT], b[WIDTH * HEIGHT];

static SynthHard *small(const char *name)
{
    const SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named(name), WIDTH);
    return synth_hard_new(&cfg);
}

START_TEST(a_frame_is_the_same_whatever_was_asked_before)
{
    SynthHard *s = small("blur 20 px");
    synth_hard_render(s, 3, a, WIDTH);
    synth_hard_render(s, 1, b, WIDTH);
    ck_assert(memcmp(a, b, sizeof a) != 0);
    synth_hard_render(s, 3, b, WIDTH);
    ck_assert_mem_eq(a, b, sizeof a);
    const SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named("water 55 %"), WIDTH);
    synth_hard_change(s, &cfg);
    synth_hard_render(s, 3, a, WIDTH);
    synth_hard_free(s);
    s = small("water 55 %");
    synth_hard_render(s, 3, b, WIDTH);
    ck_assert_mem_eq(a, b, sizeof a);
    synth_hard_free(s);
}
END_TEST

START_TEST(blurred_frames_are_where_and_as_long_as_the_config_says)
{
    SynthHardConfig cfg = synth_hard_case_named("blur of 2 frames")->cfg;
    cfg.shake = 0.0;
    cfg.jerk_every = 12;
    SynthHard *s = synth_hard_new(&cfg);
    for (int t = 0; t < 9; t++) {
        double x, y;
        synth_hard_blur(s, t, &x, &y);
        if (t == 3 || t == 4)
            ck_assert_near(hypot(x, y), cfg.jerk_px, 0.25 * cfg.jerk_px); /* the other jerk counts too */
        else
            ck_assert_double_lt(hypot(x, y), 0.15 * cfg.jerk_px);
    }
    synth_hard_free(s);
}
END_TEST

START_TEST(motions_chain)
{
    SynthHard *s = small("blur 20 px");
    double F[9], G[9], both[9];
    synth_hard_motion(s, 3, 1, F);
    synth_hard_motion(s, 4, 1, G);
    synth_hard_motion(s, 4, 2, both);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++)
                sum += F[3 * row + k] * G[3 * k + column];
            ck_assert_near(sum, both[3 * row + column], 1e-9);
        }
    synth_hard_free(s);
}
END_TEST

START_TEST(a_thermal_camera_has_few_levels)
{
    SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named("thermal"), WIDTH);
    bool seen[256] = {false};
    int levels = 0;
    cfg.pattern = 0.0;
    SynthHard *s = synth_hard_new(&cfg);
    synth_hard_render(s, 0, a, WIDTH);
    for (size_t i = 0; i < sizeof a; i++)
        seen[a[i]] = true;
    for (int i = 0; i < 256; i++)
        levels += seen[i];
    ck_assert(levels >= 8 && levels <= 17);
    synth_hard_free(s);
}
END_TEST

START_TEST(noise_has_its_deviation_and_a_pattern_stays)
{
    SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named("plain"), WIDTH);
    double squares = 0.0;
    cfg.contrast = 1e-12, cfg.noise = 5.0;
    SynthHard *s = synth_hard_new(&cfg);
    synth_hard_render(s, 0, a, WIDTH);
    for (size_t i = 0; i < sizeof a; i++)
        squares += (a[i] - 120.0) * (a[i] - 120.0) / sizeof a;
    ck_assert_near(sqrt(squares), 5.0, 0.2);
    cfg.noise = 0.0, cfg.pattern = 5.0;
    synth_hard_change(s, &cfg);
    synth_hard_render(s, 0, a, WIDTH);
    synth_hard_render(s, 5, b, WIDTH);
    ck_assert_mem_eq(a, b, sizeof a);
    synth_hard_free(s);
}
END_TEST

START_TEST(every_case_can_be_drawn)
{
    const SynthHardConfig plain = synth_hard_case_at(synth_hard_case_named("plain"), WIDTH);
    SynthHard *s = synth_hard_new(&plain);
    for (int i = 0; i < synth_hard_case_count; i++) {
        const SynthHardConfig cfg = synth_hard_case_at(&synth_hard_cases[i], WIDTH);
        synth_hard_change(s, &cfg);
        double sum = 0.0, squares = 0.0;
        synth_hard_render(s, 2, a, WIDTH);
        for (size_t k = 0; k < sizeof a; k++)
            sum += a[k], squares += (double)a[k] * a[k];
        sum /= sizeof a;
        ck_assert_msg(squares / sizeof a - sum * sum > 0.05, "%s is flat", synth_hard_cases[i].name);
    }
    synth_hard_free(s);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth_hard");
    TCase *tests = tcase_create("synth_hard");
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, a_frame_is_the_same_whatever_was_asked_before);
    tcase_add_test(tests, blurred_frames_are_where_and_as_long_as_the_config_says);
    tcase_add_test(tests, motions_chain);
    tcase_add_test(tests, a_thermal_camera_has_few_levels);
    tcase_add_test(tests, noise_has_its_deviation_and_a_pattern_stays);
    tcase_add_test(tests, every_case_can_be_drawn);
    suite_add_tcase(suite, tests);
    return checkx_run(suite);
}
