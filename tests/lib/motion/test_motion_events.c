/* SPDX-License-Identifier: MIT */
/* Events of real footage: where paths start, where the motion is predicted, and that it is exact right after that. */
#include "checkx.h"
#include "synth_cases.h"
#include "synth_trial.h"

enum { WIDTH = 480, FRAMES = 135 };

/* The error that counts as exact, px at full contrast; at lower contrast, noise has more effect. */
static const double exact = 0.1;

static SynthTrial trial_of(const char *name, bool overlaid, SynthConfig *cfg)
{
    *cfg = synth_case_at(synth_case_named(name), WIDTH);
    if (!overlaid)
        cfg->overlay = 0, cfg->letterbox = cfg->pillarbox = 0.0;
    return synth_trial_new(cfg, FRAMES);
}

/* Fails if frame t was measured and is not exact, unless the scene is hidden. */
static void expect_exact(const SynthTrial *trial, const char *name, int t)
{
    if (trial->contrast[t] > 0.0 && trial->contrast[t - 1] > 0.0 && !(trial->info[t].flags & L1L2STAB_INFO_MOTION_LOST))
        ck_assert_msg(trial->error[t] <= exact / fmin(trial->contrast[t], trial->contrast[t - 1]),
                      "%s: %g px off in frame %d", name, trial->error[t], t);
}

/* Another shot begins: a path starts at one of frames [first, last], and nowhere else. */
typedef struct Cut {
    const char *name;
    int first, last;
    bool in_the_dark; /* the path may start some frames after the cut, while contrast is low: it jumps there */
} Cut;

static const Cut cuts[] = {
    {"cut", 70, 70, false},
    {"cut through black", 78, 78, false},
    {"fade out, another in", 80, 83, true}, /* while less than a quarter of the contrast is there */
    {"dissolve of 10", 70, 80, false},
    {"dissolve of 30", 70, 100, false},
};

START_TEST(another_shot_starts_a_path)
{
    const Cut *cut = &cuts[_i];
    SynthConfig cfg;
    SynthTrial trial = trial_of(cut->name, true, &cfg);
    int start = 0;
    for (int t = 1; t < FRAMES; t++) {
        if (trial.info[t].model == L1L2STAB_MOTION_SOURCE_NONE) {
            ck_assert_msg(start == 0, "%s: paths start at %d and %d", cut->name, start, t);
            start = t;
        }
        if (t < cut->first || t > cut->last)
            expect_exact(&trial, cut->name, t);
    }
    ck_assert_msg(start >= cut->first && start <= cut->last, "%s: a path starts at %d", cut->name, start);
    if (!cut->in_the_dark)
        ck_assert_double_le(trial.jitter_out, 0.2 * trial.jitter_in);
    synth_trial_free(&trial);
}
END_TEST

/* Something hides the scene in frames [from, to], and may hide it altogether. */
typedef struct Bridge {
    const char *name;
    int from, to;
    bool altogether;
} Bridge;

static const Bridge bridges[] = {
    {"flash", 70, 71, true},
    {"black frames", 70, 79, true},
    {"fade out and in again", 60, 94, true},
    {"lens covered 1 s", 70, 99, true},
    {"lens covered 2 s", 60, 119, true},
    {"dark for 1 s", 70, 99, true},
    {"out of focus", 70, 89, false},
    {"darker by half", 60, FRAMES, false},
    {"flicker", 45, 124, false},
};

START_TEST(a_hidden_scene_is_bridged_and_the_motion_is_exact_again_after_it)
{
    static const double still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const Bridge *b = &bridges[_i];
    SynthConfig cfg;
    SynthTrial trial = trial_of(b->name, true, &cfg);
    double before = 0.0;
    ck_assert_int_eq(trial.starts, 0);
    for (int t = 1; t < FRAMES; t++) {
        const L1L2StabInfo *info = &trial.info[t];
        const double moves = synth_trial_distance(&cfg, info->F, still);
        /* The first frame after it has none before it to be compared with. */
        const bool may_be_lost = b->altogether && t >= b->from && t <= b->to + 1;
        ck_assert_msg(may_be_lost || !(info->flags & L1L2STAB_INFO_MOTION_LOST), "%s: frame %d is lost", b->name, t);
        if (trial.contrast[t] > 0.0)
            expect_exact(&trial, b->name, t);
        else /* the motion before it, fading; noise is none */
            ck_assert_msg(moves <= before + 0.1, "%s: frame %d moves by %g px", b->name, t, moves);
        before = t < b->from ? moves : before;
    }
    ck_assert_double_le(trial.jitter_out, 0.2 * trial.jitter_in);
    synth_trial_free(&trial);
}
END_TEST

START_TEST(repeated_frames_have_no_motion_and_the_output_does_not_jerk)
{
    static const char *const names[] = {"every 5th frame again", "nearly again", "every 2nd, coded",
                                        "frozen for 6 frames"};
    SynthConfig cfg;
    SynthTrial trial = trial_of(names[_i], true, &cfg);
    ck_assert_int_eq(trial.starts + trial.lost, 0);
    for (int t = 1; t < FRAMES; t++)
        ck_assert_msg(trial.error[t] <= exact, "%s: %g px off in frame %d", names[_i], trial.error[t], t);
    ck_assert_double_ge(trial.jitter_in, 1.0);
    ck_assert_double_le(trial.jitter_out, 0.1);
    synth_trial_free(&trial);
}
END_TEST

START_TEST(static_overlays_and_bars_do_not_change_the_motion)
{
    static const char *const names[] = {"logo and timecode", "logo and timecode, dark", "letterbox",
                                        "pillarbox and logo"};
    SynthConfig cfg;
    SynthTrial trial = trial_of(names[_i], true, &cfg), without = trial_of(names[_i], false, &cfg);
    ck_assert_int_eq(trial.starts, 0);
    ck_assert_int_le(trial.lost, FRAMES / 50);
    ck_assert_msg(trial.rms <= 1.5 * without.rms + 0.05, "%s: %g px off, %g without it", names[_i], trial.rms,
                  without.rms);
    ck_assert_double_le(trial.jitter_out, 1.5 * without.jitter_out + 0.05);
    synth_trial_free(&trial);
    synth_trial_free(&without);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_events");
    TCase *tc = tcase_create("motion_events");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, another_shot_starts_a_path, 0, sizeof cuts / sizeof cuts[0]);
    tcase_add_loop_test(tc, a_hidden_scene_is_bridged_and_the_motion_is_exact_again_after_it, 0,
                        sizeof bridges / sizeof bridges[0]);
    tcase_add_loop_test(tc, repeated_frames_have_no_motion_and_the_output_does_not_jerk, 0, 4);
    tcase_add_loop_test(tc, static_overlays_and_bars_do_not_change_the_motion, 0, 4);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
