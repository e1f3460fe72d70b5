/* SPDX-License-Identifier: MIT */
/* The spectra of the synthetic shakes, by Fourier analysis of the camera's path. */
#include "checkx.h"
#include "synth.h"

enum { SECONDS = 100, RATE = 60, SAMPLES = SECONDS * RATE, X = 0, Y = 1 };

static double path[2][SAMPLES];

/* The path of one hold with one unit of shake, less its mean. */
static void record(SynthHold hold)
{
    SynthConfig cfg = synth_defaults();
    cfg.hold = hold, cfg.shake = 1.0, cfg.seed = 3;
    Synth *s = synth_new(&cfg);
    double mean[2] = {0.0};
    for (int i = 0; i < SAMPLES; i++) {
        double M[9];
        synth_camera_at(s, 30.0 * i / RATE, M);
        path[X][i] = M[2], path[Y][i] = M[5];
        mean[X] += M[2] / SAMPLES, mean[Y] += M[5] / SAMPLES;
    }
    for (int i = 0; i < SAMPLES; i++)
        path[X][i] -= mean[X], path[Y][i] -= mean[Y];
    synth_free(s);
}

/* The power in [from, to) Hz as a part of the whole power. */
static double band(int axis, double from, double to)
{
    double inside = 0.0, all = 0.0;
    for (int i = 0; i < SAMPLES; i++)
        all += path[axis][i] * path[axis][i] / SAMPLES;
    for (int k = (int)ceil(from * SECONDS); k < (int)(to * SECONDS); k++) {
        double re = 0.0, im = 0.0;
        for (int i = 0; i < SAMPLES; i++) {
            const double phase = 6.283185307179586 * (double)k * i / SAMPLES;
            re += path[axis][i] * cos(phase) / SAMPLES;
            im += path[axis][i] * sin(phase) / SAMPLES;
        }
        inside += 2.0 * (re * re + im * im);
    }
    return inside / all;
}

/* The frequency in [from, to) Hz that has the most power. */
static double peak(int axis, double from, double to)
{
    double best = from;
    for (double f = from; f < to; f += 0.01)
        if (band(axis, f - 0.005, f + 0.015) > band(axis, best - 0.005, best + 0.015))
            best = f;
    return best;
}

START_TEST(every_shake_has_the_strength_that_was_asked_for)
{
    record((SynthHold)_i);
    for (int axis = X; axis <= Y; axis++) {
        double square = 0.0;
        for (int i = 0; i < SAMPLES; i++)
            square += path[axis][i] * path[axis][i] / SAMPLES;
        ck_assert_near(sqrt(square), 1.0, 0.05);
    }
}
END_TEST

START_TEST(a_walk_bobs_with_each_step_and_leans_with_every_second_one)
{
    record(SYNTH_WALK);
    const double step = peak(Y, 1.5, 2.5);
    ck_assert_near(peak(X, 0.75, 1.25), step / 2.0, 0.011);
    ck_assert_near(peak(Y, 3.2, 5.0), 2.0 * step, 0.021); /* a harmonic */
    ck_assert_double_gt(band(Y, step - 0.05, step + 0.05), 0.6);
    ck_assert_double_gt(band(X, step / 2.0 - 0.05, step / 2.0 + 0.05), 0.5);
}
END_TEST

START_TEST(standing_is_slow_and_a_vehicle_rattles)
{
    record(SYNTH_STAND);
    ck_assert_double_gt(band(X, 0.0, 1.0), 0.97);
    const double calm = band(X, 8.0, 25.0);
    record(SYNTH_VEHICLE);
    ck_assert_double_gt(band(X, 8.0, 25.0), 0.03);
    ck_assert_double_gt(band(X, 8.0, 25.0), 10.0 * calm);
    ck_assert_double_gt(band(X, 0.0, 2.0), 0.9);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth_path");
    TCase *tc = tcase_create("synth_path");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, every_shake_has_the_strength_that_was_asked_for, SYNTH_HAND, SYNTH_VEHICLE + 1);
    tcase_add_test(tc, a_walk_bobs_with_each_step_and_leans_with_every_second_one);
    tcase_add_test(tc, standing_is_slow_and_a_vehicle_rattles);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
