/* SPDX-License-Identifier: MIT */
/* Static overlays before a moving camera: the memory of where they are, and burnt-in text over a scene of little
 * contrast. */
#include "common/rng.h"
#include "motion/motion_fixture.h"
#include "motion/static_overlay.h"

enum { WIDTH = 640, HEIGHT = 360, TEXT_W = 160, TEXT_H = 28 };

/* Bright blocks on black, about as dense as letters. */
static void burn_in(uint8_t *picture, int left, int top)
{
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (int y = 0; y < TEXT_H; y += 4)
        for (int x = 0; x < TEXT_W; x += 4) {
            const uint8_t level = l1l2_rng_below(&rng, 2) ? 235 : 16;
            for (int k = 0; k < 16; k++)
                picture[(top + y + k / 4) * WIDTH + left + x + k % 4] = level;
        }
}

enum { SMALL_W = 160, SMALL_H = 90, PATCH = 20, PATCH_X = 100, PATCH_Y = 30 };

/* A texture of noise that has moved by `shift` pixels, with a patch that stands still, or with a patch that moves and
 * all else still. */
static void draw(uint8_t *picture, int shift, bool patch_moves)
{
    for (int y = 0; y < SMALL_H; y++)
        for (int x = 0; x < SMALL_W; x++) {
            const bool patch = x >= PATCH_X && x < PATCH_X + PATCH && y >= PATCH_Y && y < PATCH_Y + PATCH;
            const uint32_t at = (uint32_t)(x + (patch == patch_moves ? shift : 0)) * 2654435761u + (uint32_t)y * 40503u;
            picture[y * SMALL_W + x] = (uint8_t)((at ^ at >> 15) * 2246822519u >> 24);
        }
}

typedef struct Overlay {
    L1L2StaticOverlay o;
    L1L2Point in, out; /* of the patch */
    L1L2Mat camera;    /* two pixels a frame */
} Overlay;

static Overlay overlay_new(void)
{
    Overlay t = {.o = {.parameters = &l1l2_motion_defaults,
                       .half_w = 0.5 * SMALL_W / hypot(SMALL_W, SMALL_H),
                       .half_h = 0.5 * SMALL_H / hypot(SMALL_W, SMALL_H)}};
    const double unit = 1.0 / hypot(SMALL_W, SMALL_H);
    ck_assert(l1l2_motion_overlay_init(&t.o, SMALL_W, SMALL_H));
    l1l2_motion_overlay_reset(&t.o);
    t.in = (L1L2Point){(PATCH_X + 10 - 0.5 * SMALL_W) * unit, (PATCH_Y + 10 - 0.5 * SMALL_H) * unit};
    t.out = (L1L2Point){-t.in.x, t.in.y};
    t.camera = l1l2_mat_translation(2.0 * unit, 0.0);
    return t;
}

static void learn(Overlay *t, int frames, int speed, bool patch_moves, const L1L2Mat *F)
{
    uint8_t now[SMALL_W * SMALL_H], previous[SMALL_W * SMALL_H];
    const L1L2GrayPicture a = {now, SMALL_W, SMALL_W, SMALL_H}, b = {previous, SMALL_W, SMALL_W, SMALL_H};
    for (int i = 1; i <= frames; i++) {
        draw(now, i * speed, patch_moves);
        draw(previous, (i - 1) * speed, patch_moves);
        l1l2_motion_overlay_learn(&t->o, &a, &b, F);
    }
}

