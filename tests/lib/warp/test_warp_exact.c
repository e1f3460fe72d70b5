/* SPDX-License-Identifier: MIT */
/* What the warp must give exactly, and which bytes it must not touch. */
#include "memory_fixture.h"
#include "warp/warp_fixture.h"

enum { KERNELS = 3, SITES = 3 };

static int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

/* The loop tests' index is the format. */
START_TEST(the_identity_copies)
{
    const int width = is_packed(_i) ? 46 : 45; /* pairs of pixels */
    Picture src = picture_new((L1L2StabFormat)_i, width, 27), dst = picture_new((L1L2StabFormat)_i, width, 27);
    picture_randomize(&src, 1);
    const L1L2Mat map = l1l2_mat_identity();
    for (int kernel = 0; kernel < KERNELS; kernel++)
        for (int site = 0; site < SITES; site++) {
            L1L2WarpConfig cfg = warp_config(&src, &dst);
            cfg.interpolation = (L1L2StabInterpolation)kernel;
            cfg.chroma_site = (L1L2StabChromaSite)site;
            warp_picture(&cfg, &map, &src, &dst);
            assert_same_picture(&src, &dst);
        }
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(whole_steps_copy_and_repeat_the_edge)
{
    if (is_packed(_i))
        return;
    static const int steps[][2] = {{4, -2}, {-8, 8}, {0, 2}, {60, 0}, {-400, 300}};
    Picture src = picture_new((L1L2StabFormat)_i, 45, 27), dst = picture_new((L1L2StabFormat)_i, 45, 27);
    picture_randomize(&src, 2);
    for (size_t k = 0; k < sizeof steps / sizeof steps[0]; k++)
        for (int kernel = 0; kernel < KERNELS; kernel++) {
            L1L2WarpConfig cfg = warp_config(&src, &dst);
            cfg.interpolation = (L1L2StabInterpolation)kernel;
            const L1L2Mat map = l1l2_mat_translation(steps[k][0], steps[k][1]);
            warp_picture(&cfg, &map, &src, &dst);
            for (int i = 0; i < src.format->planes; i++) {
                const Plane *p = &src.plane[i];
                const int dx = steps[k][0] >> src.format->plane[i].log2_sub_x;
                const int dy = steps[k][1] >> src.format->plane[i].log2_sub_y;
                for (int v = 0; v < p->height; v++)
                    for (int u = 0; u < p->width; u++)
                        if (memcmp(sample(&dst, i, u, v),
                                   sample(&src, i, clamp(u + dx, 0, p->width - 1), clamp(v + dy, 0, p->height - 1)),
                                   (size_t)p->sample_bytes))
                            ck_abort_msg("kernel %d plane %d (%d, %d) by (%d, %d)", kernel, i, u, v, dx, dy);
            }
        }
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

/* A mesh is always weighed; an affine map of whole steps is copied. */
START_TEST(copied_steps_are_what_weighing_gives)
{
    if (is_packed(_i))
        return;
    static const int steps[][2] = {{0, 0}, {4, -2}, {-8, 8}, {-1, 3}, {60, 0}, {-400, 300}};
    Picture src = picture_new((L1L2StabFormat)_i, 45, 27), copied = picture_new((L1L2StabFormat)_i, 37, 31);
    Picture weighed = picture_new((L1L2StabFormat)_i, 37, 31);
    picture_randomize(&src, 6);
    L1L2WarpMesh mesh;
    ck_assert(l1l2_warp_mesh_init(&mesh, 37, 31));
    for (size_t k = 0; k < sizeof steps / sizeof steps[0]; k++)
        for (int kernel = 0; kernel < KERNELS; kernel++) {
            L1L2WarpConfig cfg = warp_config(&src, &copied);
            cfg.interpolation = (L1L2StabInterpolation)kernel;
            const L1L2WarpMap map = {.affine = l1l2_mat_translation(steps[k][0], steps[k][1])};
            l1l2_warp_mesh_set(&mesh, &map.affine);
            warp_picture_by(&cfg, &map, &src, &copied);
            warp_picture_by(&cfg, &(L1L2WarpMap){.mesh = &mesh}, &src, &weighed);
            assert_same_picture(&copied, &weighed);
            assert_guards_untouched(&copied);
        }
    l1l2_warp_mesh_clear(&mesh);
    picture_free(&src);
    picture_free(&copied);
    picture_free(&weighed);
}
END_TEST

/* A whole step at the left side, off by a quarter of a sample at the right side. */
START_TEST(nearly_whole_steps_are_not_copied)
{
    Picture src = picture_new(L1L2STAB_FORMAT_GRAY8, 1200, 8), dst = picture_new(L1L2STAB_FORMAT_GRAY8, 1200, 8);
    for (int v = 0; v < src.height; v++)
        for (int u = 0; u < src.width; u++)
            set_level(&src, 0, u, v, 0, u % 2 * 255);
    const L1L2WarpConfig cfg = warp_config(&src, &dst);
    const L1L2Mat map = l1l2_mat_similarity(1.0 + 0.25 / 1200.0, 0.0, 0.125, 0.0);
    warp_picture(&cfg, &map, &src, &dst);
    ck_assert_int_lt(abs(level(&dst, 0, 2, 4, 0) - level(&src, 0, 2, 4, 0)), 8);
    ck_assert_int_gt(abs(level(&dst, 0, 1190, 4, 0) - level(&src, 0, 1190, 4, 0)), 32);
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(half_a_turn_reverses)
{
    if (is_packed(_i))
        return;
    Picture src = picture_new((L1L2StabFormat)_i, 48, 28), dst = picture_new((L1L2StabFormat)_i, 48, 28);
    picture_randomize(&src, 3);
    const L1L2Mat map = l1l2_mat_similarity(-1.0, 0.0, 0.0, 0.0);
    L1L2WarpConfig cfg = warp_config(&src, &dst);
    cfg.chroma_site = L1L2STAB_CHROMA_SITE_CENTER; /* the one that is symmetric */
    warp_picture(&cfg, &map, &src, &dst);
    for (int i = 0; i < src.format->planes; i++)
        for (int v = 0; v < src.plane[i].height; v++)
            for (int u = 0; u < src.plane[i].width; u++)
                if (memcmp(sample(&dst, i, u, v),
                           sample(&src, i, src.plane[i].width - 1 - u, src.plane[i].height - 1 - v),
                           (size_t)src.plane[i].sample_bytes))
                    ck_abort_msg("plane %d (%d, %d)", i, u, v);
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(a_flat_picture_stays_flat)
{
    static const double levels[] = {0.0, 0.004, 0.06, 0.498, 0.502, 0.92, 0.996, 1.0}; /* of full range */
    L1L2Rng rng = l1l2_rng_seeded(4);
    const int width = is_packed(_i) ? 46 : 45;
    Picture src = picture_new((L1L2StabFormat)_i, width, 27), dst = picture_new((L1L2StabFormat)_i, width, 27);
    for (size_t k = 0; k < sizeof levels / sizeof levels[0]; k++)
        for (int kernel = 0; kernel < KERNELS; kernel++) {
            for (int i = 0; i < src.format->planes; i++)
                for (int v = 0; v < src.plane[i].height; v++)
                    for (int c = 0; c < src.plane[i].width * src.plane[i].components; c++)
                        set_level(&src, i, 0, v, c, (int)lrint(levels[k] * max_level(&src)));
            L1L2WarpConfig cfg = warp_config(&src, &dst);
            cfg.interpolation = (L1L2StabInterpolation)kernel;
            const L1L2Mat map = random_similarity(&rng);
            warp_picture(&cfg, &map, &src, &dst);
            assert_same_picture(&src, &dst);
        }
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(any_number_of_threads_and_plain_c_give_the_same_bytes)
{
    static const int threads[] = {2, 3, 7};
    L1L2Rng rng = l1l2_rng_seeded(5);
    Picture src = picture_new((L1L2StabFormat)_i, 301, 203);
    Picture one = picture_new((L1L2StabFormat)_i, 301, 203), many = picture_new((L1L2StabFormat)_i, 301, 203);
    picture_randomize(&src, 5);
    for (int kernel = 0; kernel < KERNELS; kernel++) {
        const L1L2Mat map = random_similarity(&rng);
        L1L2WarpConfig cfg = warp_config(&src, &one);
        cfg.interpolation = (L1L2StabInterpolation)kernel;
        warp_picture(&cfg, &map, &src, &one);
        cfg.pool = l1l2_pool_create(threads[kernel]);
        warp_picture(&cfg, &map, &src, &many);
        assert_same_picture(&one, &many);
        assert_guards_untouched(&many);
        cfg.plain = true;
        warp_picture(&cfg, &map, &src, &many);
        assert_same_picture(&one, &many);
        l1l2_pool_free(cfg.pool);
    }
    picture_free(&src);
    picture_free(&one);
    picture_free(&many);
}
END_TEST

/* The same picture with its rows in memory from bottom to top. */
static Picture upside_down(const Picture *p)
{
    Picture q = *p;
    for (int i = 0; i < p->format->planes; i++) {
        q.plane[i].data = sample(p, i, 0, p->plane[i].height - 1);
        q.plane[i].stride = -p->plane[i].stride;
    }
    return q;
}

START_TEST(rows_may_run_from_bottom_to_top)
{
    const L1L2StabFormat format = (L1L2StabFormat)_i;
    Picture src = picture_new(format, 45, 27), flipped = picture_new(format, 45, 27);
    Picture dst = picture_new(format, 45, 27), expected = picture_new(format, 45, 27);
    picture_randomize(&src, 6);
    Picture from = upside_down(&flipped), to = upside_down(&dst);
    for (int i = 0; i < src.format->planes; i++)
        for (int v = 0; v < src.plane[i].height; v++)
            memcpy(sample(&from, i, 0, v), sample(&src, i, 0, v),
                   (size_t)(src.plane[i].width * src.plane[i].sample_bytes));
    const L1L2Mat map = l1l2_mat_similarity(0.93, 0.06, 1.3, -0.7);
    const L1L2WarpConfig cfg = warp_config(&src, &dst);
    warp_picture(&cfg, &map, &src, &expected);
    warp_picture(&cfg, &map, &from, &to);
    assert_same_picture(&to, &expected);
    assert_guards_untouched(&dst);
    picture_free(&src);
    picture_free(&flipped);
    picture_free(&dst);
    picture_free(&expected);
}
END_TEST

/* The map's numbers are short binary fractions, so that no rounding differs. */
START_TEST(a_smaller_output_is_the_middle_of_the_full_one)
{
    const L1L2StabFormat format = (L1L2StabFormat)_i;
    Picture src = picture_new(format, 64, 48), full = picture_new(format, 64, 48), crop = picture_new(format, 40, 32);
    picture_randomize(&src, 7);
    const L1L2Mat map = l1l2_mat_similarity(0.875, 0.0625, 1.25, -0.75);
    const L1L2WarpConfig to_full = warp_config(&src, &full), to_crop = warp_config(&src, &crop);
    warp_picture(&to_full, &map, &src, &full);
    warp_picture(&to_crop, &map, &src, &crop);
    for (int i = 0; i < src.format->planes; i++) {
        const Plane *p = &crop.plane[i];
        const int left = (full.plane[i].width - p->width) / 2, top = (full.plane[i].height - p->height) / 2;
        for (int v = 0; v < p->height; v++)
            if (memcmp(sample(&crop, i, 0, v), sample(&full, i, left, top + v), (size_t)(p->width * p->sample_bytes)))
                ck_abort_msg("plane %d row %d", i, v);
    }
    assert_guards_untouched(&crop);
    picture_free(&src);
    picture_free(&full);
    picture_free(&crop);
}
END_TEST

START_TEST(maps_far_outside_give_pixels_of_the_picture)
{
    const L1L2Mat maps[] = {
        l1l2_mat_translation(1e9, 1e9),        l1l2_mat_translation(1e300, 1e300),
        l1l2_mat_similarity(1e6, 0, 2e9, 2e9), l1l2_mat_similarity(1e308, -1e308, 0, 0),
        l1l2_mat_diagonal(0, 0),               l1l2_mat_similarity(3e4, 3e4, -1e5, 0),
    };
    Picture src = picture_new(L1L2STAB_FORMAT_GRAY8, 45, 27), dst = picture_new(L1L2STAB_FORMAT_GRAY8, 45, 27);
    for (int v = 0; v < 27; v++)
        for (int u = 0; u < 45; u++)
            *sample(&src, 0, u, v) = (uint8_t)(100 + u + v);
    for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++)
        for (int kernel = 0; kernel < KERNELS; kernel++) {
            L1L2WarpConfig cfg = warp_config(&src, &dst);
            cfg.interpolation = (L1L2StabInterpolation)kernel;
            warp_picture(&cfg, &maps[k], &src, &dst);
            for (int v = 0; v < 27; v++)
                for (int u = 0; u < 45; u++) {
                    const int got = *sample(&dst, 0, u, v);
                    if (k < 3 ? got != 100 + 44 + 26 : got < 98 || got > 100 + 44 + 26 + 2)
                        ck_abort_msg("map %zu (%d, %d): %d", k, u, v, got);
                }
        }
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(a_config_without_format_or_size_is_refused)
{
    const L1L2WarpConfig good = {.format = l1l2_image_format_info(L1L2STAB_FORMAT_I420),
                                 .in_width = 16,
                                 .in_height = 16,
                                 .out_width = 16,
                                 .out_height = 16};
    for (int k = 0; k < 5; k++) {
        L1L2WarpConfig cfg = good;
        cfg.format = k == 0 ? NULL : cfg.format;
        cfg.in_width = k == 1 ? 0 : 16;
        cfg.in_height = k == 2 ? -1 : 16;
        cfg.out_width = k == 3 ? 0 : 16;
        cfg.out_height = k == 4 ? 0 : 16;
        L1L2Warp *warp = (L1L2Warp *)&cfg;
        ck_assert_int_eq(l1l2_warp_create(&warp, &cfg), L1L2STAB_ERR_ARGUMENT);
        ck_assert_ptr_null(warp);
    }
}
END_TEST

/* The loop test's index: a format that needs memory for its planes, and one that does not. */
START_TEST(out_of_memory_leaves_nothing_behind)
{
    const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_YUY2};
    const L1L2WarpConfig cfg = {.format = l1l2_image_format_info(formats[_i]), .in_width = 16, .in_height = 16,
                                .out_width = 16, .out_height = 16};
    memory_fixture_begin();
    L1L2StabResult result = L1L2STAB_ERR_NOMEM;
    int k = 0;
    for (; result != L1L2STAB_OK && k < 20; k++) {
        memory_countdown = k;
        L1L2Warp *warp = NULL;
        result = l1l2_warp_create(&warp, &cfg);
        ck_assert(result == L1L2STAB_OK || (result == L1L2STAB_ERR_NOMEM && !warp));
        l1l2_warp_free(warp);
        ck_assert_int_eq(memory_alive, 0);
    }
    memory_fixture_end();
    ck_assert_int_eq(result, L1L2STAB_OK);
    ck_assert_int_gt(k, 1);
}
END_TEST

int main(void)
{
    const int first = FIRST_FORMAT, end = end_of_formats();
    Suite *suite = suite_create("warp, exactly");
    TCase *tc = tcase_create("exact");
    tcase_add_loop_test(tc, the_identity_copies, first, end);
    tcase_add_loop_test(tc, whole_steps_copy_and_repeat_the_edge, first, end);
    tcase_add_loop_test(tc, copied_steps_are_what_weighing_gives, first, end);
    tcase_add_test(tc, nearly_whole_steps_are_not_copied);
    tcase_add_loop_test(tc, half_a_turn_reverses, first, end);
    tcase_add_loop_test(tc, a_flat_picture_stays_flat, first, end);
    tcase_add_loop_test(tc, any_number_of_threads_and_plain_c_give_the_same_bytes, first, end);
    tcase_add_loop_test(tc, rows_may_run_from_bottom_to_top, first, end);
    tcase_add_loop_test(tc, a_smaller_output_is_the_middle_of_the_full_one, first, end);
    tcase_add_test(tc, maps_far_outside_give_pixels_of_the_picture);
    tcase_add_test(tc, a_config_without_format_or_size_is_refused);
    tcase_add_loop_test(tc, out_of_memory_leaves_nothing_behind, 0, 2);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
