/* SPDX-License-Identifier: MIT */
/* Dissolves between two synthetic shots, and clips that resemble one. */
#include <math.h>
#include <string.h>

#include "checkx.h"
#include "motion/shot_dissolve.h"
#include "synth.h"

enum { WIDTH = 320, HEIGHT = 180, CELL = WIDTH / L1L2_THUMBNAIL_W };

static Synth *shot_new(uint64_t seed, double shake, double pan, double roll)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.seed = seed, cfg.shake = shake, cfg.pan_x = pan, cfg.roll = roll;
    return synth_new(&cfg);
}

static uint8_t picture[2][WIDTH * HEIGHT];

/* Frame t: `part` of the second shot (NULL: none), or its left `part` where something passes before the camera. */
static L1L2Thumbnail thumbnail_of(const Synth *first, const Synth *second, int t, double part, bool passes)
{
    L1L2Thumbnail thumbnail;
    synth_render_gray(first, t, picture[0], WIDTH);
    if (second)
        synth_render_gray(second, t, picture[1], WIDTH);
    for (int cell = 0; cell < L1L2_THUMBNAIL_W * L1L2_THUMBNAIL_H; cell++) {
        double sum = 0.0;
        for (int k = 0; k < CELL * CELL; k++) {
            const int x = cell % L1L2_THUMBNAIL_W * CELL + k % CELL, y = cell / L1L2_THUMBNAIL_W * CELL + k / CELL;
            const double share = !second ? 0.0 : !passes ? part : x < part * WIDTH;
            sum += (1.0 - share) * picture[0][y * WIDTH + x] + share * picture[1][y * WIDTH + x];
        }
        thumbnail.level[cell] = (uint8_t)lrint(sum / (CELL * CELL));
    }
    return thumbnail;
}

static L1L2Mat motion_of(const Synth *shot, int t)
{
    L1L2Mat F;
    synth_motion(shot, t, F.m);
    return F;
}

/* The frame at which another shot was detected, or -1. More than one fails. */
static int begins_at(const Synth *first, const Synth *second, int from, int frames, bool passes)
{
    static L1L2ShotDissolve dissolve;
    dissolve.parameters = &l1l2_motion_defaults;
    int seen = -1;
    for (int t = 0; t < 120; t++) {
        const double part = fmin(1.0, fmax(0.0, (t - from + 1.0) / (frames + 1.0)));
        const L1L2Thumbnail thumbnail = thumbnail_of(first, second, t, part, passes);
        const L1L2Mat F = motion_of(second && part > 0.5 ? second : first, t);
        if (t == 0 || l1l2_motion_dissolve_push(&dissolve, &thumbnail, &F, WIDTH / 2.0, HEIGHT / 2.0)) {
            ck_assert_int_eq(seen, -1);
            seen = t > 0 ? t : seen;
            l1l2_motion_dissolve_start(&dissolve, &thumbnail);
        }
    }
    return seen;
}

START_TEST(a_dissolve_of_4_to_40_frames_starts_one_other_shot)
{
    static const int frames[] = {4, 8, 15, 25, 40};
    for (int i = 0; i < 5; i++)
        for (int pan = 0; pan <= 3; pan += 3) {
            Synth *first = shot_new(1, 2.0, pan, 0.004), *second = shot_new(2, 2.0, pan, 0.004);
            const int at = begins_at(first, second, 50, frames[i], false);
            ck_assert_msg(at >= 50 && at < 50 + frames[i] + 24, "%d frames, pan %d: seen at %d", frames[i], pan, at);
            synth_free(first);
            synth_free(second);
        }
}
END_TEST

START_TEST(an_object_that_passes_before_the_camera_is_no_dissolve)
{
    Synth *first = shot_new(1, 2.0, 0.0, 0.004), *second = shot_new(2, 2.0, 0.0, 0.004);
    ck_assert_int_eq(begins_at(first, second, 50, 15, true), -1);
    ck_assert_int_eq(begins_at(first, second, 50, 30, true), -1);
    synth_free(first);
    synth_free(second);
}
END_TEST

START_TEST(a_camera_that_shakes_pans_and_turns_makes_no_dissolve)
{
    static const double shake[] = {0.5, 12.0}, pan[] = {0.0, 15.0}, roll[] = {0.001, 0.02, 0.06};
    for (int i = 0; i < 12; i++) {
        Synth *shot = shot_new((uint64_t)i + 1, shake[i % 2], pan[i / 2 % 2], roll[i / 4]);
        const int at = begins_at(shot, NULL, 50, 1, false);
        ck_assert_msg(at < 0, "shake %g pan %g roll %g: seen at %d", shake[i % 2], pan[i / 2 % 2], roll[i / 4], at);
        synth_free(shot);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("dissolve");
    TCase *tcase = tcase_create("dissolve");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, a_dissolve_of_4_to_40_frames_starts_one_other_shot);
    tcase_add_test(tcase, an_object_that_passes_before_the_camera_is_no_dissolve);
    tcase_add_test(tcase, a_camera_that_shakes_pans_and_turns_makes_no_dissolve);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
