/* SPDX-License-Identifier: MIT */
/* The pixels of synthetic clips show the events that their configs have. */
#include "support/synth_fixture.h"

static uint8_t plain[PIXELS], other[PIXELS], frame[PIXELS];

static SynthConfig config_with(SynthEventKind kind, int from, int frames, double amount)
{
    SynthConfig cfg = small_clip();
    cfg.event[0] = (SynthEvent){kind, from, frames, amount};
    return cfg;
}

static Synth *clip_with(SynthEventKind kind, int from, int frames, double amount)
{
    const SynthConfig cfg = config_with(kind, from, frames, amount);
    return synth_new(&cfg);
}

START_TEST(a_cut_shows_another_scene_from_its_frame_on)
{
    SynthConfig cfg = config_with(SYNTH_CUT, 10, 0, 0);
    cfg.event[1] = (SynthEvent){SYNTH_CUT, 20, 0, 0};
    Synth *cut = synth_new(&cfg), *uncut = clip_with(SYNTH_NONE, 0, 0, 0);
    for (int t = 8; t < 22; t++) {
        gray(uncut, t, plain);
        gray(cut, t, frame);
        ck_assert_int_eq(synth_shot(cut, t), (t >= 10) + (t >= 20));
        if (t < 10 || t >= 20)
            ck_assert_mem_eq(frame, plain, PIXELS); /* the third shot is of the first scene again */
        else
            ck_assert_double_gt(mean_difference(frame, plain), 25.0);
    }
    synth_free(cut);
    synth_free(uncut);
}
END_TEST

START_TEST(a_dissolve_is_a_mix_of_both_shots)
{
    Synth *first = clip_with(SYNTH_NONE, 0, 0, 0), *second = clip_with(SYNTH_CUT, 0, 0, 0);
    Synth *dissolve = clip_with(SYNTH_DISSOLVE, 5, 4, 0);
    for (int t = 4; t <= 9; t++) {
        const double part = (t - 4) / 5.0;
        gray(first, t, plain);
        gray(second, t, other);
        gray(dissolve, t, frame);
        for (int i = 0; i < PIXELS; i++)
            ck_assert_near(frame[i], plain[i] + part * (other[i] - plain[i]), 1.1);
        ck_assert_int_eq(synth_shot(dissolve, t), part > 0.5);
    }
    synth_free(first);
    synth_free(second);
    synth_free(dissolve);
}
END_TEST

START_TEST(a_fade_goes_to_black_and_comes_back_and_takes_the_colors_with_it)
{
    static const double black[] = {0, 0.25, 0.5, 0.75, 1, 1, 1, 1, 0.75, 0.5, 0.25, 0};
    SynthConfig cfg = config_with(SYNTH_FADE_OUT, 5, 3, 0);
    cfg.event[1] = (SynthEvent){SYNTH_FADE_IN, 12, 3, 0};
    Synth *fading = synth_new(&cfg), *unfaded = clip_with(SYNTH_NONE, 0, 0, 0);
    SynthPicture p = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
    SynthPicture q = synth_picture_new(p.format, WIDTH, HEIGHT);
    for (int t = 4; t < 16; t++) {
        synth_render(unfaded, t, p.format, p.data, p.stride);
        synth_render(fading, t, q.format, q.data, q.stride);
        for (size_t i = 0; i < p.size; i++) {
            const double level = p.data[0][i], end = i < PIXELS ? 16.0 : 128.0;
            ck_assert_near(q.data[0][i], level + black[t - 4] * (end - level), 1.01);
        }
    }
    synth_picture_free(&p);
    synth_picture_free(&q);
    synth_free(fading);
    synth_free(unfaded);
}
END_TEST

START_TEST(black_frames_are_black_and_a_full_flash_is_white)
{
    Synth *lit = clip_with(SYNTH_NONE, 0, 0, 0), *black = clip_with(SYNTH_BLACK, 5, 2, 0);
    Synth *flash = clip_with(SYNTH_FLASH, 5, 2, 1.0), *half = clip_with(SYNTH_FLASH, 5, 2, 0.5);
    for (int t = 4; t < 8; t++) {
        const bool during = t == 5 || t == 6;
        gray(lit, t, plain);
        gray(black, t, frame);
        gray(flash, t, other);
        for (int i = 0; i < PIXELS; i++) {
            ck_assert_int_eq(frame[i], during ? 16 : plain[i]);
            ck_assert_int_eq(other[i], during ? 235 : plain[i]);
        }
        gray(half, t, frame);
        ck_assert_near(mean_level(frame), during ? 0.5 * (mean_level(plain) + 235.0) : mean_level(plain), 0.1);
        ck_assert_near(deviation(frame), deviation(plain) * (during ? 0.5 : 1.0), 0.5);
    }
    synth_free(lit);
    synth_free(black);
    synth_free(flash);
    synth_free(half);
}
END_TEST

