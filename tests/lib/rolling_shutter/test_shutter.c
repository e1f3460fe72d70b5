/* SPDX-License-Identifier: MIT */
/* Step 4 through the public header: clips whose rows were taken at their own times. */
#include <string.h>

#include "stabilizer_fixture.h"

enum { FRAMES = 48 };

static Clip *clip_of(SynthConfig cfg)
{
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.shake = 2.0, cfg.roll = 0.002;
    Synth *synth = synth_new(&cfg);
    Clip *clip = calloc(1, sizeof *clip);
    clip->frames = FRAMES;
    for (int t = 0; t < FRAMES; t++) {
        clip->picture[t] = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
        synth_render(synth, t, L1L2STAB_FORMAT_I420, clip->picture[t].data, clip->picture[t].stride);
    }
    synth_free(synth);
    return clip;
}

static Clip *rolling_clip(void)
{
    SynthConfig cfg = synth_defaults();
    cfg.readout = 0.03;
    return clip_of(cfg);
}

static void run(L1L2StabRollingShutter model, int window, int threads, bool bypass, Clip *clip,
                L1L2StabInfo info[FRAMES], SynthPicture out[FRAMES])
{
    L1L2StabConfig cfg = small_config(window);
    cfg.rolling_shutter = model;
    cfg.threads = threads;
    L1L2Stab *s = create(&cfg);
    for (int t = 0; t < FRAMES; t++) {
        clip->released[t] = 0;
        out[t] = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
    }
    if (bypass)
        ck_assert_int_eq(l1l2stab_set_bypass(s, 1), L1L2STAB_OK);
    ck_assert_int_eq(stabilize(s, clip, info, out), FRAMES);
    l1l2stab_free(&s);
}

static void free_pictures(SynthPicture out[FRAMES])
{
    for (int t = 0; t < FRAMES; t++)
        synth_picture_free(&out[t]);
}

START_TEST(the_residual_is_removed_on_request_and_the_threads_change_no_bit)
{
    static L1L2StabInfo info[FRAMES];
    SynthPicture one[FRAMES], many[FRAMES];
    Clip *clip = rolling_clip();
    for (int model = L1L2STAB_ROLLING_SHUTTER_NONE; model <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; model++) {
        double longest = 0.0;
        run((L1L2StabRollingShutter)model, 24, 1, false, clip, info, one);
        for (int t = 0; t < FRAMES; t++)
            longest = fmax(longest, info[t].residual);
        ck_assert(model == L1L2STAB_ROLLING_SHUTTER_NONE ? longest == 0.0 : longest > 0.3);
        run((L1L2StabRollingShutter)model, 24, 5, false, clip, info, many);
        for (int t = 0; t < FRAMES; t++)
            ck_assert_mem_eq(one[t].data[0], many[t].data[0], one[t].size);
        free_pictures(one);
        free_pictures(many);
    }
    free_clip(clip);
}
END_TEST

START_TEST(a_bypassed_frame_is_not_changed)
{
    static L1L2StabInfo info[FRAMES];
    SynthPicture out[FRAMES];
    Clip *clip = rolling_clip();
    run(L1L2STAB_ROLLING_SHUTTER_MIXTURE, 24, 1, true, clip, info, out);
    for (int t = 0; t < FRAMES; t++) {
        ck_assert_double_eq(info[t].residual, 0.0);
        ck_assert_mem_eq(out[t].data[0], clip->picture[t].data[0], out[t].size);
    }
    free_pictures(out);
    free_clip(clip);
}
END_TEST

/* In the middle and at a side, with little look-ahead. A frame without a residual is the same to the bit as without
 * step 4. */
START_TEST(a_slow_subject_on_40_percent_of_the_frame_is_not_taken_for_a_rolling_shutter)
{
    static L1L2StabInfo info[FRAMES];
    SynthPicture plain[FRAMES], out[FRAMES];
    const double where[] = {0.0, 0.2};
    for (int i = 0; i < 2; i++) {
        SynthConfig cfg = synth_defaults();
        cfg.foreground = 0.4, cfg.movers = 1, cfg.mover_speed = 1.0, cfg.mover_x = where[i];
        Clip *clip = clip_of(cfg);
        run(L1L2STAB_ROLLING_SHUTTER_NONE, 24, 1, false, clip, info, plain);
        for (int model = L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY; model <= L1L2STAB_ROLLING_SHUTTER_MIXTURE; model++) {
            run((L1L2StabRollingShutter)model, 24, 1, false, clip, info, out);
            for (int t = 0; t < FRAMES; t++) {
                ck_assert_double_lt(info[t].residual, 0.5);
                if (info[t].residual == 0.0)
                    ck_assert_mem_eq(out[t].data[0], plain[t].data[0], out[t].size);
            }
            free_pictures(out);
        }
        free_pictures(plain);
        free_clip(clip);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("shutter");
    TCase *tcase = tcase_create("shutter");
    tcase_add_test(tcase, the_residual_is_removed_on_request_and_the_threads_change_no_bit);
    tcase_add_test(tcase, a_bypassed_frame_is_not_changed);
    tcase_add_test(tcase, a_slow_subject_on_40_percent_of_the_frame_is_not_taken_for_a_rolling_shutter);
    tcase_set_timeout(tcase, 60);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
