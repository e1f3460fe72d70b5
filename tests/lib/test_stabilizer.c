/* SPDX-License-Identifier: MIT */
/* The public interface as a caller sees it: states, ownership, order and numbers. */
#include "stabilizer_fixture.h"

START_TEST(n_frames_in_are_n_frames_out_each_released_once)
{
    const int window = 8, lengths[] = {0, 1, 2, 3, window - 1, window, window + 1, 2 * window, 31};
    for (int join = 0; join < 2; join++)
        for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
            L1L2StabConfig cfg = small_config(window);
            cfg.join = (L1L2StabJoin)join;
            Clip *clip = new_clip(lengths[i], cfg.format);
            L1L2Stab *s = create(&cfg);
            ck_assert_int_eq(stabilize(s, clip, NULL, NULL), lengths[i]);
            l1l2stab_free(&s);
            ck_assert_ptr_null(s);
            for (int t = 0; t < clip->frames; t++)
                ck_assert_int_eq(clip->released[t], 1);
            free_clip(clip);
        }
}
END_TEST

START_TEST(a_frame_is_ready_when_the_window_is_full_and_not_before)
{
    const L1L2StabConfig cfg = small_config(10);
    Clip *clip = new_clip(14, cfg.format);
    L1L2Stab *s = create(&cfg);
    for (int t = 0; t < 14; t++) {
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        ck_assert_int_eq(l1l2stab_peek(s, NULL, NULL), t < 9 ? L1L2STAB_AGAIN : L1L2STAB_OK);
        if (t >= 9) {
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_AGAIN); /* full: pull first */
            ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_OK);
        }
    }
    l1l2stab_free(&s);
    for (int t = 0; t < 14; t++)
        ck_assert_int_eq(clip->released[t], 1); /* what was held is released by free */
    free_clip(clip);
}
END_TEST

