/* SPDX-License-Identifier: MIT */
/* The step from frame to frame by the timestamps, and its effect on the path. There are no pixels: motions are
 * given. */
#include <math.h>
#include <string.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "common/rng.h"
#include "frame_time.h"

enum { FRAMES = 400 };

static const double ms = 1e6, frame_ms = 1000.0 / 30.0;

static int64_t at(double time_ms)
{
    return 7000000000 + llround(time_ms * ms);
}

/* The last step of a stream of 30 frames/s whose timestamps are those of the list. */
static double last_step(int count, const int64_t *pts)
{
    L1L2FrameTime time = l1l2_frame_time_start(30.0);
    double step = l1l2_frame_time_step(&time, pts[0], true);
    for (int i = 1; i < count; i++)
        step = l1l2_frame_time_step(&time, pts[i], false);
    return step;
}

#define LAST_STEP(...) \
    last_step((int)(sizeof(int64_t[]){__VA_ARGS__} / sizeof(int64_t)), (int64_t[]){__VA_ARGS__})

START_TEST(a_step_counts_by_its_time)
{
    ck_assert_near(LAST_STEP(at(0), at(2 * frame_ms)), 2.0, 1e-6);
    ck_assert_near(LAST_STEP(at(0), at(0.6 * frame_ms)), 0.6, 1e-6);
    ck_assert_near(LAST_STEP(at(0), at(33), at(33 + 3.5 * frame_ms)), 3.5, 1e-6);
    ck_assert_near(LAST_STEP(-at(0), 20000000 - at(0)), 0.6, 1e-6);
}
END_TEST

START_TEST(a_deviation_below_2_ms_is_exactly_one_frame)
{
    ck_assert(LAST_STEP(at(0), at(frame_ms - 1.99)) == 1.0);
    ck_assert(LAST_STEP(at(0), at(frame_ms + 1.99)) == 1.0);
    ck_assert(LAST_STEP(at(0), at(frame_ms + 2.01)) > 1.05);
    ck_assert(LAST_STEP(at(0), at(frame_ms - 2.01)) < 0.95);
}
END_TEST

START_TEST(a_step_is_bounded_to_a_quarter_and_to_four_frames)
{
    ck_assert(LAST_STEP(at(0), at(100 * frame_ms)) == 4.0);
    ck_assert(LAST_STEP(at(0), at(0.1 * frame_ms)) == 0.25);
    ck_assert(LAST_STEP(INT64_MIN + 1, INT64_MAX) == 4.0);
}
END_TEST

START_TEST(equal_backward_and_missing_timestamps_count_as_one_frame)
{
    ck_assert(LAST_STEP(at(0), at(0)) == 1.0);
    ck_assert(LAST_STEP(at(0), at(100), at(30)) == 1.0);
    ck_assert(LAST_STEP(at(100), at(30)) == 1.0);
    ck_assert(LAST_STEP(at(0), L1L2STAB_NO_PTS) == 1.0);
    ck_assert(LAST_STEP(at(0), L1L2STAB_NO_PTS, at(100)) == 1.0);
    ck_assert(LAST_STEP(L1L2STAB_NO_PTS, L1L2STAB_NO_PTS) == 1.0);
    ck_assert(LAST_STEP(at(0), at(100), at(30), at(130)) == 1.0); /* the first step forward after the error */
    ck_assert_near(LAST_STEP(at(0), at(0), at(2 * frame_ms)), 2.0, 1e-6);
}
END_TEST

START_TEST(numbers_that_are_not_times_count_as_one_frame)
{
    ck_assert(LAST_STEP(0, 1) == 1.0);
    ck_assert(LAST_STEP(1000, 1033) == 1.0);
    ck_assert(LAST_STEP(0, 999999) == 1.0);
}
END_TEST

START_TEST(falling_timestamps_count_by_their_time)
{
    ck_assert_near(LAST_STEP(at(900), at(867), at(867 - 2 * frame_ms)), 2.0, 1e-6);
    ck_assert(LAST_STEP(at(900), at(867), at(832)) == 1.0);
}
END_TEST

START_TEST(a_step_is_one_frame_where_the_rate_is_unknown_or_a_path_starts)
{
    L1L2FrameTime unknown = l1l2_frame_time_start(0.0), known = l1l2_frame_time_start(30.0);
    for (int t = 0; t < 4; t++) {
        ck_assert(l1l2_frame_time_step(&unknown, at(100.0 * t), t == 0) == 1.0);
        ck_assert(l1l2_frame_time_step(&known, at(100.0 * t), true) == 1.0);
    }
}
END_TEST

/* A film: where the camera is at each frame, px, and the frame's timestamp. */
typedef struct Film {
    int frames;
    double x[FRAMES], y[FRAMES];
    int64_t pts[FRAMES];
    L1L2StabInfo info[FRAMES]; /* the output */
} Film;

