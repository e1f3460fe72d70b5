/* SPDX-License-Identifier: MIT */
/* The joins of windows on camera paths that were measured on real video (tests/reference/motion). */
#include <stdio.h>

#include "path/path_fixture.h"

static const char *const clips[] = {"bag", "dashcam-highway", "fastpan-cat", "handheld-shelf", "hippo",
                                    "roll-book", "snowboard-720p", "walk-corridor"};

/* Third differences of the corner path, px at 640 wide: at joins [1] and elsewhere [0]. */
typedef struct Roughness {
    double sum[2], worst[2];
    int count[2];
} Roughness;

/* Where corner k of the frame goes in one smooth step, px. */
static L1L2Point corner_step(const Run *r, const Setup *cfg, int t, int k)
{
    const double scale = 640.0 / cfg->width, diagonal = hypot(cfg->width, cfg->height);
    const L1L2Point u = {(k & 1 ? 0.5 : -0.5) * cfg->width / diagonal, (k & 2 ? 0.5 : -0.5) * cfg->height / diagonal};
    const L1L2Point p = l1l2_mat_apply(&r->out[t].S, u);
    return (L1L2Point){(p.x - u.x) * diagonal * scale, (p.y - u.y) * diagonal * scale};
}

static double third_difference(const Run *r, const Setup *cfg, int t)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point a = corner_step(r, cfg, t - 1, k), b = corner_step(r, cfg, t, k);
        const L1L2Point c = corner_step(r, cfg, t + 1, k);
        sum += hypot(a.x - 2.0 * b.x + c.x, a.y - 2.0 * b.y + c.y) / 4.0;
    }
    return sum;
}

/* A third difference at t has P from t - 2 to t + 1. For blend both ends of an overlap are joins. */
static bool reaches_over_a_join(const Setup *cfg, int t)
{
    const int every = cfg->window - cfg->overlap;
    const bool starts = t + 1 >= every && (t + 1) % every <= 2;
    const bool blended = t + 1 - cfg->overlap >= every && (t + 1 - cfg->overlap) % every <= 2;
    return starts || (cfg->join == L1L2STAB_JOIN_BLEND && blended);
}

static void add_clip(const char *name, Setup cfg, Roughness *all)
{
    Run *r = measured_run(name, &cfg);
    run(&cfg, r);
    for (int t = 3; t < r->frames - 3; t++) {
        const bool join = reaches_over_a_join(&cfg, t);
        const double d3 = third_difference(r, &cfg, t);
        all->sum[join] += d3;
        all->worst[join] = fmax(all->worst[join], d3);
        all->count[join]++;
    }
    free(r);
}

START_TEST(joins_of_real_paths_are_no_rougher_than_the_path_between_them)
{
    Roughness blend = {{0}, {0}, {0}}, continuous = {{0}, {0}, {0}};
    Setup cfg = defaults();
    for (size_t i = 0; i < sizeof clips / sizeof *clips; i++) {
        cfg.join = L1L2STAB_JOIN_CONTINUOUS, cfg.overlap = 100;
        add_clip(clips[i], cfg, &continuous);
        cfg.join = L1L2STAB_JOIN_BLEND, cfg.overlap = 30;
        add_clip(clips[i], cfg, &blend);
    }
    printf("third difference, px/frame^3    at joins: mean    worst    elsewhere: mean    worst    joins\n");
    const Roughness *rows[] = {&blend, &continuous};
    for (int i = 0; i < 2; i++)
        printf("  %-28s           %8.4f %8.3f           %8.4f %8.3f    %d\n",
               i ? "continuous, K = 100" : "blend, K = 30",
               rows[i]->sum[1] / rows[i]->count[1], rows[i]->worst[1], rows[i]->sum[0] / rows[i]->count[0],
               rows[i]->worst[0], rows[i]->count[1] / 3);
    ck_assert_int_ge(continuous.count[1] / 3, 20);
    ck_assert_double_le(continuous.worst[1], continuous.worst[0]);
    /* In the mean the two are alike: the path bends no more at a join than elsewhere. */
    ck_assert_double_le(continuous.sum[1] / continuous.count[1], 1.1 * continuous.sum[0] / continuous.count[0]);
    ck_assert_double_le(5.0 * continuous.sum[1] / continuous.count[1], blend.sum[1] / blend.count[1]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("path_joins");
    TCase *tcase = tcase_create("path_joins");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, joins_of_real_paths_are_no_rougher_than_the_path_between_them);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
