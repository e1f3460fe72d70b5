/* SPDX-License-Identifier: MIT */
/* Region and mask: the caller chooses what is measured. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "checkx.h"
#include "synth_cases.h"
#include "synth_trial.h"

enum { WIDTH = 640, HEIGHT = 360, FRAMES = 60, MASK_W = 320, MASK_H = 180 };

static uint8_t mask[MASK_W * MASK_H];

static void set_mask(L1L2StabConfig *config)
{
    config->mask = mask;
    config->mask_stride = config->mask_width = MASK_W;
    config->mask_height = MASK_H;
}

/* Excludes an ellipse: center and semi-axes in parts of the frame's sides. */
static void mask_ellipse(double center_x, double half_w, double half_h)
{
    for (int y = 0; y < MASK_H; y++)
        for (int x = 0; x < MASK_W; x++) {
            const double u = ((x + 0.5) / MASK_W - 0.5 - center_x) / half_w, v = ((y + 0.5) / MASK_H - 0.5) / half_h;
            mask[y * MASK_W + x] = u * u + v * v < 1.0 ? 0 : 255;
        }
}

static void set_left_fifth(L1L2StabConfig *config)
{
    config->region[2] = 0.2;
}

/* ---- The background's motion, where most of the picture is something else ---- */

static const double exact = 0.3; /* px: rms over the frame's corners */

/* The error with a setting. Without it, the mover is followed: else the clip would show nothing. */
static void check_follows_background(const SynthConfig *cfg, SynthTrialSetting set)
{
    SynthTrial without = synth_trial_new(cfg, FRAMES);
    SynthTrial with = synth_trial_with(cfg, FRAMES, L1L2STAB_FORMAT_GRAY8, set);
    ck_assert_msg(without.rms > 1.0, "%g px without", without.rms);
    ck_assert_msg(with.rms < exact, "%g px", with.rms);
    ck_assert_int_eq(with.lost + with.starts, 0);
    ck_assert_double_ge(with.quality, 0.8);
    ck_assert_msg(with.jitter_out < 0.2 * with.jitter_in, "%g px out", with.jitter_out);
    synth_trial_free(&without);
    synth_trial_free(&with);
}

START_TEST(the_background_is_followed_by_a_mask_of_a_mover_on_three_fifths)
{
    const SynthConfig cfg = synth_case_at(synth_case_named("mover on 60 %"), WIDTH);
    mask_ellipse(0.0, 0.5, 0.46); /* sqrt(0.6 / pi), its way, and the shake */
    check_follows_background(&cfg, set_mask);
}
END_TEST

START_TEST(the_background_is_followed_by_a_region_beside_a_mover_on_three_fifths)
{
    SynthConfig cfg = synth_case_at(synth_case_named("mover on 60 %"), WIDTH);
    cfg.foreground = 0.75; /* of which a fifth lies beyond the right side */
    cfg.mover_x = 0.25;
    check_follows_background(&cfg, set_left_fifth);
}
END_TEST

/* ---- What is excluded does not count ---- */

static L1L2StabConfig config_of(int window)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.frame_rate = 30;
    cfg.window = window;
    cfg.threads = 1;
    return cfg;
}

static L1L2Stab *stab_new(const L1L2StabConfig *cfg)
{
    L1L2Stab *stab;
    ck_assert_int_eq(l1l2stab_create(&stab, cfg), L1L2STAB_OK);
    return stab;
}

/* The first frames of a clip that shakes. */
static uint8_t *clip_new(int frames)
{
    SynthConfig cfg = synth_defaults();
    cfg.pan_x = 1.0;
    Synth *synth = synth_new(&cfg);
    uint8_t *clip = malloc((size_t)frames * WIDTH * HEIGHT);
    ck_assert_ptr_nonnull(clip);
    for (int t = 0; t < frames; t++)
        synth_render_gray(synth, t, clip + (size_t)t * WIDTH * HEIGHT, WIDTH);
    synth_free(synth);
    return clip;
}

static void run(L1L2Stab *stab, uint8_t *clip, int frames, L1L2StabInfo *info)
{
    int got = 0;
    for (int t = 0; t < frames; t++) {
        const L1L2StabFrame frame = {.data = {clip + (size_t)t * WIDTH * HEIGHT}, .stride = {WIDTH}, .pts = t};
        ck_assert_int_eq(l1l2stab_push(stab, &frame), L1L2STAB_OK);
        while (l1l2stab_pull(stab, NULL, &info[got]) == L1L2STAB_OK)
            got++;
    }
    l1l2stab_finish(stab);
    while (got < frames && l1l2stab_pull(stab, NULL, &info[got]) == L1L2STAB_OK)
        got++;
    ck_assert_int_eq(got, frames);
}

enum { SHORT = 12 };

static void run_new(const L1L2StabConfig *cfg, uint8_t *clip, L1L2StabInfo info[SHORT])
{
    L1L2Stab *stab = stab_new(cfg);
    run(stab, clip, SHORT, info);
    l1l2stab_free(&stab);
}

