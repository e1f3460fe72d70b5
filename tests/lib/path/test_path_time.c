/* SPDX-License-Identifier: MIT */
/* Paths whose frames are not evenly spaced in time. */
#include <stdio.h>

#include "path/path_fixture.h"

/* A run that has only some frames of an evenly spaced run, those that are `kept`, with their true steps. */
static Run *thinned(const Run *even, bool (*kept)(int t))
{
    Run *r = new_run(0);
    L1L2Mat since = l1l2_mat_identity();
    int before = 0;
    for (int t = 0; t < even->frames; t++) {
        if (t > 0)
            since = l1l2_mat_mul(since, even->F[t]);
        if (!kept(t))
            continue;
        r->F[r->frames] = since;
        r->step[r->frames++] = t - before > 0 ? t - before : 1;
        since = l1l2_mat_identity();
        before = t;
    }
    return r;
}

static bool four_in_five(int t)
{
    return t % 5 != 3;
}

static bool most_at_random(int t)
{
    return (t * t * 7 + t * 3) % 11 < 9;
}

/* One frame, then a gap of 2, then of 3, then of 4 frames. */
static bool with_gaps(int t)
{
    const int phase = t % 10;
    return phase == 0 || phase == 1 || phase == 3 || phase == 6;
}

static bool with_one_long_gap(int t)
{
    return t < 300 || t >= 311; /* 12 frames from one to the next */
}

/* Speed of the smooth path in frame t's step, px a nominal frame. */
static double speed_in_time(const Run *r, int t)
{
    return speed_px(r, t) / r->out[t].step;
}

START_TEST(explicit_even_steps_give_the_same_bits)
{
    for (int i = 0; i < 4; i++) {
        Setup cfg = defaults();
        cfg.window = 60, cfg.overlap = i % 2 ? 15 : 40;
        cfg.join = (L1L2StabJoin)(i % 2);
        cfg.model = (L1L2StabMotionModel)(i % 3);
        Run *a = drifting_run(300, 0.7, 30.0, 4.0, (uint64_t)i), *b = drifting_run(300, 0.7, 30.0, 4.0, (uint64_t)i);
        a->starts[170] = b->starts[170] = true;
        a->hurry[90] = b->hurry[90] = 30;
        for (int t = 0; t < b->frames; t++)
            b->step[t] = 1.0;
        b->step[0] = b->step[170] = 3.0; /* the step to a path's first frame is not used */
        run(&cfg, a);
        run(&cfg, b);
        for (int t = 0; t < a->frames; t++)
            ck_assert_mem_eq(a->out[t].B.m, b->out[t].B.m, sizeof a->out[t].B.m);
        b->step[100] = 1.1; /* the comparison can fail */
        run(&cfg, b);
        ck_assert(memcmp(a->out[100].B.m, b->out[100].B.m, sizeof a->out[100].B.m) != 0);
        free(a);
        free(b);
    }
}
END_TEST

START_TEST(a_steady_pan_with_missing_frames_is_steady_in_time)
{
    static bool (*const kept[])(int) = {four_in_five, most_at_random, with_gaps};
    static const double pans_px[] = {2.0, 4.0, 12.0};
    const int edge = 30;
    const Setup cfg = defaults();
    for (int i = 0; i < 3; i++) {
        const double pan_px = pans_px[i];
        Run *even = shaky_run(700, pan_px, 0.0, 1);
        run(&cfg, even);
        double constant = 0.0;
        for (int t = edge; t < even->frames - edge; t++)
            constant += speed_px(even, t) / (even->frames - 2 * edge);
        for (int k = 0; k < 3; k++) {
            Run *r = thinned(even, kept[k]);
            double least = HUGE_VAL, most = 0.0, mean = 0.0, time = 0.0;
            run(&cfg, r);
            for (int t = edge; t < r->frames - edge; t++) {
                const double speed = speed_in_time(r, t);
                least = fmin(least, speed), most = fmax(most, speed);
                mean += speed_px(r, t), time += r->out[t].step;
            }
            printf("pan %4.1f px/frame, pattern %d: %.4f .. %.4f of it, mean %.4f (constant rate: %.4f)\n", pan_px, k,
                   least / pan_px, most / pan_px, mean / time / pan_px, constant / pan_px);
            ck_assert_double_ge(least, 0.95 * pan_px);
            ck_assert_double_le(most, 1.05 * pan_px);
            ck_assert_near(least / constant, 1.0, 0.02);
            ck_assert_near(most / constant, 1.0, 0.02);
            free(r);
        }
        free(even);
    }
}
END_TEST

