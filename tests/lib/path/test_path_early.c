/* SPDX-License-Identifier: MIT */
/* Frames that are emitted before their window is full: l1l2_path_hurry(). */
#include <stdio.h>

#include "path/path_fixture.h"

/* Hurries at random: single frames, runs of single frames as in a stall, and many frames at once. */
static void hurry_at_random(Run *r, int window, uint64_t seed)
{
    L1L2Rng rng = l1l2_rng_seeded(seed);
    for (int t = 0; t < r->frames; t++) {
        const unsigned what = l1l2_rng_next(&rng) % 40;
        if (what == 0)
            r->hurry[t] = 1 + (int)(l1l2_rng_next(&rng) % (unsigned)window);
        else if (what < 4)
            r->hurry[t] = (int)what;
    }
}

static double corner_distance_px(const L1L2Mat *a, const L1L2Mat *b)
{
    return diagonal_px * l1l2_mat_corner_distance(a, b, 320.0 / diagonal_px, 180.0 / diagonal_px);
}

/* Third differences of a path's x and y, px/frame^3. */
typedef struct Roughness {
    double mean, worst;
} Roughness;

static Roughness roughness(const Run *r, bool of_camera)
{
    Roughness all = {0.0, 0.0};
    for (int t = 2; t < r->frames - 1; t++) {
        double d[2];
        for (int k = 0; k < 2; k++) {
            const int i = 3 * k + 2;
            d[k] = of_camera ? r->F[t - 1].m[i] - 2.0 * r->F[t].m[i] + r->F[t + 1].m[i]
                             : r->out[t - 1].S.m[i] - 2.0 * r->out[t].S.m[i] + r->out[t + 1].S.m[i];
        }
        all.worst = fmax(all.worst, diagonal_px * hypot(d[0], d[1]));
        all.mean += diagonal_px * hypot(d[0], d[1]) / (r->frames - 3);
    }
    return all;
}

/* A walk, with a stall every 100 frames in which all but `left` of the 60 frames of a window leave early. */
static Roughness stalled(L1L2StabJoin join, int left)
{
    Setup cfg = defaults();
    cfg.window = 60, cfg.overlap = join == L1L2STAB_JOIN_BLEND ? 12 : 40, cfg.join = join;
    Run *r = drifting_run(1500, 0.7, 40.0, 4.0, 3);
    for (int t = 100; t < r->frames; t += 100)
        r->hurry[t] = 60 - left;
    run(&cfg, r);
    const Roughness out = roughness(r, false);
    free(r);
    return out;
}

START_TEST(random_hurries_lose_no_frame_and_every_map_stays_inside)
{
    for (int i = 0; i < 12; i++) {
        Setup cfg = defaults();
        cfg.window = 8 + 7 * i;
        cfg.join = (L1L2StabJoin)(i % 2);
        cfg.overlap = i % 2 ? cfg.window / 4 + 1 : cfg.window * 2 / 3;
        Run *r = drifting_run(300, 1.0, 20.0, 6.0, (uint64_t)i + 1);
        r->starts[120] = true;
        hurry_at_random(r, cfg.window, (uint64_t)i + 77);
        run(&cfg, r);
        const L1L2PathCropWindow crop = l1l2_path_crop_window(cfg.width, cfg.height, cfg.crop_ratio, 4);
        int early = 0;
        for (int t = 0; t < r->frames; t++) {
            ck_assert_uint_eq(r->out[t].path_index, (uint64_t)(t < 120 ? t : t - 120));
            ck_assert_mem_eq(r->out[t].F.m, t % 120 && t != 240 ? r->F[t].m : r->out[t].F.m, sizeof r->F[t].m);
            ck_assert_double_le(l1l2_path_constraint_excess(&crop, &r->out[t].B), 1e-12);
            ck_assert(!r->out[t].fallback);
            early += r->out[t].early;
        }
        ck_assert_int_gt(early, 20);
        free(r);
    }
}
END_TEST

START_TEST(a_frame_that_is_decided_is_not_decided_again)
{
    /* A window of 150 decides 50 frames. Hurrying these alone emits them and changes nothing. */
    const Setup cfg = defaults();
    Run *plain = drifting_run(400, 1.0, 20.0, 6.0, 4), *hurried = drifting_run(400, 1.0, 20.0, 6.0, 4);
    hurried->hurry[149] = 49;
    run(&cfg, plain);
    run(&cfg, hurried);
    for (int t = 0; t < plain->frames; t++) {
        ck_assert(!hurried->out[t].early);
        ck_assert_mem_eq(plain->out[t].B.m, hurried->out[t].B.m, sizeof plain->out[t].B.m);
    }
    free(plain);
    free(hurried);
}
END_TEST