/* The columns [96, 352) of 640, the rows [72, 216) of 360. */
static void set_middle(L1L2StabConfig *cfg)
{
    const double region[4] = {0.15, 0.2, 0.4, 0.4};
    memcpy(cfg->region, region, sizeof region);
}

static void set_middle_by_mask(L1L2StabConfig *cfg)
{
    for (int y = 0; y < MASK_H; y++)
        for (int x = 0; x < MASK_W; x++)
            mask[y * MASK_W + x] = x >= 48 && x < 176 && y >= 36 && y < 108;
    set_mask(cfg);
}

static const SynthTrialSetting middles[] = {set_middle, set_middle_by_mask};

START_TEST(every_track_lies_in_the_area)
{
    enum { REACH = 8 }; /* px: of the windows by which corners are searched, at half size */
    L1L2StabConfig cfg = config_of(4);
    middles[_i](&cfg);
    uint8_t *whole = clip_new(SHORT), *outside = clip_new(SHORT), *inside = clip_new(SHORT);
    for (int t = 0; t < SHORT; t++)
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const bool within = x >= 96 - REACH && x < 352 + REACH && y >= 72 - REACH && y < 216 + REACH;
                (within ? outside : inside)[((size_t)t * HEIGHT + (size_t)y) * WIDTH + (size_t)x] = 128;
            }
    L1L2StabInfo all[SHORT], info[SHORT];
    run_new(&cfg, whole, all);
    run_new(&cfg, outside, info);
    for (int t = 1; t < SHORT; t++) {
        ck_assert_int_gt(all[t].tracks, 50);
        ck_assert_int_eq(info[t].tracks, 0);
        ck_assert(info[t].model < L1L2STAB_MOTION_SOURCE_GIVEN); /* nothing was measured */
    }
    run_new(&cfg, inside, info);
    for (int t = 1; t < SHORT; t++)
        ck_assert_int_gt(info[t].tracks, 50);
    free(whole);
    free(outside);
    free(inside);
}
END_TEST

/* ---- Same as ... ---- */

static bool same(const L1L2StabInfo *a, const L1L2StabInfo *b)
{
    return memcmp(a->F, b->F, sizeof a->F) == 0 && memcmp(a->B, b->B, sizeof a->B) == 0 && a->tracks == b->tracks &&
           a->inliers == b->inliers && memcmp(&a->quality, &b->quality, sizeof a->quality) == 0;
}

static void assert_same(const L1L2StabInfo *a, const L1L2StabInfo *b, bool expected, const char *what)
{
    bool all = true;
    for (int t = 0; t < SHORT; t++)
        all = all && same(&a[t], &b[t]);
    ck_assert_msg(all == expected, "%s", what);
}

START_TEST(a_mask_that_excludes_nothing_changes_nothing)
{
    L1L2StabConfig cfg = config_of(4);
    uint8_t *clip = clip_new(SHORT);
    L1L2StabInfo without[SHORT], with[SHORT];
    run_new(&cfg, clip, without);
    memset(mask, 1, sizeof mask);
    set_mask(&cfg);
    run_new(&cfg, clip, with);
    assert_same(without, with, true, "a mask without zeros");
    cfg.mask = NULL; /* what else is set is not read */
    cfg.mask_width = -1;
    run_new(&cfg, clip, with);
    assert_same(without, with, true, "no mask");
    free(clip);
}
END_TEST

START_TEST(a_mask_of_any_size_is_scaled_to_the_frame)
{
    static const struct {
        int width, height, stride;
    } sizes[] = {{5, 1, 5}, {5, 3, 64}, {320, 180, 320}, {1000, 2, 1111}, {640, 720, 640}};
    L1L2StabConfig cfg = config_of(4);
    uint8_t *clip = clip_new(SHORT);
    L1L2StabInfo by_region[SHORT], by_mask[SHORT], all[SHORT];
    run_new(&cfg, clip, all);
    cfg.region[2] = 0.2;
    run_new(&cfg, clip, by_region);
    assert_same(all, by_region, false, "the region has no effect");
    cfg.region[2] = 1.0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const size_t bytes = (size_t)sizes[i].stride * (size_t)sizes[i].height;
        uint8_t *left_fifth = malloc(bytes);
        ck_assert_ptr_nonnull(left_fifth);
        for (size_t k = 0; k < bytes; k++)
            left_fifth[k] = k % (size_t)sizes[i].stride < (size_t)sizes[i].width / 5 ? 200 : 0;
        cfg.mask = left_fifth;
        cfg.mask_stride = sizes[i].stride;
        cfg.mask_width = sizes[i].width, cfg.mask_height = sizes[i].height;
        L1L2Stab *stab = stab_new(&cfg);
        free(left_fifth); /* the mask is read by create() alone */
        run(stab, clip, SHORT, by_mask);
        assert_same(by_region, by_mask, true, "region and mask differ");
        l1l2stab_reset(stab);
        run(stab, clip, SHORT, by_mask);
        assert_same(by_region, by_mask, true, "after a reset");
        l1l2stab_free(&stab);
    }
    free(clip);
}
END_TEST