START_TEST(the_pan_would_be_unsteady_if_every_step_counted_as_one_frame)
{
    const Setup cfg = defaults();
    Run *even = shaky_run(700, 4.0, 0.0, 1), *r = thinned(even, four_in_five);
    double worst = 0.0;
    double step[MAX_FRAMES];
    memcpy(step, r->step, sizeof step);
    memset(r->step, 0, sizeof r->step);
    run(&cfg, r);
    for (int t = 30; t < r->frames - 30; t++)
        worst = fmax(worst, fabs(speed_px(r, t) / step[t] - 4.0));
    ck_assert_double_ge(worst, 1.0);
    free(even);
    free(r);
}
END_TEST

/* Steps are bounded to 4 frames (frame_time.h). */
START_TEST(a_gap_of_twelve_frames_disturbs_a_pan_only_around_it)
{
    const Setup cfg = defaults();
    Run *even = shaky_run(700, 2.0, 0.0, 1), *r = thinned(even, with_one_long_gap);
    ck_assert(r->step[300] == 12.0);
    r->step[300] = 4.0;
    run(&cfg, r);
    int first = r->frames, last = 0;
    for (int t = 30; t < r->frames - 30; t++)
        if (fabs(speed_in_time(r, t) / 2.0 - 1.0) > 0.05)
            first = t < first ? t : first, last = t;
    printf("12 frames missing in a pan of 2 px/frame: its speed is off by more than 5 %% from frame %d to %d after "
           "the gap, which it crosses by %.1f of 24 px\n", first - 300, last - 300, speed_px(r, 300));
    ck_assert(first >= 300 - 45 && last <= 300 + 45);
    free(even);
    free(r);
}
END_TEST

START_TEST(a_shaky_walk_with_missing_frames_has_nearly_the_path_of_the_whole_one)
{
    Setup cfg = defaults();
    cfg.crop_ratio = 0.8;
    Run *even = drifting_run(600, 0.7, 30.0, 4.0, 3);
    Run *r = thinned(even, four_in_five), *ignored = thinned(even, four_in_five);
    memset(ignored->step, 0, sizeof ignored->step);
    run(&cfg, even);
    run(&cfg, r);
    run(&cfg, ignored);
    double in_time = 0.0, in_frames = 0.0;
    int n = 0;
    for (int t = 0, i = 0; t < even->frames; t++)
        if (four_in_five(t)) {
            if (t >= 30 && t < even->frames - 30) {
                in_time += pow(diagonal_px * (r->out[i].B.m[2] - even->out[t].B.m[2]), 2.0);
                in_frames += pow(diagonal_px * (ignored->out[i].B.m[2] - even->out[t].B.m[2]), 2.0);
                n++;
            }
            i++;
        }
    printf("one frame in five missing: B differs by %.3f px rms in x from the whole walk's; %.3f if steps are "
           "ignored\n",
           sqrt(in_time / n), sqrt(in_frames / n));
    ck_assert_double_lt(in_time, 0.8 * in_frames);
    free(even);
    free(r);
    free(ignored);
}
END_TEST

START_TEST(random_steps_over_the_whole_range_keep_the_picture_inside)
{
    for (int i = 0; i < 6; i++) {
        Setup cfg = defaults();
        cfg.window = 60, cfg.overlap = i % 2 ? 15 : 40;
        cfg.join = (L1L2StabJoin)(i % 2);
        cfg.model = (L1L2StabMotionModel)(i % 3);
        L1L2Rng rng = l1l2_rng_seeded((uint64_t)i);
        Run *r = drifting_run(300, 0.7, 30.0, 4.0 + 10.0 * i, (uint64_t)i);
        for (int t = 0; t < r->frames; t++)
            r->step[t] = pow(4.0, uniform(&rng, -1.0, 1.0));
        run(&cfg, r);
        assert_all_inside(&cfg, r);
        free(r);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("path_time");
    TCase *tcase = tcase_create("path_time");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, explicit_even_steps_give_the_same_bits);
    tcase_add_test(tcase, a_steady_pan_with_missing_frames_is_steady_in_time);
    tcase_add_test(tcase, the_pan_would_be_unsteady_if_every_step_counted_as_one_frame);
    tcase_add_test(tcase, a_gap_of_twelve_frames_disturbs_a_pan_only_around_it);
    tcase_add_test(tcase, a_shaky_walk_with_missing_frames_has_nearly_the_path_of_the_whole_one);
    tcase_add_test(tcase, random_steps_over_the_whole_range_keep_the_picture_inside);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
