/* SPDX-License-Identifier: MIT */
/* Depth, things that move by themselves, motion blur and focus in synthetic clips, seen in their pixels. */
#include "support/synth_fixture.h"

static uint8_t plain[PIXELS], other[PIXELS], frame[PIXELS];

static SynthConfig still_clip(void)
{
    SynthConfig cfg = small_clip();
    cfg.shake = cfg.roll = 0.0;
    return cfg;
}

/* The mean difference between a around (x, y) and b around (x + dx, y). */
static int block_difference(const uint8_t *a, const uint8_t *b, int x, int y, int dx)
{
    int sum = 0;
    for (int j = -2; j <= 2; j++)
        for (int i = -2; i <= 2; i++)
            sum += abs(a[(y + j) * WIDTH + x + i] - b[(y + j) * WIDTH + x + dx + i]);
    return sum;
}

START_TEST(nearer_layers_move_farther_and_the_scene_moves_as_the_camera_does)
{
    SynthConfig cfg = still_clip();
    cfg.pan_x = 4.0, cfg.parallax = 1.0;
    Synth *s = synth_new(&cfg);
    int moved_by[9] = {0}, blocks = 0;
    for (int t = 1; t < 400; t += 20) {
        gray(s, t - 1, plain);
        gray(s, t, frame);
        for (int y = 2; y < HEIGHT - 2; y += 5)
            for (int x = 12; x < WIDTH - 12; x += 5) {
                int best = 0;
                for (int dx = 1; dx <= 8; dx++)
                    if (block_difference(frame, plain, x, y, dx) < block_difference(frame, plain, x, y, best))
                        best = dx;
                moved_by[best] += block_difference(frame, plain, x, y, best) <= 25; /* a level a pixel */
                blocks++;
            }
    }
    ck_assert_double_gt(moved_by[4], 0.4 * blocks); /* F_t's */
    ck_assert_double_gt(moved_by[6], 0.1 * blocks);
    ck_assert_double_gt(moved_by[8], 0.05 * blocks);
    ck_assert_double_gt(moved_by[4] + moved_by[6] + moved_by[8], 0.85 * blocks); /* the rest is edges */
    synth_free(s);
}
END_TEST

/* A frame at one time, with and without a foreground. */
static double covered_share(const Synth *with, const Synth *without, int t)
{
    gray(without, t, plain);
    gray(with, t, frame);
    int count = 0;
    for (int i = 0; i < PIXELS; i++)
        count += frame[i] != plain[i];
    return (double)count / PIXELS;
}

START_TEST(a_mover_covers_its_part_of_the_frame)
{
    SynthConfig cfg = small_clip();
    cfg.pan_x = 3.0; /* the camera pans with the mover */
    Synth *without = synth_new(&cfg);
    for (double share = 0.1; share < 0.75; share += 0.2) {
        cfg.foreground = share, cfg.movers = 1, cfg.mover_speed = 2.0;
        Synth *with = synth_new(&cfg);
        for (int t = 0; t < 100; t += 33) /* some levels are equal by chance */
            ck_assert_near(covered_share(with, without, t), share, 0.02 + 0.03 * share);
        synth_free(with);
    }
    synth_free(without);
}
END_TEST

START_TEST(a_mover_has_the_speed_that_was_asked_for)
{
    SynthConfig cfg = still_clip();
    cfg.foreground = 0.3, cfg.movers = 1, cfg.mover_speed = 3.0;
    gray_once(&cfg, 0, plain);
    gray_once(&cfg, 1, frame);
    int best = 0;
    for (int dx = -8; dx <= 8; dx++)
        if (block_difference(frame, plain, WIDTH / 2, HEIGHT / 2, dx) <
            block_difference(frame, plain, WIDTH / 2, HEIGHT / 2, best))
            best = dx;
    ck_assert_int_eq(best, -3); /* what is here was 3 px to the left */
    ck_assert_int_eq(block_difference(frame, plain, 5, 5, 0), 0); /* and the scene does not move */
}
END_TEST