START_TEST(a_covered_lens_shows_nothing_and_then_the_scene_again)
{
    Synth *open = clip_with(SYNTH_NONE, 0, 0, 0), *covered = clip_with(SYNTH_COVER, 5, 20, 0);
    for (int t = 3; t < 28; t++) {
        gray(open, t, plain);
        gray(covered, t, frame);
        if (t < 5 || t >= 25) {
            ck_assert_mem_eq(frame, plain, PIXELS);
        } else if (t >= 9 && t < 21) {
            ck_assert_double_lt(deviation(frame), 3.0);
            ck_assert_double_lt(mean_level(frame), 40.0);
        } else {
            ck_assert_double_gt(deviation(frame), 3.0); /* the hand is moving */
            ck_assert_double_gt(mean_difference(frame, plain), 3.0);
        }
    }
    synth_free(open);
    synth_free(covered);
}
END_TEST

START_TEST(the_gain_scales_the_levels)
{
    Synth *constant = clip_with(SYNTH_NONE, 0, 0, 0), *dark = clip_with(SYNTH_GAIN, 5, 5, 0.2);
    Synth *ramp = clip_with(SYNTH_RAMP, 5, 9, 0.5), *flicker = clip_with(SYNTH_FLICKER, 0, 20, 0.1);
    for (int t = 0; t < 20; t++) {
        gray(constant, t, plain);
        const double level = mean_level(plain);
        gray(dark, t, frame);
        for (int i = 0; i < PIXELS; i++) /* both are rounded */
            ck_assert_near(frame[i], plain[i] * (t >= 5 && t < 10 ? 0.2 : 1.0), 0.61);
        gray(ramp, t, frame);
        ck_assert_near(mean_level(frame) / level, 1.0 - 0.05 * fmin(fmax(t - 4, 0), 10), 0.003);
        gray(flicker, t, frame);
        const double period = 5.0; /* frames: 6 Hz at 30 frames/s */
        ck_assert_near(mean_level(frame) / level, 1.0 + 0.1 * sin(6.283185307179586 * t / period), 0.003);
    }
    synth_free(constant);
    synth_free(dark);
    synth_free(ramp);
    synth_free(flicker);
}
END_TEST

/* Frame t and the frame before it: are they equal, and is the truth the identity? */
static void expect_repetition(const Synth *s, int t, bool repeats)
{
    double F[9];
    gray(s, t - 1, plain);
    gray(s, t, frame);
    synth_motion(s, t, F);
    ck_assert_int_eq(memcmp(plain, frame, PIXELS) == 0, repeats);
    ck_assert_int_eq(fabs(F[0] - 1.0) + fabs(F[2]) + fabs(F[3]) + fabs(F[5]) < 1e-9, repeats);
}

START_TEST(pulldown_shows_every_fifth_frame_twice_and_keeps_the_pace)
{
    SynthConfig cfg = small_clip();
    cfg.repeat_every = 5;
    cfg.noise = 3.0;
    Synth *s = synth_new(&cfg);
    for (int t = 1; t < 16; t++)
        expect_repetition(s, t, t % 5 == 4);
    for (int k = 0; k < 12; k++) /* film frame k was taken at k / 24 s */
        ck_assert_near(synth_row_time(s, k / 4 * 5 + k % 4, 0.0), k * 1.25, 1e-12);
    synth_free(s);
}
END_TEST

START_TEST(a_near_repetition_differs_by_its_noise_alone)
{
    SynthConfig cfg = small_clip();
    cfg.repeat_every = 5;
    cfg.noise = 3.0;
    cfg.fresh_noise = true;
    Synth *s = synth_new(&cfg);
    gray(s, 3, plain);
    gray(s, 4, frame);
    double square = 0.0;
    for (int i = 0; i < PIXELS; i++)
        square += (frame[i] - plain[i]) * (frame[i] - plain[i]) / (double)PIXELS;
    ck_assert_near(sqrt(square), 3.0 * sqrt(2.0), 0.1);
    double F[9];
    synth_motion(s, 4, F);
    ck_assert_near(fabs(F[2]) + fabs(F[3]) + fabs(F[5]), 0.0, 1e-9);
    synth_free(s);
}
END_TEST

START_TEST(a_frozen_picture_is_repeated_while_the_time_goes_on)
{
    Synth *frozen = clip_with(SYNTH_FREEZE, 6, 3, 0), *moving = clip_with(SYNTH_NONE, 0, 0, 0);
    for (int t = 1; t < 12; t++)
        expect_repetition(frozen, t, t >= 6 && t < 9);
    gray(moving, 9, plain);
    gray(frozen, 9, frame);
    ck_assert_mem_eq(frame, plain, PIXELS);
    synth_free(frozen);
    synth_free(moving);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth_events");
    TCase *tc = tcase_create("synth_events");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, a_cut_shows_another_scene_from_its_frame_on);
    tcase_add_test(tc, a_dissolve_is_a_mix_of_both_shots);
    tcase_add_test(tc, a_fade_goes_to_black_and_comes_back_and_takes_the_colors_with_it);
    tcase_add_test(tc, black_frames_are_black_and_a_full_flash_is_white);
    tcase_add_test(tc, a_covered_lens_shows_nothing_and_then_the_scene_again);
    tcase_add_test(tc, the_gain_scales_the_levels);
    tcase_add_test(tc, pulldown_shows_every_fifth_frame_twice_and_keeps_the_pace);
    tcase_add_test(tc, a_near_repetition_differs_by_its_noise_alone);
    tcase_add_test(tc, a_frozen_picture_is_repeated_while_the_time_goes_on);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
