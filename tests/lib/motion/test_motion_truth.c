/* SPDX-License-Identifier: MIT */
/* Accuracy of the measured motion at the library's defaults, on planar synthetic clips with noise of sigma 5. */
#include "checkx.h"
#include "formats.h"
#include "synth_cases.h"
#include "synth_trial.h"

enum { MAX_CASES = 16 };

static int ascending(const void *a, const void *b)
{
    return *(const double *)a < *(const double *)b ? -1 : *(const double *)a > *(const double *)b;
}

/* Shake of up to 30 px, roll of up to 3 degrees, zoom of up to 5 % a frame, and all together. */
START_TEST(the_motion_of_planar_clips_is_exact_to_a_twentieth_of_a_pixel)
{
    double rms[MAX_CASES];
    int count = 0;
    for (int i = 0; i < synth_case_count && count < MAX_CASES; i++) {
        if (synth_cases[i].kind != SYNTH_CASE_PLANAR)
            continue;
        SynthTrial trial = synth_trial_new(&synth_cases[i].cfg, 30);
        ck_assert_msg(trial.rms <= 0.2, "%s: %g px", synth_cases[i].name, trial.rms);
        ck_assert_msg(trial.lost == 0 && trial.starts == 0, "%s: lost", synth_cases[i].name);
        rms[count++] = trial.rms;
        synth_trial_free(&trial);
    }
    ck_assert_int_ge(count, 10);
    qsort(rms, (size_t)count, sizeof *rms, ascending);
    ck_assert_double_le(rms[count / 2], 0.05);
}
END_TEST

START_TEST(the_path_drifts_by_less_than_a_pixel_in_ten_seconds)
{
    static const char *const names[] = {"shake 2 px", "shake 10 px, roll, zoom", "roll to 3 degrees a frame"};
    double drift[3];
    for (int k = 0; k < 3; k++) {
        SynthTrial trial = synth_trial_new(&synth_case_named(names[k])->cfg, 300);
        ck_assert_msg(trial.drift <= 3.0, "%s: %g px", names[k], trial.drift);
        drift[k] = trial.drift;
        synth_trial_free(&trial);
    }
    qsort(drift, 3, sizeof *drift, ascending);
    ck_assert_double_le(drift[1], 1.0);
}
END_TEST

START_TEST(a_tripod_stays_where_it_is_for_a_thousand_frames)
{
    enum { FRAMES = 1000 };
    SynthConfig cfg = synth_defaults();
    cfg.shake = cfg.roll = 0.0;
    cfg.noise = 5.0, cfg.seed = 2;
    SynthTrial trial = synth_trial_new(&cfg, FRAMES);
    ck_assert_int_eq(trial.lost + trial.starts, 0);
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int t = 0; t < FRAMES; t++) {
        ck_assert_double_le(trial.error[t], 0.1);
        ck_assert_double_le(trial.bias[t], 0.1);
        ck_assert_double_le(synth_trial_distance(&cfg, trial.info[t].B, identity), 0.1);
    }
    synth_trial_free(&trial);
}
END_TEST

START_TEST(ten_bits_give_the_motion_of_eight)
{
    static const char *const names[] = {"shake 5 px", "walking", "tripod"};
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420_10LE, L1L2STAB_FORMAT_P010_10LE,
                                             L1L2STAB_FORMAT_GRAY16_LE};
    const SynthConfig *cfg = &synth_case_named(names[_i])->cfg;
    if (format_left_out(formats[_i]))
        return;
    SynthTrial eight = synth_trial_new(cfg, 30), more = synth_trial_in(cfg, 30, formats[_i]);
    for (int t = 0; t < 30; t++) {
        const double apart = synth_trial_distance(cfg, eight.info[t].F, more.info[t].F);
        ck_assert_msg(apart <= 0.05, "%s: %g px apart in frame %d", names[_i], apart, t);
    }
    synth_trial_free(&eight);
    synth_trial_free(&more);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_truth");
    TCase *tc = tcase_create("motion_truth");
    tcase_set_timeout(tc, 110);
    tcase_add_test(tc, the_motion_of_planar_clips_is_exact_to_a_twentieth_of_a_pixel);
    tcase_add_test(tc, the_path_drifts_by_less_than_a_pixel_in_ten_seconds);
    tcase_add_test(tc, a_tripod_stays_where_it_is_for_a_thousand_frames);
    tcase_add_loop_test(tc, ten_bits_give_the_motion_of_eight, 0, 3);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
