/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "common/rng.h"
#include "path/window_schedule.h"

enum { MAX_FRAMES = 200 };

/* Walks a path of `length` frames, one frame after the other, and checks every promise of window_schedule.h. */
static void walk(int window, int overlap, int length)
{
    int emitted_at[MAX_FRAMES] = {0}; /* 1 + the number of frames that had arrived when a frame was decided */
    L1L2PathSchedule schedule = l1l2_path_schedule_start(window, overlap);
    L1L2PathWindow step;
    int next = 0, steps = 0;
    for (int come = 1; come <= length; come++) {
        const bool last = come == length;
        while (l1l2_path_schedule_next(&schedule, come, false, &step) ||
               (last && l1l2_path_schedule_next(&schedule, come, true, &step))) {
            ck_assert_int_eq(step.first, next); /* frames are emitted in order, each once */
            ck_assert_int_ge(step.count, 1);
            ck_assert_int_le(step.count, window);
            ck_assert_int_le(step.first + step.count, come); /* only frames that have arrived */
            ck_assert_int_eq(step.shared, steps == 0 ? 0 : overlap);
            ck_assert_int_ge(step.count, step.shared); /* the last window covers at least what it shares */
            for (int i = 0; i < step.emit; i++)
                emitted_at[next++] = come;
            steps++;
        }
    }
    ck_assert_int_eq(next, length);
    for (int t = 0; t < length; t++) /* frame t can leave when frame t + N - 1 has arrived, or at the end */
        ck_assert_int_le(emitted_at[t], t + window < length ? t + window : length);
    ck_assert(!l1l2_path_schedule_next(&schedule, length, true, &step));
}

START_TEST(every_frame_is_emitted_once_in_order_and_in_time)
{
    for (int window = 4; window <= 39; window++)
        for (int overlap = 3; overlap < window; overlap++)
            for (int length = 0; length <= 4 * window && length < MAX_FRAMES; length += length < 3 ? 1 : 13)
                walk(window, overlap, length);
}
END_TEST

START_TEST(paths_about_as_long_as_the_window_work)
{
    for (int window = 4; window <= 12; window++)
        for (int overlap = 3; overlap < window; overlap++)
            for (int length = 0; length <= 3 * window; length++)
                walk(window, overlap, length);
}
END_TEST

START_TEST(sliding_windows_emit_one_frame_each)
{
    L1L2PathSchedule schedule = l1l2_path_schedule_start(10, 9);
    L1L2PathWindow step;
    for (int come = 10; come < 30; come++) {
        ck_assert(l1l2_path_schedule_next(&schedule, come, false, &step));
        ck_assert_int_eq(step.emit, 1);
        ck_assert_int_eq(step.first, come - 10);
        ck_assert(!l1l2_path_schedule_next(&schedule, come, false, &step));
    }
}
END_TEST

START_TEST(early_windows_emit_what_is_asked_and_the_next_ones_are_full_again)
{
    for (int seed = 1; seed <= 300; seed++) {
        const int window = 4 + seed % 20, overlap = 3 + seed % (window - 3), length = 120;
        L1L2Rng rng = l1l2_rng_seeded((uint64_t)seed);
        L1L2PathSchedule schedule = l1l2_path_schedule_start(window, overlap);
        L1L2PathWindow step;
        int next = 0;
        bool early = true; /* so that the first window shares nothing */
        for (int come = 1; come <= length; come++) {
            const bool hurry = l1l2_rng_next(&rng) % 8 == 0;
            const int give = (int)(l1l2_rng_next(&rng) % (unsigned)window);
            while (l1l2_path_schedule_next(&schedule, come, come == length, &step)) {
                ck_assert_int_eq(step.first, next);
                ck_assert_int_eq(step.count, come - next < window ? come - next : window);
                ck_assert_int_eq(step.shared, early ? 0 : overlap);
                ck_assert(!step.early);
                early = false;
                next += step.emit;
            }
            ck_assert_int_lt(come - next, window); /* frame t is emitted when frame t + N - 1 has arrived */
            if (hurry && l1l2_path_schedule_early(&schedule, come, give, &step)) {
                ck_assert_int_eq(step.first, next);
                ck_assert_int_eq(step.count, come - next); /* all that have arrived */
                ck_assert_int_eq(step.emit, give < step.count ? give : step.count);
                ck_assert_int_eq(step.shared, 0);
                ck_assert(step.early);
                early = true;
                next += step.emit;
            }
        }
        ck_assert_int_eq(next, length);
        ck_assert(!l1l2_path_schedule_early(&schedule, length, 5, &step));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("window_schedule");
    TCase *tcase = tcase_create("window_schedule");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, every_frame_is_emitted_once_in_order_and_in_time);
    tcase_add_test(tcase, paths_about_as_long_as_the_window_work);
    tcase_add_test(tcase, sliding_windows_emit_one_frame_each);
    tcase_add_test(tcase, early_windows_emit_what_is_asked_and_the_next_ones_are_full_again);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
