/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "common/rng.h"
#include "motion/motion_bridge.h"

static void assert_same(const L1L2Mat *a, const L1L2Mat *b, double tolerance)
{
    for (int i = 0; i < 9; i++)
        ck_assert_near(a->m[i], b->m[i], tolerance);
}

static double uniform(L1L2Rng *rng)
{
    return l1l2_rng_below(rng, 2000001) / 1e6 - 1.0;
}

static L1L2Mat shake(L1L2Rng *rng)
{
    const double zoom = exp(0.03 * uniform(rng)), turn = 0.05 * uniform(rng);
    return l1l2_mat_similarity(zoom * cos(turn), zoom * sin(turn), 0.05 * uniform(rng), 0.05 * uniform(rng));
}

START_TEST(exp_undoes_log)
{
    static const double turns[] = {0.0, 1e-12, 1e-5, 0.0099, 0.0101, 0.3, -3.0};
    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
        const double zoom = exp(0.7 * turns[k]);
        const L1L2Mat F = l1l2_mat_similarity(zoom * cos(turns[k]), zoom * sin(turns[k]), 0.3, -0.2);
        const L1L2SimilarityLog log = l1l2_motion_log(&F);
        const L1L2Mat back = l1l2_motion_exp(&log);
        assert_same(&back, &F, 1e-13);
        ck_assert_near(log.turn, turns[k], 1e-14);
    }
}
END_TEST

START_TEST(half_the_logarithm_is_half_the_motion)
{
    const L1L2Mat F = l1l2_mat_similarity(1.1, 0.4, 0.3, -0.2);
    L1L2SimilarityLog log = l1l2_motion_log(&F);
    log.zoom *= 0.5, log.turn *= 0.5, log.x *= 0.5, log.y *= 0.5;
    const L1L2Mat half = l1l2_motion_exp(&log), whole = l1l2_mat_mul(half, half);
    assert_same(&whole, &F, 1e-14);
}
END_TEST

START_TEST(the_product_is_the_whole_motion)
{
    L1L2Rng rng = l1l2_rng_seeded(3);
    for (int frames = 1; frames <= L1L2_BRIDGE_MAX_FRAMES; frames++)
        for (int trial = 0; trial < 20; trial++) {
            L1L2Mat F[L1L2_BRIDGE_MAX_FRAMES], G = l1l2_mat_identity(), P = G;
            double weight[L1L2_BRIDGE_MAX_FRAMES];
            for (int i = 0; i < frames; i++) {
                const L1L2Mat true_F = shake(&rng);
                G = l1l2_mat_mul(G, true_F);
                F[i] = shake(&rng);
                weight[i] = l1l2_rng_below(&rng, 3) * 0.7;
            }
            l1l2_motion_share_out(&G, F, weight, NULL, frames);
            for (int i = 0; i < frames; i++)
                P = l1l2_mat_mul(P, F[i]);
            assert_same(&P, &G, 1e-14);
        }
}
END_TEST

START_TEST(frames_that_were_not_measured_share_evenly_in_time)
{
    L1L2Mat F[3];
    const L1L2Mat step = l1l2_mat_similarity(1.01 * cos(0.02), 1.01 * sin(0.02), 0.03, -0.01);
    const L1L2SimilarityLog log = l1l2_motion_log(&step);
    const double weight[3] = {0.0, 0.0, 0.0}, duration[3] = {1.0, 3.0, 1.0};
    const L1L2SimilarityLog threefold = {3.0 * log.zoom, 3.0 * log.turn, 3.0 * log.x, 3.0 * log.y};
    L1L2Mat G = l1l2_motion_exp(&threefold);
    l1l2_motion_share_out(&G, F, weight, NULL, 3);
    for (int i = 0; i < 3; i++)
        assert_same(&F[i], &step, 1e-13);
    const L1L2SimilarityLog fivefold = {5.0 * log.zoom, 5.0 * log.turn, 5.0 * log.x, 5.0 * log.y};
    G = l1l2_motion_exp(&fivefold);
    l1l2_motion_share_out(&G, F, weight, duration, 3);
    const L1L2Mat longer = l1l2_motion_exp(&threefold);
    assert_same(&F[0], &step, 1e-13);
    assert_same(&F[1], &longer, 1e-13);
    assert_same(&F[2], &step, 1e-13);
}
END_TEST

START_TEST(a_measured_motion_stays_and_the_others_take_the_rest)
{
    L1L2Rng rng = l1l2_rng_seeded(4);
    L1L2Mat F[3], G = l1l2_mat_identity();
    const double weight[3] = {0.0, 2.0, 0.0};
    for (int i = 0; i < 3; i++) {
        F[i] = shake(&rng);
        G = l1l2_mat_mul(G, F[i]);
    }
    const L1L2Mat measured = F[1];
    F[0] = F[2] = (L1L2Mat){{NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN}}; /* not read */
    l1l2_motion_share_out(&G, F, weight, NULL, 3);
    assert_same(&F[1], &measured, 1e-9);
}
END_TEST

/* Of pure translations the answer is known: each takes of what is lacking by its variance. */
START_TEST(what_is_lacking_is_shared_by_the_variances)
{
    L1L2Mat F[2] = {l1l2_mat_translation(0.10, 0.0), l1l2_mat_translation(0.20, 0.0)};
    const L1L2Mat G = l1l2_mat_translation(0.38, 0.04);
    const double weight[2] = {3.0, 1.0};
    l1l2_motion_share_out(&G, F, weight, NULL, 2);
    ck_assert_near(F[0].m[2], 0.12, 1e-14);
    ck_assert_near(F[1].m[2], 0.26, 1e-14);
    ck_assert_near(F[0].m[5], 0.01, 1e-14);
    ck_assert_near(F[1].m[5], 0.03, 1e-14);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_bridge");
    TCase *tests = tcase_create("motion_bridge");
    tcase_add_test(tests, exp_undoes_log);
    tcase_add_test(tests, half_the_logarithm_is_half_the_motion);
    tcase_add_test(tests, the_product_is_the_whole_motion);
    tcase_add_test(tests, frames_that_were_not_measured_share_evenly_in_time);
    tcase_add_test(tests, a_measured_motion_stays_and_the_others_take_the_rest);
    tcase_add_test(tests, what_is_lacking_is_shared_by_the_variances);
    suite_add_tcase(suite, tests);
    return checkx_run(suite);
}