START_TEST(what_stands_still_while_the_camera_moves_is_covered_until_nothing_is_seen_of_it_for_long)
{
    Overlay t = overlay_new();
    learn(&t, (int)l1l2_motion_defaults.overlay_hits - 1, 2, false, &t.camera);
    ck_assert(!l1l2_motion_overlay_covers(&t.o, t.in));
    learn(&t, 26, 2, false, &t.camera);
    ck_assert(l1l2_motion_overlay_covers(&t.o, t.in));
    ck_assert(!l1l2_motion_overlay_covers(&t.o, t.out));
    const L1L2Mask mask = l1l2_motion_overlay_mask(&t.o);
    int blocked = 0;
    for (int i = 0; i < mask.width * mask.height; i++)
        blocked += mask.blocked[i];
    ck_assert_int_ge(blocked, PATCH * PATCH * 3 / 4);
    ck_assert_int_le(blocked, (PATCH + 4) * (PATCH + 4));
    for (int i = 0; i < 20; i++)
        l1l2_motion_overlay_age(&t.o);
    ck_assert(!l1l2_motion_overlay_covers(&t.o, t.in));
    ck_assert_ptr_null(l1l2_motion_overlay_mask(&t.o).blocked);
    l1l2_motion_overlay_clear(&t.o);
}
END_TEST

START_TEST(an_overlay_that_goes_is_forgotten_at_once_where_the_scene_moves)
{
    Overlay t = overlay_new();
    learn(&t, 40, 2, false, &t.camera);
    ck_assert(l1l2_motion_overlay_covers(&t.o, t.in));
    uint8_t now[SMALL_W * SMALL_H], previous[SMALL_W * SMALL_H];
    const L1L2GrayPicture a = {now, SMALL_W, SMALL_W, SMALL_H}, b = {previous, SMALL_W, SMALL_W, SMALL_H};
    for (int i = 1; i <= 20; i++) {
        for (int y = 0; y < SMALL_H; y++)
            for (int x = 0; x < SMALL_W; x++) {
                const uint32_t p = (uint32_t)(x + 2 * i) * 2654435761u + (uint32_t)y * 40503u, q = p - 2u * 2654435761u;
                now[y * SMALL_W + x] = (uint8_t)((p ^ p >> 15) * 2246822519u >> 24);
                previous[y * SMALL_W + x] = (uint8_t)((q ^ q >> 15) * 2246822519u >> 24);
            }
        l1l2_motion_overlay_learn(&t.o, &a, &b, &t.camera);
    }
    ck_assert(!l1l2_motion_overlay_covers(&t.o, t.in));
    l1l2_motion_overlay_clear(&t.o);
}
END_TEST

START_TEST(nothing_is_an_overlay_while_the_camera_stands_or_if_most_of_the_picture_stands)
{
    const L1L2Mat still = l1l2_mat_identity();
    Overlay t = overlay_new();
    learn(&t, 40, 0, false, &still);
    ck_assert_ptr_null(l1l2_motion_overlay_mask(&t.o).blocked);
    learn(&t, 40, 2, true, &t.camera); /* the motion of a subject */
    ck_assert_ptr_null(l1l2_motion_overlay_mask(&t.o).blocked);
    l1l2_motion_overlay_clear(&t.o);
}
END_TEST

START_TEST(what_the_caller_excludes_is_covered_for_good)
{
    Overlay t = overlay_new();
    const L1L2MeasuredArea left_half = {.region = {0.0, 0.0, 0.5, 1.0}};
    double share;
    ck_assert(l1l2_motion_overlay_exclude(&t.o, &left_half, &share));
    ck_assert_near(share, 0.5, 1e-12);
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < 100; i++)
            l1l2_motion_overlay_age(&t.o);
        ck_assert(l1l2_motion_overlay_covers(&t.o, t.in));
        ck_assert(!l1l2_motion_overlay_covers(&t.o, t.out));
        const L1L2Mask mask = l1l2_motion_overlay_mask(&t.o);
        for (int i = 0; i < SMALL_W * SMALL_H; i++)
            ck_assert_int_eq(mask.blocked[i], i % SMALL_W >= SMALL_W / 2);
        learn(&t, 40, 2, false, &t.camera); /* the patch stands still there */
        l1l2_motion_overlay_reset(&t.o);
    }
    l1l2_motion_overlay_clear(&t.o);
}
END_TEST

