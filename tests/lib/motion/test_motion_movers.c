/* SPDX-License-Identifier: MIT */
/* The background's motion is measured while subjects move on a large part of the frame. */
#include "checkx.h"
#include "synth_cases.h"
#include "synth_trial.h"

static const char *const fifths[] = {"mover on 20 %", "mover on 40 %", "mover on 40 %, fast", "mover on 40 %, slow",
                                     "mover on 40 %, in the frame", "mover on 40 %, tripod", "walkers on 25 %",
                                     "walkers on 50 %"};

START_TEST(the_background_is_followed_where_movers_cover_two_fifths)
{
    SynthTrial trial = synth_trial_new(&synth_case_named(fifths[_i])->cfg, 100);
    ck_assert_msg(trial.rms < 0.3, "%s: %g px", fifths[_i], trial.rms);
    ck_assert_int_eq(trial.lost + trial.starts, 0);
    synth_trial_free(&trial);
}
END_TEST

START_TEST(a_mover_on_three_fifths_is_not_followed_with_confidence)
{
    const SynthConfig cfg = synth_case_at(synth_case_named("mover on 60 %"), 640);
    SynthTrial trial = synth_trial_new(&cfg, 150);
    int confident = 0;
    for (int t = 1; t < trial.frames; t++)
        confident += trial.error[t] > 0.5 && trial.info[t].quality >= 0.5;
    ck_assert_msg(confident <= trial.frames / 20, "%d of %d frames are wrong with high quality", confident,
                  trial.frames);
    SynthConfig empty = cfg;
    empty.foreground = 0.0;
    SynthTrial without = synth_trial_new(&empty, 60);
    ck_assert_double_ge(without.quality, 0.8); /* what it says of the same clip without the mover */
    synth_trial_free(&trial);
    synth_trial_free(&without);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_movers");
    TCase *tc = tcase_create("motion_movers");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, the_background_is_followed_where_movers_cover_two_fifths, 0,
                        sizeof fifths / sizeof fifths[0]);
    tcase_add_test(tc, a_mover_on_three_fifths_is_not_followed_with_confidence);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
