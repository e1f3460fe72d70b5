/* SPDX-License-Identifier: MIT */
/* Camera paths of translations and of affine maps, and how the models contain each other. */
#include "path/path_fixture.h"

/* A drifting pan whose poses turn, zoom, stretch and skew at random, by `linear` each. */
static Run *affine_run(int frames, double linear, uint64_t seed)
{
    Run *r = drifting_run(frames, 0.7, 30.0, 4.0, seed);
    L1L2Rng rng = l1l2_rng_seeded(seed + 100);
    L1L2Mat before = l1l2_mat_identity(), inverse;
    for (int t = 0; t < frames; t++) {
        double q[L1L2_DIM] = {0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
        for (int j = 2; j < L1L2_DIM; j++)
            q[j] += uniform(&rng, -linear, linear);
        const L1L2Mat pose = l1l2_mat_from_q(q, 6);
        l1l2_mat_inverse(before, &inverse);
        r->F[t] = l1l2_mat_mul(inverse, l1l2_mat_mul(r->F[t], pose));
        before = pose;
    }
    return r;
}

static Setup config_of(L1L2StabMotionModel model, L1L2StabJoin join)
{
    Setup cfg = defaults();
    cfg.window = 60, cfg.overlap = join == L1L2STAB_JOIN_BLEND ? 15 : 40;
    cfg.model = model;
    cfg.join = join;
    return cfg;
}

static double worst_distance_px(const Run *a, const Run *b)
{
    double worst = 0.0;
    for (int t = 0; t < a->frames; t++)
        worst = fmax(worst, diagonal_px * l1l2_mat_corner_distance(&a->out[t].B, &b->out[t].B, 0.436, 0.245));
    return worst;
}

START_TEST(every_map_is_of_the_model_and_inside)
{
    for (int model = L1L2STAB_MOTION_MODEL_TRANSLATION; model <= L1L2STAB_MOTION_MODEL_AFFINE; model++)
        for (int i = 0; i < 6; i++) {
            const Setup cfg = config_of((L1L2StabMotionModel)model, (L1L2StabJoin)(i % 2));
            const int dim = l1l2_mat_dim((L1L2StabMotionModel)model);
            const L1L2PathCropWindow crop = l1l2_path_crop_window(cfg.width, cfg.height, cfg.crop_ratio, dim);
            Run *r = affine_run(200, 0.001 * pow(3.0, i), (uint64_t)i + 1);
            r->starts[110] = true;
            r->hurry[90] = 30, r->hurry[150] = 60;
            run(&cfg, r);
            L1L2Mat P_before = l1l2_mat_identity();
            for (int t = 0; t < r->frames; t++) {
                const L1L2PathFrame *f = &r->out[t];
                const L1L2Mat F = l1l2_mat_reduce(&f->F, dim), B = l1l2_mat_reduce(&f->B, dim);
                ck_assert_mem_eq(F.m, f->F.m, sizeof F.m);
                ck_assert_near(l1l2_mat_corner_distance(&f->B, &B, 0.5, 0.5), 0.0, 1e-14);
                ck_assert_double_le(l1l2_path_constraint_excess(&crop, &f->B), 1e-12);
                ck_assert(!f->fallback);
                if (f->path_index > 0) { /* P_t = P_{t-1} S_t, in the reference of frame t - 1 */
                    const L1L2Mat there = l1l2_mat_mul(f->F, f->B), moved = l1l2_mat_mul(P_before, f->S);
                    ck_assert_near(l1l2_mat_corner_distance(&there, &moved, 0.5, 0.5), 0.0, 1e-12);
                }
                P_before = f->B;
            }
            free(r);
        }
}
END_TEST

START_TEST(a_translation_never_turns_or_zooms_the_picture)
{
    const Setup cfg = config_of(L1L2STAB_MOTION_MODEL_TRANSLATION, L1L2STAB_JOIN_CONTINUOUS);
    Run *r = affine_run(300, 0.02, 3);
    run(&cfg, r);
    for (int t = 0; t < r->frames; t++) {
        const double *B = r->out[t].B.m;
        ck_assert(B[0] == 1.0 && B[1] == 0.0 && B[3] == 0.0 && B[4] == 1.0);
    }
    free(r);
}
END_TEST

/* For a camera that moves by a simpler model, a richer model has the same norms. So the optimum is the same while no
 * constraint is active. Where one is, the richer model could gain room by a motion that the simpler one lacks. */
START_TEST(a_richer_model_gives_the_same_path_to_a_simpler_camera)
{
    for (int model = L1L2STAB_MOTION_MODEL_TRANSLATION; model < L1L2STAB_MOTION_MODEL_AFFINE; model++) {
        Setup poor = config_of((L1L2StabMotionModel)model, L1L2STAB_JOIN_CONTINUOUS), rich = poor;
        poor.crop_ratio = rich.crop_ratio = 0.7;
        rich.model = (L1L2StabMotionModel)(model + 1);
        Run *a = drifting_run(300, 0.5, 10.0, 3.0, 5), *b = drifting_run(300, 0.5, 10.0, 3.0, 5);
        for (int t = 0; t < a->frames; t++)
            a->F[t] = b->F[t] = l1l2_mat_reduce(&a->F[t], l1l2_mat_dim(poor.model));
        run(&poor, a);
        run(&rich, b);
        ck_assert_double_lt(worst_distance_px(a, b), 0.01);
        free(a);
        free(b);
    }
}
END_TEST

START_TEST(stretch_and_skew_are_smoothed_too)
{
    const Setup cfg = config_of(L1L2STAB_MOTION_MODEL_AFFINE, L1L2STAB_JOIN_CONTINUOUS);
    Run *r = affine_run(300, 0.004, 9);
    run(&cfg, r);
    double before = 0.0, after = 0.0;
    for (int t = 1; t < r->frames; t++) {
        double F[L1L2_DIM], S[L1L2_DIM];
        l1l2_mat_to_q(&r->out[t].F, F);
        l1l2_mat_to_q(&r->out[t].S, S);
        before += hypot(F[4], F[5]);
        after += hypot(S[4], S[5]);
    }
    ck_assert_msg(after < 0.02 * before, "stretch and skew a frame: %g of what it was", after / before);
    free(r);
}
END_TEST

START_TEST(where_no_solver_converges_every_model_holds_a_path_inside)
{
    for (int model = L1L2STAB_MOTION_MODEL_TRANSLATION; model <= L1L2STAB_MOTION_MODEL_AFFINE; model++) {
        const int dim = l1l2_mat_dim((L1L2StabMotionModel)model);
        Setup cfg = config_of((L1L2StabMotionModel)model, L1L2STAB_JOIN_CONTINUOUS);
        cfg.lambda = NAN;
        const L1L2PathCropWindow crop = l1l2_path_crop_window(cfg.width, cfg.height, cfg.crop_ratio, dim);
        Run *r = affine_run(130, 0.01, 4);
        run(&cfg, r);
        for (int t = 0; t < r->frames; t++) {
            const L1L2Mat B = l1l2_mat_reduce(&r->out[t].B, dim);
            ck_assert(r->out[t].fallback);
            ck_assert_near(l1l2_mat_corner_distance(&r->out[t].B, &B, 0.5, 0.5), 0.0, 1e-14);
            ck_assert_double_le(l1l2_path_constraint_excess(&crop, &r->out[t].B), 1e-12);
        }
        free(r);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("path_models");
    TCase *tcase = tcase_create("path_models");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, every_map_is_of_the_model_and_inside);
    tcase_add_test(tcase, a_translation_never_turns_or_zooms_the_picture);
    tcase_add_test(tcase, a_richer_model_gives_the_same_path_to_a_simpler_camera);
    tcase_add_test(tcase, stretch_and_skew_are_smoothed_too);
    tcase_add_test(tcase, where_no_solver_converges_every_model_holds_a_path_inside);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