START_TEST(region_and_mask_exclude_together)
{
    L1L2StabConfig one = config_of(4), two = config_of(4);
    uint8_t *clip = clip_new(SHORT);
    L1L2StabInfo by_region[SHORT], by_both[SHORT];
    const double quarter[4] = {0.0, 0.5, 0.5, 0.5};
    const uint8_t left[2] = {1, 0};
    memcpy(one.region, quarter, sizeof quarter);
    two.region[1] = two.region[3] = 0.5;
    two.mask = left;
    two.mask_stride = two.mask_width = 2;
    two.mask_height = 1;
    run_new(&one, clip, by_region);
    run_new(&two, clip, by_both);
    assert_same(by_region, by_both, true, "the left half of the lower half");
    free(clip);
}
END_TEST

START_TEST(cuts_are_found_in_the_whole_picture)
{
    SynthTrial trial = synth_trial_with(&synth_case_named("cut")->cfg, 80, L1L2STAB_FORMAT_GRAY8, set_left_fifth);
    ck_assert_int_eq(trial.starts, 1);
    ck_assert(trial.info[70].flags & L1L2STAB_INFO_PATH_START);
    ck_assert_int_eq(trial.lost, 0);
    synth_trial_free(&trial);
}
END_TEST

/* ---- Too little is left ---- */

static char last_message[512];

static void remember_first(void *cookie, L1L2StabLogLevel level, const char *message)
{
    if (level == L1L2STAB_LOG_ERROR && last_message[0] == '\0')
        snprintf(last_message, sizeof last_message, "%s", message);
}

static void check_is_too_little(const L1L2StabConfig *cfg)
{
    L1L2Stab *stab = (L1L2Stab *)cfg;
    last_message[0] = '\0';
    ck_assert_int_eq(l1l2stab_create(&stab, cfg), L1L2STAB_ERR_ARGUMENT);
    ck_assert_ptr_null(stab);
    ck_assert_msg(strstr(last_message, "region and mask leave") && strstr(last_message, "at least 1 %"), "\"%s\"",
                  last_message);
}

START_TEST(an_area_that_leaves_too_little_is_refused_with_the_part_that_is_left)
{
    L1L2StabConfig cfg = config_of(4);
    cfg.logger.write = remember_first;
    memset(mask, 0, sizeof mask);
    set_mask(&cfg);
    check_is_too_little(&cfg);
    memset(mask, 255, MASK_W * MASK_H / 2); /* the upper half, and the lower one by the region */
    cfg.region[1] = cfg.region[3] = 0.5;
    check_is_too_little(&cfg);
    for (int i = 0; i < MASK_W * MASK_H; i++)
        mask[i] = (uint8_t)(i % 2); /* no place is large enough to track anything */
    cfg.region[1] = 0.0, cfg.region[3] = 1.0;
    cfg.mask_stride = cfg.mask_width = 2 * MASK_W;
    cfg.mask_height = MASK_H / 2;
    check_is_too_little(&cfg);
}
END_TEST

START_TEST(the_smallest_region_is_measured_wherever_it_lies)
{
    static const int sizes[][2] = {{64, 48}, {640, 360}, {854, 480}, {1920, 1080}, {1080, 1920}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int k = 0; k <= 20; k++) {
            L1L2StabConfig cfg = config_of(4);
            cfg.width = sizes[i][0], cfg.height = sizes[i][1];
            cfg.region[0] = cfg.region[1] = k / 20.0 * 0.875;
            cfg.region[2] = cfg.region[3] = 0.125;
            if (cfg.width == 64)
                cfg.region[0] = cfg.region[1] = 0.5; /* else it may have no whole pixel */
            L1L2Stab *stab = stab_new(&cfg);
            l1l2stab_free(&stab);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("region");
    TCase *tc = tcase_create("region");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, the_background_is_followed_by_a_mask_of_a_mover_on_three_fifths);
    tcase_add_test(tc, the_background_is_followed_by_a_region_beside_a_mover_on_three_fifths);
    tcase_add_loop_test(tc, every_track_lies_in_the_area, 0, sizeof middles / sizeof *middles);
    tcase_add_test(tc, a_mask_that_excludes_nothing_changes_nothing);
    tcase_add_test(tc, a_mask_of_any_size_is_scaled_to_the_frame);
    tcase_add_test(tc, region_and_mask_exclude_together);
    tcase_add_test(tc, cuts_are_found_in_the_whole_picture);
    tcase_add_test(tc, an_area_that_leaves_too_little_is_refused_with_the_part_that_is_left);
    tcase_add_test(tc, the_smallest_region_is_measured_wherever_it_lies);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