START_TEST(an_early_frame_is_the_optimum_of_the_frames_that_have_arrived)
{
    /* Some of 60 frames are emitted early. They are the optimum as if the stream had ended there. If it does end there,
     * the remaining frames are part of the same optimum, because the emitted frames are constants. */
    const Setup cfg = defaults();
    for (int given = 1; given <= 60; given += 7) {
        Run *ended = drifting_run(60, 1.0, 20.0, 6.0, 4), *early = drifting_run(60, 1.0, 20.0, 6.0, 4);
        run(&cfg, ended);
        early->hurry[59] = given;
        run(&cfg, early);
        for (int t = 0; t < 60; t++) {
            ck_assert_int_eq(early->out[t].early, t < given);
            if (t < given)
                ck_assert_mem_eq(early->out[t].B.m, ended->out[t].B.m, sizeof ended->out[t].B.m);
            else
                ck_assert_near(corner_distance_px(&early->out[t].B, &ended->out[t].B), 0.0, 0.05);
        }
        free(ended);
        free(early);
    }
}
END_TEST

START_TEST(a_hurried_path_is_smooth)
{
    Run *walk = drifting_run(1500, 0.7, 40.0, 4.0, 3);
    const Roughness camera = roughness(walk, true);
    printf("third difference, px/frame^3, mean and worst: camera %.3f %.3f\n", camera.mean, camera.worst);
    for (int join = 0; join < 2; join++) {
        Roughness r[3];
        for (int i = 0; i < 3; i++) {
            r[i] = stalled((L1L2StabJoin)join, 60 - 30 * i);
            printf("  %s, stalls leave %2d frames of 60: %.4f %.3f\n", join ? "blend" : "continuous", 60 - 30 * i,
                   r[i].mean, r[i].worst);
        }
        /* With half the look-ahead the path is nearly as smooth; with none, little of the shake is left. */
        ck_assert_double_le(r[1].mean, 1.25 * r[0].mean);
        ck_assert_double_le(r[1].worst, 1.25 * r[0].worst);
        ck_assert_double_le(r[2].mean, 0.01 * camera.mean);
        ck_assert_double_le(r[2].worst, 0.25 * camera.worst);
    }
    free(walk);
}
END_TEST

START_TEST(after_a_stall_a_pan_has_its_speed_again)
{
    const Setup cfg = defaults();
    Run *r = shaky_run(900, 1.0, 0.0, 1);
    for (int t = 300; t < 310; t++)
        r->hurry[t] = t < 309 ? 15 : 150; /* all frames that were held */
    run(&cfg, r);
    ck_assert(r->out[309].early && !r->out[310].early);
    for (int t = 345; t < 750; t++)
        ck_assert_near(speed_px(r, t), 1.0, 0.05);
    free(r);
}
END_TEST

START_TEST(a_reset_forgets_that_frames_were_hurried)
{
    Setup cfg = defaults();
    cfg.join = L1L2STAB_JOIN_BLEND, cfg.window = 40, cfg.overlap = 10;
    Run *fresh = drifting_run(120, 1.0, 20.0, 6.0, 6), *again = new_run(120);
    run(&cfg, fresh);
    L1L2Path *path = new_path(&cfg, again);
    for (int t = 0; t < 20; t++)
        push(path, &cfg, &fresh->F[20 + t], false);
    l1l2_path_hurry(path, 7);
    l1l2_path_reset(path);
    for (int t = 0; t < 120; t++) {
        push(path, &cfg, &fresh->F[t], false);
        ck_assert_int_eq(pull(path, again, t - 39), t >= 39);
        if (t >= 39)
            ck_assert_mem_eq(again->out[t - 39].B.m, fresh->out[t - 39].B.m, sizeof fresh->out[0].B.m);
    }
    l1l2_path_free(path);
    free(again);
    free(fresh);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("path_early");
    TCase *tcase = tcase_create("path_early");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, random_hurries_lose_no_frame_and_every_map_stays_inside);
    tcase_add_test(tcase, a_frame_that_is_decided_is_not_decided_again);
    tcase_add_test(tcase, an_early_frame_is_the_optimum_of_the_frames_that_have_arrived);
    tcase_add_test(tcase, a_hurried_path_is_smooth);
    tcase_add_test(tcase, after_a_stall_a_pan_has_its_speed_again);
    tcase_add_test(tcase, a_reset_forgets_that_frames_were_hurried);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