START_TEST(walkers_come_and_go)
{
    SynthConfig cfg = small_clip();
    Synth *without = synth_new(&cfg);
    cfg.foreground = 0.3, cfg.movers = 6, cfg.mover_speed = 4.0;
    Synth *with = synth_new(&cfg);
    double least = 1.0, most = 0.0, sum = 0.0;
    for (int t = 0; t < 300; t += 15) {
        const double share = covered_share(with, without, t);
        least = fmin(least, share);
        most = fmax(most, share);
        sum += share / 20.0;
    }
    synth_free(with);
    synth_free(without);
    ck_assert_double_lt(most, 0.3);
    ck_assert_double_gt(most, least + 0.05);
    ck_assert_double_gt(sum, 0.08);
}
END_TEST

START_TEST(an_open_shutter_shows_the_mean_of_what_the_camera_sees_meanwhile)
{
    enum { INSTANTS = 60 };
    SynthConfig cfg = small_clip();
    cfg.exposure = 0.5, cfg.pan_x = 14.0, cfg.roll = 0.03;
    Synth *s = synth_new(&cfg);
    static double sum[PIXELS];
    for (int k = 0; k < INSTANTS; k++) {
        double M[9];
        synth_camera_at(s, 7.0 + 0.5 * ((k + 0.5) / INSTANTS - 0.5), M);
        synth_render_view(s, M, WIDTH, HEIGHT, L1L2STAB_FORMAT_GRAY8, (uint8_t *const[4]){other},
                          (const ptrdiff_t[4]){WIDTH});
        for (int i = 0; i < PIXELS; i++)
            sum[i] += (double)other[i] / INSTANTS;
    }
    double off = 0.0, sharp_off = 0.0;
    gray(s, 7, frame);
    cfg.exposure = 0.0;
    gray_once(&cfg, 7, plain);
    for (int i = 0; i < PIXELS; i++) {
        off += fabs(frame[i] - sum[i]) / PIXELS;
        sharp_off += fabs(plain[i] - sum[i]) / PIXELS;
    }
    ck_assert_double_lt(off, 0.7);
    ck_assert_double_gt(sharp_off, 5.0);
    synth_free(s);
}
END_TEST

static double gradient(const uint8_t *p, ptrdiff_t to)
{
    double sum = 0.0;
    for (int i = 0; i < PIXELS - WIDTH - 1; i++)
        sum += (double)(p[i + to] - p[i]) * (p[i + to] - p[i]) / PIXELS;
    return sum;
}

START_TEST(out_of_focus_the_picture_is_soft_both_ways_and_stays_in_its_place)
{
    SynthConfig cfg = still_clip();
    gray_once(&cfg, 2, plain);
    cfg.event[0] = (SynthEvent){SYNTH_BLUR, 2, 1, 12.0};
    gray_once(&cfg, 2, frame);
    gray_once(&cfg, 3, other);
    ck_assert_mem_eq(other, plain, PIXELS);
    ck_assert_double_lt(gradient(frame, 1), 0.25 * gradient(plain, 1));
    ck_assert_double_lt(gradient(frame, WIDTH), 0.25 * gradient(plain, WIDTH));
    ck_assert_near(mean_level(frame), mean_level(plain), 0.5);
    int shifted[3] = {0};
    for (int dx = -1; dx <= 1; dx++)
        for (int y = 5; y < HEIGHT - 5; y += 5)
            for (int x = 5; x < WIDTH - 5; x += 5)
                shifted[dx + 1] += block_difference(frame, plain, x, y, dx);
    ck_assert_int_lt(shifted[1], shifted[0]);
    ck_assert_int_lt(shifted[1], shifted[2]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth_view");
    TCase *tc = tcase_create("synth_view");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, nearer_layers_move_farther_and_the_scene_moves_as_the_camera_does);
    tcase_add_test(tc, a_mover_covers_its_part_of_the_frame);
    tcase_add_test(tc, a_mover_has_the_speed_that_was_asked_for);
    tcase_add_test(tc, walkers_come_and_go);
    tcase_add_test(tc, an_open_shutter_shows_the_mean_of_what_the_camera_sees_meanwhile);
    tcase_add_test(tc, out_of_focus_the_picture_is_soft_both_ways_and_stays_in_its_place);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