START_TEST(hurried_frames_are_ready_at_once_and_those_after_them_wait_again)
{
    const L1L2StabConfig cfg = small_config(10);
    Clip *clip = new_clip(40, cfg.format);
    L1L2Stab *s = create(&cfg);
    L1L2StabInfo info;
    int pulled = 0;
    ck_assert_int_eq(l1l2stab_hurry(s, 3), L1L2STAB_OK); /* nothing is held */
    ck_assert_int_eq(l1l2stab_hurry(s, -1), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_hurry(NULL, 1), L1L2STAB_ERR_ARGUMENT);
    for (int t = 0; t < 40; t++) {
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        const int due = t == 5 ? 2 : t == 17 ? 100 : 0;
        ck_assert_int_eq(l1l2stab_hurry(s, due), L1L2STAB_OK);
        ck_assert_int_eq(l1l2stab_hurry(s, due / 2), L1L2STAB_OK); /* not more frames than were asked for */
        const int before = pulled, held = t + 1 - pulled;
        while (l1l2stab_peek(s, NULL, NULL) == L1L2STAB_OK) {
            ck_assert_int_eq(l1l2stab_pull(s, NULL, &info), L1L2STAB_OK);
            ck_assert_uint_eq(info.index, (uint64_t)pulled++);
            ck_assert(t != 5 || (info.flags & L1L2STAB_INFO_EARLY));
            for (int k = 0; k < 4; k++) {
                const L1L2Mat warp = mat_of(info.warp);
                const L1L2Point p = l1l2_mat_apply(&warp, (L1L2Point){k & 1 ? 80 : -80, k & 2 ? 48 : -48});
                ck_assert(fabs(p.x) <= 80 + 1e-9 && fabs(p.y) <= 48 + 1e-9);
            }
        }
        ck_assert_int_eq(pulled - before, t == 5 ? 2 : t == 17 ? held : held == 10);
    }
    ck_assert_int_eq(pulled, 40 - 9); /* the window has filled up again, and nothing was lost */
    l1l2stab_reset(s);
    for (int t = 0; t < 10; t++) { /* a reset forgets that anything was hurried */
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        ck_assert_int_eq(l1l2stab_peek(s, NULL, NULL), t < 9 ? L1L2STAB_AGAIN : L1L2STAB_OK);
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(reset_releases_and_is_as_good_as_new)
{
    const L1L2StabConfig cfg = small_config(8);
    L1L2StabInfo fresh[20], again[20];
    Clip *other = new_clip(11, cfg.format), *clip = new_clip(20, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, fresh, NULL), 20);
    l1l2stab_reset(s);
    for (int t = 0; t < 7; t++) {
        const L1L2StabFrame in = frame_of(other, 10 - t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    }
    l1l2stab_reset(s);
    for (int t = 4; t < 11; t++)
        ck_assert_int_eq(other->released[t], 1);
    memset(clip->released, 0, sizeof clip->released);
    ck_assert_int_eq(stabilize(s, clip, again, NULL), 20);
    for (int t = 0; t < 20; t++) {
        ck_assert_mem_eq(fresh[t].warp, again[t].warp, sizeof fresh[t].warp);
        ck_assert_uint_eq(again[t].index, (uint64_t)t);
    }
    l1l2stab_free(&s);
    free_clip(clip);
    free_clip(other);
}
END_TEST

START_TEST(calls_out_of_order_are_errors_and_change_nothing)
{
    const L1L2StabConfig cfg = small_config(8);
    Clip *clip = new_clip(2, cfg.format);
    L1L2Stab *s = create(&cfg);
    L1L2StabFrame in = frame_of(clip, 0);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_AGAIN);
    in.data[1] = NULL;
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(clip->released[0], 0); /* still the caller's */
    in = frame_of(clip, 0);
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
    in = frame_of(clip, 1);
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_ERR_STATE);
    L1L2StabFrame empty = {0};
    ck_assert_int_eq(l1l2stab_pull(s, &empty, NULL), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_EOS);
    ck_assert_int_eq(l1l2stab_push(NULL, &in), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_pull(NULL, NULL, NULL), L1L2STAB_ERR_ARGUMENT);
    l1l2stab_reset(NULL);
    l1l2stab_free(NULL);
    l1l2stab_free(&s);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(the_infos_matrices_agree_with_each_other)
{
    const L1L2StabConfig cfg = small_config(16);
    L1L2StabInfo info[60];
    Clip *clip = new_clip(60, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, info, NULL), 60);
    L1L2Mat C = l1l2_mat_identity(), P_before = l1l2_mat_identity();
    for (int t = 0; t < 60; t++) {
        const L1L2Mat F = mat_of(info[t].F), B = mat_of(info[t].B), S = mat_of(info[t].S);
        C = t == 0 ? C : l1l2_mat_mul(C, F); /* eq. (1) */
        const L1L2Mat P = l1l2_mat_mul(C, B); /* eq. (2) */
        const L1L2Mat info_C = mat_of(info[t].C), info_P = mat_of(info[t].P), warp = mat_of(info[t].warp);
        ck_assert_near(l1l2_mat_corner_distance(&C, &info_C, 80, 48), 0.0, 1e-6);
        ck_assert_near(l1l2_mat_corner_distance(&P, &info_P, 80, 48), 0.0, 1e-6);
        if (t > 0) {
            const L1L2Mat moved = l1l2_mat_mul(P_before, S);
            ck_assert_near(l1l2_mat_corner_distance(&P, &moved, 80, 48), 0.0, 1e-6);
        }
        const L1L2Mat zoomed = l1l2_mat_mul(B, l1l2_mat_diagonal(0.8, 0.8)); /* output pixel u reads B (crop u) */
        ck_assert_near(l1l2_mat_corner_distance(&warp, &zoomed, 80, 48), 0.0, 1e-9);
        for (int k = 0; k < 4; k++) { /* inclusion */
            const L1L2Point p = l1l2_mat_apply(&warp, (L1L2Point){k & 1 ? 80 : -80, k & 2 ? 48 : -48});
            ck_assert(fabs(p.x) <= 80 + 1e-9 && fabs(p.y) <= 48 + 1e-9);
        }
        ck_assert_int_eq(info[t].flags & L1L2STAB_INFO_PATH_START ? 1 : 0, t == 0);
        ck_assert_int_eq(info[t].model, t == 0 ? L1L2STAB_MOTION_SOURCE_NONE : L1L2STAB_MOTION_SOURCE_SIMILARITY);
        P_before = P;
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(a_discontinuity_starts_a_path_without_a_change_of_delay)
{
    const L1L2StabConfig cfg = small_config(12);
    L1L2StabInfo info[40];
    Clip *clip = new_clip(40, cfg.format);
    L1L2Stab *s = create(&cfg);
    int pulled = 0;
    for (int t = 0; t < 40; t++) {
        L1L2StabFrame in = frame_of(clip, t);
        in.flags = t == 19 ? L1L2STAB_FRAME_DISCONT : 0;
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (l1l2stab_pull(s, NULL, &info[pulled]) == L1L2STAB_OK)
            pulled++;
        ck_assert_int_eq(pulled, t < 11 ? 0 : t - 10);
    }
    ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
    while (l1l2stab_pull(s, NULL, &info[pulled]) == L1L2STAB_OK)
        pulled++;
    ck_assert_int_eq(pulled, 40);
    for (int t = 0; t < 40; t++) {
        ck_assert_uint_eq(info[t].index, (uint64_t)t);
        ck_assert_uint_eq(info[t].path_index, (uint64_t)(t < 19 ? t : t - 19));
        ck_assert_int_eq(info[t].flags & L1L2STAB_INFO_PATH_START ? 1 : 0, t == 0 || t == 19);
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(given_motions_take_the_place_of_measured_ones)
{
    const L1L2StabConfig cfg = small_config(16);
    L1L2StabInfo measured[40], given;
    Clip *clip = new_clip(40, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, measured, NULL), 40);
    l1l2stab_reset(s);
    int pulled = 0;
    for (int t = 0; t <= 40; t++) { /* no pixels at all */
        const L1L2StabFrame in = {.pts = t, .motion = t < 40 ? measured[t].F : NULL};
        ck_assert_int_eq(t < 40 ? l1l2stab_push(s, &in) : l1l2stab_finish(s), L1L2STAB_OK);
        L1L2StabFrame out = frame_of(clip, 0);
        if (l1l2stab_peek(s, NULL, NULL) == L1L2STAB_OK) /* there is nothing to render */
            ck_assert_int_eq(l1l2stab_pull(s, &out, NULL), L1L2STAB_ERR_ARGUMENT);
        for (; l1l2stab_pull(s, NULL, &given) == L1L2STAB_OK; pulled++) {
            const L1L2Mat a = mat_of(measured[pulled].B), b = mat_of(given.B);
            ck_assert_near(l1l2_mat_corner_distance(&a, &b, 80, 48), 0.0, 1e-6);
            ck_assert_int_eq(given.model, pulled == 0 ? L1L2STAB_MOTION_SOURCE_NONE : L1L2STAB_MOTION_SOURCE_GIVEN);
        }
    }
    ck_assert_int_eq(pulled, 40);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(every_motion_model_runs_and_its_maps_are_of_the_model)
{
    Clip *clip = new_clip(40, L1L2STAB_FORMAT_I420);
    for (int model = L1L2STAB_MOTION_MODEL_TRANSLATION; model <= L1L2STAB_MOTION_MODEL_AFFINE; model++) {
        L1L2StabConfig cfg = small_config(16);
        cfg.motion_model = (L1L2StabMotionModel)model;
        L1L2StabInfo info[40];
        L1L2Stab *s = create(&cfg);
        ck_assert_int_eq(stabilize(s, clip, info, NULL), 40);
        for (int t = 0; t < 40; t++) {
            const L1L2Mat F = mat_of(info[t].F), B = mat_of(info[t].B), warp = mat_of(info[t].warp);
            const L1L2Mat F_model = l1l2_mat_reduce(&F, l1l2_mat_dim(cfg.motion_model));
            const L1L2Mat B_model = l1l2_mat_reduce(&B, l1l2_mat_dim(cfg.motion_model));
            ck_assert_near(l1l2_mat_corner_distance(&F, &F_model, 80, 48), 0.0, 1e-9);
            ck_assert_near(l1l2_mat_corner_distance(&B, &B_model, 80, 48), 0.0, 1e-9);
            for (int k = 0; k < 4; k++) {
                const L1L2Point p = l1l2_mat_apply(&warp, (L1L2Point){k & 1 ? 80 : -80, k & 2 ? 48 : -48});
                ck_assert(fabs(p.x) <= 80 + 1e-9 && fabs(p.y) <= 48 + 1e-9);
            }
        }
        l1l2stab_free(&s);
        memset(clip->released, 0, sizeof clip->released);
    }
    free_clip(clip);
}
END_TEST

START_TEST(a_given_motion_has_to_be_an_invertible_map_of_the_model)
{
    static const double motions[5][9] = {{1, 0, 3, 0, 1, -2, 0, 0, 1},    {1.1, -0.2, 3, 0.2, 1.1, -2, 0, 0, 1},
                                         {1, 0.5, 0, 0, 1, 0, 0, 0, 1},   {1, 0, 0, 0, 1, 0, 1e-9, 0, 1},
                                         {0, 0, 0, 0, 0, 0, 0, 0, 1}};
    for (int model = L1L2STAB_MOTION_MODEL_TRANSLATION; model <= L1L2STAB_MOTION_MODEL_AFFINE; model++) {
        L1L2StabConfig cfg = small_config(16);
        cfg.motion_model = (L1L2StabMotionModel)model;
        L1L2Stab *s = create(&cfg);
        L1L2StabInfo info;
        for (int i = 0; i < 5; i++) { /* translation, similarity, affine map, homography, nothing */
            const L1L2StabFrame in = {.motion = motions[i]};
            ck_assert_int_eq(l1l2stab_push(s, &in), i <= model ? L1L2STAB_OK : L1L2STAB_ERR_ARGUMENT);
        }
        ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
        for (int i = 0; i <= model; i++) { /* what is given comes back; a path's first frame has none */
            const L1L2Mat given = mat_of(motions[i]), identity = l1l2_mat_identity();
            ck_assert_int_eq(l1l2stab_pull(s, NULL, &info), L1L2STAB_OK);
            const L1L2Mat F = mat_of(info.F);
            ck_assert_near(l1l2_mat_corner_distance(&F, i == 0 ? &identity : &given, 80, 48), 0.0, 1e-12);
        }
        ck_assert_int_eq(l1l2stab_pull(s, NULL, &info), L1L2STAB_EOS);
        l1l2stab_free(&s);
    }
}
END_TEST

START_TEST(settings_changed_while_running_are_checked_and_used)
{
    const L1L2StabConfig cfg = small_config(8);
    L1L2StabInfo info;
    Clip *clip = new_clip(60, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(l1l2stab_set_lambda(s, -1.0), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_set_lambda(NULL, 1.0), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_set_crop_ratio(s, 1.5), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_set_crop_ratio(NULL, 0.9), L1L2STAB_ERR_ARGUMENT);
    for (int t = 0; t < 60; t++) {
        if (t == 10) {
            ck_assert_int_eq(l1l2stab_set_lambda(s, 2.0), L1L2STAB_OK);
            ck_assert_int_eq(l1l2stab_set_crop_ratio(s, 0.6), L1L2STAB_OK);
        }
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (l1l2stab_pull(s, NULL, &info) != L1L2STAB_OK)
            continue;
        ck_assert_near(info.lambda, info.index < 10 ? 0.5 : 2.0, 0.0);
        if (info.index < 10 || info.index >= 50)
            ck_assert_near(info.crop_ratio, info.index < 10 ? 0.8 : 0.6, 1e-12);
        for (int k = 0; k < 4; k++) {
            const L1L2Mat warp = mat_of(info.warp);
            const L1L2Point p = l1l2_mat_apply(&warp, (L1L2Point){k & 1 ? 80 : -80, k & 2 ? 48 : -48});
            ck_assert(fabs(p.x) <= 80 + 1e-9 && fabs(p.y) <= 48 + 1e-9);
        }
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(the_threads_are_those_asked_for_and_the_inner_loops_have_a_name)
{
    for (int threads = 0; threads <= 3; threads++) {
        L1L2StabConfig cfg = small_config(8);
        cfg.threads = threads;
        L1L2Stab *s = create(&cfg);
        ck_assert_int_ge(l1l2stab_threads(s), 1);
        if (threads)
            ck_assert_int_eq(l1l2stab_threads(s), threads);
        l1l2stab_free(&s);
    }
    ck_assert_int_eq(l1l2stab_threads(NULL), 0);
    /* An x86-64 processor may lack AVX2. No 64-bit ARM processor lacks NEON. */
    const bool may_lack_it = strcmp(BUILT_SIMD, "avx2") == 0;
    ck_assert(strcmp(l1l2stab_simd(), BUILT_SIMD) == 0 || (may_lack_it && strcmp(l1l2stab_simd(), "none") == 0));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stabilizer");
    TCase *tcase = tcase_create("stabilizer");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, n_frames_in_are_n_frames_out_each_released_once);
    tcase_add_test(tcase, a_frame_is_ready_when_the_window_is_full_and_not_before);
    tcase_add_test(tcase, hurried_frames_are_ready_at_once_and_those_after_them_wait_again);
    tcase_add_test(tcase, reset_releases_and_is_as_good_as_new);
    tcase_add_test(tcase, calls_out_of_order_are_errors_and_change_nothing);
    tcase_add_test(tcase, the_infos_matrices_agree_with_each_other);
    tcase_add_test(tcase, a_discontinuity_starts_a_path_without_a_change_of_delay);
    tcase_add_test(tcase, given_motions_take_the_place_of_measured_ones);
    tcase_add_test(tcase, the_threads_are_those_asked_for_and_the_inner_loops_have_a_name);
    tcase_add_test(tcase, every_motion_model_runs_and_its_maps_are_of_the_model);
    tcase_add_test(tcase, a_given_motion_has_to_be_an_invertible_map_of_the_model);
    tcase_add_test(tcase, settings_changed_while_running_are_checked_and_used);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
