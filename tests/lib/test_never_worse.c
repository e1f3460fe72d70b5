/* SPDX-License-Identifier: MIT */
/* No footage comes out shakier than it went in, by the true motion of synthetic clips. */
#include "checkx.h"
#include "synth_cases.h"
#include "synth_trial.h"

START_TEST(no_clip_becomes_shakier)
{
    const SynthCase *c = &synth_cases[_i];
    const SynthConfig cfg = synth_case_at(c, 320);
    SynthTrial trial = synth_trial_new(&cfg, 135);
    const double still = 0.1; /* px: noise leaves as much where nothing moves */
    ck_assert_msg(trial.jitter_out <= fmax(trial.jitter_in, still), "%s: %g px in, %g px out", c->name, trial.jitter_in,
                  trial.jitter_out);
    synth_trial_free(&trial);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("never_worse");
    TCase *tc = tcase_create("never_worse");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, no_clip_becomes_shakier, 0, synth_case_count);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
