/* SPDX-License-Identifier: MIT */
/* Where a filled border would lack too much, the path gives way. */
#include <math.h>

#include "path/coverage.h"
#include "path/path_fixture.h"

static const double limit = 0.01; /* of a frame that may be lacking, path.c */
static const char *const clips[] = {"fastpan-cat", "hippo", "walk-corridor"};
enum { CLIPS = sizeof clips / sizeof *clips, REACH = 30 };

/* A frame of 16:9 without neighbors. */
static L1L2Coverage alone(void)
{
    return (L1L2Coverage){.half_w = 0.5 * 640 / diagonal_px, .half_h = 0.5 * 360 / diagonal_px};
}

static L1L2Mat right_by(double width_share)
{
    return l1l2_mat_translation(width_share * 640 / diagonal_px, 0.0);
}

START_TEST(without_neighbors_all_that_is_outside_the_frame_is_lacking)
{
    const L1L2Coverage coverage = alone();
    const L1L2Mat none = l1l2_mat_identity(), moved = right_by(0.1), wider = l1l2_mat_diagonal(1.25, 1.25);
    ck_assert_double_eq(l1l2_coverage_lack(&coverage, &none), 0.0);
    ck_assert_double_eq_tol(l1l2_coverage_lack(&coverage, &moved), 0.1, 0.005);
    ck_assert_double_eq_tol(l1l2_coverage_lack(&coverage, &wider), 1.0 - 0.8 * 0.8, 0.01);
}
END_TEST

START_TEST(a_neighbor_covers_what_it_shows_but_for_its_margin)
{
    L1L2Coverage coverage = alone();
    const L1L2Mat moved = right_by(0.1);
    coverage.count = 1;
    coverage.neighbor[0].map = right_by(-0.06);
    ck_assert_double_eq_tol(l1l2_coverage_lack(&coverage, &moved), 0.04, 0.005);
    coverage.margin = 0.01 * 640 / diagonal_px;
    ck_assert_double_eq_tol(l1l2_coverage_lack(&coverage, &moved), 0.05, 0.005);
}
END_TEST

START_TEST(the_ratio_is_the_least_that_leaves_the_limit)
{
    const L1L2Coverage coverage = alone();
    const L1L2Mat moved = right_by(0.1), hardly = right_by(0.009);
    ck_assert_double_eq_tol(l1l2_coverage_ratio(&coverage, &moved, 0.8, 0.02, 0.99), 0.96, 0.01);
    ck_assert_double_eq(l1l2_coverage_ratio(&coverage, &moved, 0.8, 0.0, 0.99), 0.99);
    ck_assert_double_eq(l1l2_coverage_ratio(&coverage, &hardly, 0.8, limit, 0.99), 0.8);
    ck_assert_double_eq(l1l2_coverage_ratio(&coverage, &moved, 0.98, 0.1, 0.99), 0.98);
}
END_TEST

/* What frame t lacks. */
static double lack_of(const Setup *cfg, const Run *r, int t)
{
    const double diagonal = hypot(cfg->width, cfg->height);
    L1L2Coverage coverage = {.half_w = 0.5 * cfg->width / diagonal, .half_h = 0.5 * cfg->height / diagonal};
    L1L2Mat chain = l1l2_mat_identity(), inverse;
    for (int k = t - 1; k >= 0 && k >= t - REACH && !r->starts[k + 1]; k--) {
        chain = l1l2_mat_mul(r->out[k + 1].F, chain);
        coverage.neighbor[coverage.count++].map = chain;
    }
    chain = l1l2_mat_identity();
    for (int k = t + 1; k < r->frames && k <= t + REACH && !r->starts[k]; k++) {
        l1l2_mat_inverse(r->out[k].F, &inverse);
        chain = l1l2_mat_mul(inverse, chain);
        coverage.neighbor[coverage.count++].map = chain;
    }
    return l1l2_coverage_lack(&coverage, &r->out[t].B);
}

static double worst_lack(const Setup *cfg, const Run *r)
{
    double worst = 0.0;
    for (int t = 0; t < r->frames; t++)
        worst = fmax(worst, lack_of(cfg, r, t));
    return worst;
}

/* Some of these clips end in a pan: no later frame shows what lies ahead. */
START_TEST(a_path_gives_way_where_no_frame_shows_what_it_lacks)
{
    Setup cfg = defaults();
    Run *r = measured_run(clips[_i], &cfg);
    r->starts[140] = true; /* and a cut on the way */
    cfg.crop_ratio = 0.85;
    run(&cfg, r);
    const double before = worst_lack(&cfg, r);
    cfg.fill_reach = REACH;
    run(&cfg, r);
    const double after = worst_lack(&cfg, r);
    ck_assert_msg(before > 2.0 * limit, "%s: %g without the limit", clips[_i], before);
    ck_assert_msg(after <= 1.2 * limit, "%s: %g", clips[_i], after);
    assert_all_inside(&cfg, r);
    free(r);
}
END_TEST

/* A shake of one pixel is less than what may be lacking. */
START_TEST(a_path_that_lacks_nothing_stays_as_it_is)
{
    Setup cfg = defaults();
    Run *filled = shaky_run(400, 0.0, 1.0, 1), *cropped = shaky_run(400, 0.0, 1.0, 1);
    run(&cfg, cropped);
    cfg.fill_reach = REACH;
    run(&cfg, filled);
    for (int t = 0; t < 400; t++)
        ck_assert_mem_eq(filled->out[t].B.m, cropped->out[t].B.m, sizeof cropped->out[t].B.m);
    free(filled);
    free(cropped);
}
END_TEST

/* All frames of a still camera show the same, but for its shake: only the lost frame in the middle has no neighbors on
 * one side, and the frames beside it. */
START_TEST(nothing_is_filled_across_a_lost_motion)
{
    Setup cfg = defaults();
    Run *known = shaky_run(200, 3.0, 10.0, 4), *lost = shaky_run(200, 3.0, 10.0, 4);
    cfg.fill_reach = REACH, cfg.crop_ratio = 0.8;
    for (int t = 90; t < 100; t++)
        lost->lost[t] = true;
    run(&cfg, known);
    run(&cfg, lost);
    for (int t = 0; t < 200; t++)
        ck_assert_double_ge(lost->out[t].room_ratio, cfg.crop_ratio);
    ck_assert_double_gt(lost->out[95].room_ratio, known->out[95].room_ratio + 0.02);
    free(known);
    free(lost);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("coverage");
    TCase *tcase = tcase_create("coverage");
    tcase_add_test(tcase, without_neighbors_all_that_is_outside_the_frame_is_lacking);
    tcase_add_test(tcase, a_neighbor_covers_what_it_shows_but_for_its_margin);
    tcase_add_test(tcase, the_ratio_is_the_least_that_leaves_the_limit);
    tcase_add_loop_test(tcase, a_path_gives_way_where_no_frame_shows_what_it_lacks, 0, CLIPS);
    tcase_add_test(tcase, a_path_that_lacks_nothing_stays_as_it_is);
    tcase_add_test(tcase, nothing_is_filled_across_a_lost_motion);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
