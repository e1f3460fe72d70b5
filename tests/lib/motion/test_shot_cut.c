/* SPDX-License-Identifier: MIT */
/* Cuts, and clips that resemble one: two synthetic scenes, black frames and flashes. */
#include <string.h>

#include "checkx.h"
#include "motion/motion.h"
#include "motion/shot_cut.h"
#include "synth.h"

enum { WIDTH = 320, HEIGHT = 180, FRAMES = 60 };

/* What a frame shows. */
typedef enum Shows { SCENE_A, SCENE_B, BLACK, WHITE, BRIGHT_A } Shows;

/* A clip in which frame t shows shows[t]; whether a path starts at each frame. */
static void find_starts(const Shows shows[FRAMES], bool starts[FRAMES], L1L2StabMotionSource models[FRAMES])
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.noise = 2.0, cfg.pan_x = 1.0;
    Synth *a = synth_new(&cfg);
    cfg.seed = 77;
    Synth *b = synth_new(&cfg);
    static uint8_t picture[WIDTH * HEIGHT];
    const L1L2MotionConfig motion = {
        .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .width = WIDTH, .height = HEIGHT,
        .analysis_size = 640, .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1};
    L1L2Motion *m;
    ck_assert_int_eq(l1l2_motion_create(&m, &motion), L1L2STAB_OK);
    for (int t = 0; t < FRAMES; t++) {
        L1L2MotionResult result;
        if (shows[t] == BLACK || shows[t] == WHITE)
            memset(picture, shows[t] == BLACK ? 16 : 235, sizeof picture);
        else
            synth_render_gray(shows[t] == SCENE_B ? b : a, t, picture, WIDTH);
        for (int i = 0; shows[t] == BRIGHT_A && i < WIDTH * HEIGHT; i++)
            picture[i] = (uint8_t)(128 + picture[i] / 3);
        ck_assert_int_eq(l1l2_motion_push(m, picture, WIDTH, t == 0, &result), L1L2STAB_OK);
        starts[t] = result.model == L1L2STAB_MOTION_SOURCE_NONE;
        models[t] = result.model;
    }
    l1l2_motion_free(m);
    synth_free(a);
    synth_free(b);
}

static void fill(Shows shows[FRAMES], int from, int to, Shows what)
{
    for (int t = from; t < to; t++)
        shows[t] = what;
}

/* Fails unless paths start at frame 0 and at `cut` (0: nowhere else). */
static void expect_cut(const Shows shows[FRAMES], int cut)
{
    bool starts[FRAMES];
    L1L2StabMotionSource models[FRAMES];
    find_starts(shows, starts, models);
    for (int t = 0; t < FRAMES; t++)
        ck_assert_msg(starts[t] == (t == 0 || t == cut), "frame %d: a path %s", t, starts[t] ? "starts" : "goes on");
    for (int t = cut + 1; t < FRAMES && cut > 0; t++) /* and the new shot is measured at once */
        ck_assert_int_eq(models[t], L1L2STAB_MOTION_SOURCE_SIMILARITY);
}

START_TEST(a_cut_starts_a_path_at_its_first_frame)
{
    Shows shows[FRAMES] = {SCENE_A};
    fill(shows, 23, FRAMES, SCENE_B);
    expect_cut(shows, 23);
}
END_TEST

START_TEST(a_cut_through_black_starts_a_path_where_the_picture_comes_back)
{
    Shows shows[FRAMES] = {SCENE_A};
    fill(shows, 20, 30, BLACK);
    fill(shows, 30, FRAMES, SCENE_B);
    expect_cut(shows, 30);
}
END_TEST

START_TEST(a_covered_lens_is_no_cut)
{
    Shows shows[FRAMES] = {SCENE_A};
    fill(shows, 20, 30, BLACK);
    bool starts[FRAMES];
    L1L2StabMotionSource models[FRAMES];
    find_starts(shows, starts, models);
    for (int t = 1; t < FRAMES; t++) {
        ck_assert(!starts[t]);
        if (t < 20 || t > 30)
            ck_assert_int_eq(models[t], L1L2STAB_MOTION_SOURCE_SIMILARITY);
        else
            ck_assert_int_ne(models[t], L1L2STAB_MOTION_SOURCE_SIMILARITY);
    }
}
END_TEST

START_TEST(a_flash_is_no_cut)
{
    Shows shows[FRAMES] = {SCENE_A};
    shows[25] = WHITE;
    expect_cut(shows, 0);
    fill(shows, 25, 28, BRIGHT_A);
    expect_cut(shows, 0);
}
END_TEST

START_TEST(a_thumbnail_matches_itself_moved_a_little_and_no_other)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = L1L2_THUMBNAIL_W * 8, cfg.height = L1L2_THUMBNAIL_H * 8;
    double likest = -1.0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        L1L2Thumbnail thumbnail[3];
        for (int i = 0; i < 3; i++) {
            static uint8_t picture[L1L2_THUMBNAIL_H * 8 * L1L2_THUMBNAIL_W * 8];
            cfg.seed = i < 2 ? seed : seed + 100;
            cfg.pan_x = 20.0, cfg.shake = 1.0;
            Synth *s = synth_new(&cfg);
            synth_render_gray(s, i == 1, picture, cfg.width);
            for (int y = 0; y < L1L2_THUMBNAIL_H; y++)
                for (int x = 0; x < L1L2_THUMBNAIL_W; x++) {
                    int sum = 0;
                    for (int k = 0; k < 64; k++)
                        sum += picture[(8 * y + k / 8) * cfg.width + 8 * x + k % 8];
                    thumbnail[i].level[y * L1L2_THUMBNAIL_W + x] = (uint8_t)(sum / 64);
                }
            synth_free(s);
        }
        ck_assert_near(l1l2_image_thumbnail_correlation(&thumbnail[0], &thumbnail[0]), 1.0, 1e-12);
        ck_assert_double_gt(l1l2_image_thumbnail_correlation(&thumbnail[0], &thumbnail[1]), 0.7);
        likest = fmax(likest, l1l2_image_thumbnail_correlation(&thumbnail[0], &thumbnail[2]));
    }
    ck_assert_double_lt(likest, 0.45);
    L1L2Thumbnail flat = {{0}};
    ck_assert(!l1l2_image_thumbnail_has_detail(&flat));
    ck_assert(!l1l2_image_thumbnails_differ(&flat, &flat));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cut");
    TCase *tcase = tcase_create("cut");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, a_cut_starts_a_path_at_its_first_frame);
    tcase_add_test(tcase, a_cut_through_black_starts_a_path_where_the_picture_comes_back);
    tcase_add_test(tcase, a_covered_lens_is_no_cut);
    tcase_add_test(tcase, a_flash_is_no_cut);
    tcase_add_test(tcase, a_thumbnail_matches_itself_moved_a_little_and_no_other);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