START_TEST(what_is_excluded_does_not_decide_whether_most_of_the_picture_stands)
{
    Overlay t = overlay_new();
    const double least_x = (PATCH_X - 10.0) / SMALL_W, least_y = (PATCH_Y - 8.0) / SMALL_H;
    const L1L2MeasuredArea around = {.region = {least_x, least_y, 40.0 / SMALL_W, 36.0 / SMALL_H}};
    double share;
    ck_assert(l1l2_motion_overlay_exclude(&t.o, &around, &share));
    for (int shift = 2; shift <= 80; shift += 2) {
        uint8_t now[SMALL_W * SMALL_H], previous[SMALL_W * SMALL_H];
        const L1L2GrayPicture a = {now, SMALL_W, SMALL_W, SMALL_H}, b = {previous, SMALL_W, SMALL_W, SMALL_H};
        draw(now, shift, false);
        draw(previous, shift - 2, false);
        for (int i = 0; i < SMALL_W * SMALL_H; i++)
            if (l1l2_motion_overlay_mask(&t.o).blocked[i] && i % SMALL_W < PATCH_X - 10)
                now[i] = previous[i] = (uint8_t)((unsigned)i * 2654435761u >> 24); /* a car's hood */
        l1l2_motion_overlay_learn(&t.o, &a, &b, &t.camera);
    }
    ck_assert(l1l2_motion_overlay_covers(&t.o, t.in)); /* the patch is an overlay on what is measured */
    l1l2_motion_overlay_clear(&t.o);
}
END_TEST

START_TEST(burnt_in_text_is_not_taken_for_a_dark_scene_that_stands_still)
{
    static const double contrasts[] = {0.45, 0.15, 0.045}; /* of the scene's 256 levels */
    for (int i = 0; i < 3; i++) {
        SynthConfig cfg = synth_defaults();
        cfg.shake = 4.0, cfg.pan_x = 1.0, cfg.roll = 0.003;
        Run run = run_new(&cfg);
        uint8_t *picture = run.picture.data[0];
        double sum = 0.0;
        for (int t = 0; t < 50; t++) {
            double truth[9];
            synth_render_gray(run.synth, t, picture, WIDTH);
            for (int k = 0; k < WIDTH * HEIGHT; k++)
                picture[k] = (uint8_t)lrint(60.0 + contrasts[i] * (picture[k] - 128.0));
            burn_in(picture, 20, 320);
            burn_in(picture, 460, 16);
            const L1L2MotionResult result = push(run.motion, &run.picture, t == 0);
            synth_motion(run.synth, t, truth);
            L1L2Mat expected;
            memcpy(expected.m, truth, sizeof truth);
            const L1L2Mat found = l1l2_mat_rescale(result.F, hypot(WIDTH, HEIGHT));
            sum += corner_rms(&found, &expected, &cfg);
        }
        /* If the text won, the picture would be taken as still: an error of 2.6 px. */
        ck_assert_msg(sum / 49.0 < 0.3, "contrast %g: %g px off in the mean", contrasts[i], sum / 49.0);
        run_free(&run);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_overlay");
    TCase *tcase = tcase_create("motion_overlay");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, what_stands_still_while_the_camera_moves_is_covered_until_nothing_is_seen_of_it_for_long);
    tcase_add_test(tcase, an_overlay_that_goes_is_forgotten_at_once_where_the_scene_moves);
    tcase_add_test(tcase, nothing_is_an_overlay_while_the_camera_stands_or_if_most_of_the_picture_stands);
    tcase_add_test(tcase, what_the_caller_excludes_is_covered_for_good);
    tcase_add_test(tcase, what_is_excluded_does_not_decide_whether_most_of_the_picture_stands);
    tcase_add_test(tcase, burnt_in_text_is_not_taken_for_a_dark_scene_that_stands_still);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