static void stabilize(Film *film)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = 640, cfg.height = 360;
    cfg.frame_rate = 30;
    cfg.threads = 1;
    L1L2Stab *s;
    int pulled = 0;
    ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_OK);
    for (int t = 0; t <= film->frames; t++) {
        if (t < film->frames) {
            const double step_x = t > 0 ? film->x[t] - film->x[t - 1] : 0;
            const double step_y = t > 0 ? film->y[t] - film->y[t - 1] : 0;
            const double F[9] = {1, 0, step_x, 0, 1, step_y, 0, 0, 1};
            ck_assert_int_eq(l1l2stab_push(s, &(L1L2StabFrame){.pts = film->pts[t], .motion = F}), L1L2STAB_OK);
        } else {
            ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
        }
        while (l1l2stab_pull(s, NULL, &film->info[pulled]) == L1L2STAB_OK)
            pulled++;
    }
    ck_assert_int_eq(pulled, film->frames);
    l1l2stab_free(&s);
}

/* A shaky pan of 120 px/s at 30 frames/s, without timestamps. */
static void shoot(Film *film)
{
    L1L2Rng rng = l1l2_rng_seeded(5);
    film->frames = 240;
    for (int t = 0; t < film->frames; t++) {
        film->x[t] = 4.0 * t + 6.0 * (l1l2_rng_next(&rng) / 4294967296.0);
        film->y[t] = 6.0 * (l1l2_rng_next(&rng) / 4294967296.0);
        film->pts[t] = L1L2STAB_NO_PTS;
    }
}

static bool same_path(const Film *a, const Film *b)
{
    for (int t = 0; t < a->frames; t++)
        if (memcmp(a->info[t].B, b->info[t].B, sizeof a->info[t].B) != 0)
            return false;
    return true;
}

START_TEST(timestamps_of_a_constant_rate_do_not_change_the_path_by_a_bit)
{
    Film *plain = calloc(1, sizeof *plain), *film = calloc(1, sizeof *film);
    L1L2Rng rng = l1l2_rng_seeded(7);
    shoot(plain);
    stabilize(plain);
    for (int kind = 0; kind < 6; kind++) {
        shoot(film);
        for (int t = 0; t < film->frames; t++) {
            const double jitter = 0.99 * (l1l2_rng_next(&rng) / 2147483648.0 - 1.0);
            const int64_t pts[] = {at(frame_ms * t), at(frame_ms * t + jitter), at(floor(frame_ms * t)), 0, t,
                                   at(-frame_ms * t)};
            film->pts[t] = pts[kind];
        }
        stabilize(film);
        ck_assert_msg(same_path(plain, film), "kind %d", kind);
    }
    film->pts[120] += 20000000; /* the comparison can fail */
    stabilize(film);
    ck_assert(!same_path(plain, film));
    free(plain);
    free(film);
}
END_TEST

START_TEST(a_gap_of_a_hundred_frames_gives_the_path_of_a_gap_of_five)
{
    Film *film[3];
    static const int gap[3] = {100, 5, 3}; /* the first two count as 4 */
    for (int i = 0; i < 3; i++) {
        film[i] = calloc(1, sizeof *film[i]);
        shoot(film[i]);
        for (int t = 0; t < film[i]->frames; t++)
            film[i]->pts[t] = at(frame_ms * (t < 120 ? t : t - 1 + gap[i]));
        stabilize(film[i]);
    }
    ck_assert(same_path(film[0], film[1]));
    ck_assert(!same_path(film[0], film[2]));
    for (int i = 0; i < 3; i++)
        free(film[i]);
}
END_TEST

START_TEST(a_path_is_steady_in_time_where_frames_are_missing)
{
    Film *film = calloc(1, sizeof *film);
    for (int t = 0; t < 400; t++)
        if (t % 5 != 3) {
            film->x[film->frames] = 4.0 * t;
            film->pts[film->frames++] = at(round(frame_ms * t)); /* as a container rounds */
        }
    stabilize(film);
    for (int i = 30; i < film->frames - 30; i++) {
        const double seconds = 1e-9 * (double)(film->pts[i] - film->pts[i - 1]);
        ck_assert_near((film->info[i].P[2] - film->info[i - 1].P[2]) / seconds, 120.0, 6.0);
    }
    free(film);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("frame_time");
    TCase *tcase = tcase_create("frame_time");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, a_step_counts_by_its_time);
    tcase_add_test(tcase, a_deviation_below_2_ms_is_exactly_one_frame);
    tcase_add_test(tcase, a_step_is_bounded_to_a_quarter_and_to_four_frames);
    tcase_add_test(tcase, equal_backward_and_missing_timestamps_count_as_one_frame);
    tcase_add_test(tcase, numbers_that_are_not_times_count_as_one_frame);
    tcase_add_test(tcase, falling_timestamps_count_by_their_time);
    tcase_add_test(tcase, a_step_is_one_frame_where_the_rate_is_unknown_or_a_path_starts);
    tcase_add_test(tcase, timestamps_of_a_constant_rate_do_not_change_the_path_by_a_bit);
    tcase_add_test(tcase, a_gap_of_a_hundred_frames_gives_the_path_of_a_gap_of_five);
    tcase_add_test(tcase, a_path_is_steady_in_time_where_frames_are_missing);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
