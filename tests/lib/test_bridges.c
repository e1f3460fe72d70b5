/* SPDX-License-Identifier: MIT */
/* Frames that are blurred by a jerk of the camera, through the whole library: the path behind them is where the camera
 * is. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "checkx.h"
#include "common/geom.h"
#include "synth_hard.h"

#include <l1l2stab/l1l2stab.h>

enum { FRAMES = 36, MAX = 640 * 360 };

typedef struct Trial {
    SynthHard *clip;
    int width, height;
    L1L2StabInfo info[FRAMES];
    int pulled;
} Trial;

static void release(void *opaque)
{
    free(opaque);
}

static void pull_all(L1L2Stab *stab, Trial *trial)
{
    while (trial->pulled < FRAMES && l1l2stab_pull(stab, NULL, &trial->info[trial->pulled]) == L1L2STAB_OK)
        trial->pulled++;
}

static L1L2StabConfig config_of(const Trial *trial, int window)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = trial->width, cfg.height = trial->height, cfg.window = window;
    return cfg;
}

static Trial *trial_new(const char *name, int window)
{
    Trial *trial = calloc(1, sizeof *trial);
    SynthHardConfig clip = synth_hard_case_named(name)->cfg;
    clip.noise = 5.0, clip.seed = 1;
    trial->clip = synth_hard_new(&clip);
    trial->width = clip.width, trial->height = clip.height;
    const L1L2StabConfig cfg = config_of(trial, window);
    L1L2Stab *stab;
    ck_assert_int_eq(l1l2stab_create(&stab, &cfg), L1L2STAB_OK);
    for (int t = 0; t < FRAMES; t++) {
        uint8_t *gray = malloc(MAX);
        synth_hard_render(trial->clip, t, gray, clip.width);
        const L1L2StabFrame frame = {.data = {gray}, .stride = {clip.width}, .opaque = gray, .release = release};
        ck_assert_int_eq(l1l2stab_push(stab, &frame), L1L2STAB_OK);
        pull_all(stab, trial);
    }
    ck_assert_int_eq(l1l2stab_finish(stab), L1L2STAB_OK);
    pull_all(stab, trial);
    ck_assert_int_eq(trial->pulled, FRAMES);
    l1l2stab_free(&stab);
    return trial;
}

static void trial_free(Trial *trial)
{
    synth_hard_free(trial->clip);
    free(trial);
}

static double corner_error(const Trial *trial, const L1L2Mat *F, const L1L2Mat *G)
{
    return l1l2_mat_corner_distance(F, G, 0.5 * trial->width, 0.5 * trial->height);
}

/* The worst error of a frame's motion, and of the motion from a sharp frame to the next one behind blurred ones. */
static void errors(const Trial *trial, double *worst, double *behind, int *bridged)
{
    L1L2Mat chain = l1l2_mat_identity(), true_chain = chain;
    int sharp = 0;
    *worst = *behind = 0.0;
    *bridged = 0;
    for (int t = 1; t < FRAMES; t++) {
        L1L2Mat F, truth;
        double x, y;
        memcpy(F.m, trial->info[t].F, sizeof F.m);
        synth_hard_motion(trial->clip, t, 1, truth.m);
        *worst = fmax(*worst, corner_error(trial, &F, &truth));
        *bridged += (trial->info[t].flags & L1L2STAB_INFO_BRIDGED) != 0;
        chain = l1l2_mat_mul(chain, F), true_chain = l1l2_mat_mul(true_chain, truth);
        synth_hard_blur(trial->clip, t, &x, &y);
        if (hypot(x, y) > 6.0)
            continue;
        if (t - sharp > 1)
            *behind = fmax(*behind, corner_error(trial, &chain, &true_chain));
        chain = true_chain = l1l2_mat_identity();
        sharp = t;
    }
}

/* A jerk of 40 px a frame every sixth frame: the blurred frame within 3 px, what is behind it within half a pixel. */
START_TEST(a_blurred_frame_leaves_no_step_in_the_path)
{
    Trial *trial = trial_new("blur 40 px", 30);
    double worst, behind;
    int bridged;
    errors(trial, &worst, &behind, &bridged);
    ck_assert_msg(worst < 3.0 && behind < 0.5, "worst %g px, behind a gap %g px", worst, behind);
    ck_assert_int_ge(bridged, 8);
    for (int t = 0; t < FRAMES; t++)
        ck_assert_int_eq(trial->info[t].flags & L1L2STAB_INFO_MOTION_LOST, 0);
    trial_free(trial);
}
END_TEST

/* Where the blurred frame has gone out already, the frame behind the gap makes up for it. */
START_TEST(the_path_behind_a_gap_is_right_with_the_shortest_window_too)
{
    Trial *trial = trial_new("blur 40 px", 4);
    double worst, behind;
    int bridged;
    errors(trial, &worst, &behind, &bridged);
    ck_assert_msg(behind < 0.5, "%g px", behind);
    trial_free(trial);
}
END_TEST

START_TEST(two_blurred_frames_in_a_row_are_bridged)
{
    Trial *trial = trial_new("blur of 2 frames", 30);
    double worst, behind;
    int bridged;
    errors(trial, &worst, &behind, &bridged);
    ck_assert_msg(worst < 3.0 && behind < 1.0, "worst %g px, behind a gap %g px", worst, behind);
    ck_assert_int_ge(bridged, 3);
    trial_free(trial);
}
END_TEST

/* A bridge changes motions of frames that are held. The path has to be the one that the final motions give, if no
 * window was solved before. */
START_TEST(the_path_is_that_of_the_changed_motions_bit_by_bit)
{
    Trial *trial = trial_new("blur of 2 frames", FRAMES + 1);
    L1L2StabConfig cfg = config_of(trial, FRAMES + 1);
    L1L2Stab *stab;
    ck_assert_int_eq(l1l2stab_create(&stab, &cfg), L1L2STAB_OK);
    int pulled = 0;
    for (int t = 0; t <= FRAMES; t++) {
        const L1L2StabFrame frame = {.motion = trial->info[t < FRAMES ? t : 0].F};
        L1L2StabInfo info;
        ck_assert_int_eq(t < FRAMES ? l1l2stab_push(stab, &frame) : l1l2stab_finish(stab), L1L2STAB_OK);
        for (; l1l2stab_pull(stab, NULL, &info) == L1L2STAB_OK; pulled++)
            ck_assert_mem_eq(info.B, trial->info[pulled].B, sizeof info.B);
    }
    ck_assert_int_eq(pulled, FRAMES);
    l1l2stab_free(&stab);
    trial_free(trial);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bridges");
    TCase *tc = tcase_create("bridges");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, a_blurred_frame_leaves_no_step_in_the_path);
    tcase_add_test(tc, the_path_behind_a_gap_is_right_with_the_shortest_window_too);
    tcase_add_test(tc, the_path_is_that_of_the_changed_motions_bit_by_bit);
    tcase_add_test(tc, two_blurred_frames_in_a_row_are_bridged);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
