/* SPDX-License-Identifier: MIT */
/* The warp against a floating-point warp, and its chroma against its luma. test_warp_exact.c has what must be exact. */
#include "warp/warp_reference.h"

/* The loop test's index is the format. */
START_TEST(every_format_and_kernel_follows_a_floating_point_warp)
{
    static const int sizes[][4] = {
        {16, 16, 16, 16}, {33, 17, 33, 17}, {64, 48, 64, 48}, {65, 31, 40, 22}, {30, 34, 51, 41}};
    const L1L2StabFormat format = (L1L2StabFormat)_i;
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    if (is_packed(format))
        return;
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        Picture src = picture_new(format, sizes[k][0], sizes[k][1]);
        Picture dst = picture_new(format, sizes[k][2], sizes[k][3]);
        picture_randomize(&src, k);
        for (int kernel = 0; kernel < 3; kernel++)
            for (int site = 0; site < 3; site++) {
                const L1L2WarpMap map = {.affine = random_similarity(&rng)};
                L1L2WarpConfig cfg = warp_config(&src, &dst);
                cfg.interpolation = (L1L2StabInterpolation)kernel;
                cfg.chroma_site = (L1L2StabChromaSite)site;
                assert_follows_reference(&cfg, &map, &src, &dst);
            }
        picture_free(&src);
        picture_free(&dst);
    }
}
END_TEST

/* Such maps have no scanlines: samples are rendered one by one in all formats. The loop test's index is the
 * interpolation. */
START_TEST(maps_that_turn_far_or_zoom_out_follow_it_too)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_NV12, L1L2STAB_FORMAT_RGB,
                                             L1L2STAB_FORMAT_BGRA};
    static const double turns[][2] = {{1.0, 0.7}, {0.9, 1.6}, {1.1, 3.0}, {0.8, -2.0}, {1.7, 0.02}, {2.4, -0.1}};
    for (int f = 0; f < 4; f++) {
        Picture src = picture_new(formats[f], 64, 48), dst = picture_new(formats[f], 51, 41);
        picture_randomize(&src, (uint64_t)f);
        L1L2WarpConfig cfg = warp_config(&src, &dst);
        cfg.interpolation = (L1L2StabInterpolation)_i;
        for (size_t k = 0; k < sizeof turns / sizeof turns[0]; k++) {
            const double zoom = turns[k][0], angle = turns[k][1];
            const L1L2WarpMap map = {
                .affine = l1l2_mat_similarity(zoom * cos(angle), zoom * sin(angle), 1.3, -0.7)};
            assert_follows_reference(&cfg, &map, &src, &dst);
        }
        picture_free(&src);
        picture_free(&dst);
    }
}
END_TEST

/* A row's sum is cut, not rounded, before the columns are summed: without a correction this would darken by 0.008. */
START_TEST(the_mean_level_is_kept)
{
    L1L2Rng rng = l1l2_rng_seeded(11);
    Picture src = picture_new(L1L2STAB_FORMAT_GRAY8, 320, 240), dst = picture_new(L1L2STAB_FORMAT_GRAY8, 320, 240);
    for (int v = 0; v < src.height; v++)
        for (int u = 0; u < src.width; u++)
            *sample(&src, 0, u, v) = (uint8_t)(80 + l1l2_rng_below(&rng, 96)); /* no overshoot that is cut off */
    const L1L2WarpMap map = {.affine = random_similarity(&rng)};
    L1L2WarpConfig cfg = warp_config(&src, &dst);
    cfg.interpolation = (L1L2StabInterpolation)_i;
    warp_picture_by(&cfg, &map, &src, &dst);
    double sum = 0;
    for (int v = 0; v < dst.height; v++)
        for (int u = 0; u < dst.width; u++)
            sum += *sample(&dst, 0, u, v) - reference(&cfg, &map, &src, 0, u, v, 0);
    /* Bilinear rounds 7 fractional bits half up in the end, which is 1/256 too bright. */
    ck_assert_near(sum / (dst.width * dst.height), _i == L1L2STAB_INTERPOLATION_BILINEAR ? 1.0 / 256 : 0.0, 0.004);
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(affine_maps_that_are_no_similarities_are_followed_too)
{
    const L1L2Mat maps[] = {
        {{0.9, 0.2, 1.5, -0.1, 1.1, -2.25, 0, 0, 1}},   /* sheared */
        {{-0.9, 0.05, 0.5, 0.02, 0.8, 0.75, 0, 0, 1}},  /* mirrored */
        {{0.1, -1.0, 0.25, 1.05, 0.1, 0.5, 0, 0, 1}},   /* turned by about 90 degrees */
        {{4.5, 0.3, 0.0, -0.2, 3.7, 0.0, 0, 0, 1}},     /* shrunk */
        {{0.05, 0.01, 3.0, -0.01, 0.07, 2.0, 0, 0, 1}}, /* magnified */
    };
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_NV12, L1L2STAB_FORMAT_BGR, L1L2STAB_FORMAT_BGRX,
                                             L1L2STAB_FORMAT_P010_10LE, L1L2STAB_FORMAT_ARGB64_LE};
    for (size_t f = 0; f < sizeof formats / sizeof formats[0]; f++) {
        if (format_left_out(formats[f]))
            continue;
        Picture src = picture_new(formats[f], 61, 43), dst = picture_new(formats[f], 61, 43);
        picture_randomize(&src, 7);
        for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++)
            for (int kernel = 0; kernel < 3; kernel++) {
                L1L2WarpConfig cfg = warp_config(&src, &dst);
                cfg.interpolation = (L1L2StabInterpolation)kernel;
                const L1L2WarpMap map = {.affine = maps[k]};
                assert_follows_reference(&cfg, &map, &src, &dst);
            }
        picture_free(&src);
        picture_free(&dst);
    }
}
END_TEST

/*
 * Chroma against luma. A wave is drawn into all planes, each sample at its own place in the frame, and warped. If the
 * planes stay together, the wave of each plane ends where the map says. The wave is drawn twice, a quarter of a period
 * apart (re, im), so each sample has a phase. The mean difference from the phase that the map says, divided by the
 * wave's frequency, is the displacement of the plane.
 */
static const double FREQUENCY[2] = {2 * PI / 23.0, 2 * PI / 31.0}; /* rad/px */

static void draw_wave(Picture *p, L1L2StabChromaSite site, double phase)
{
    const int left = site != L1L2STAB_CHROMA_SITE_CENTER, top = site == L1L2STAB_CHROMA_SITE_TOP_LEFT;
    for (int i = 0; i < p->format->planes; i++)
        for (int v = 0; v < p->plane[i].height; v++)
            for (int u = 0; u < p->plane[i].width; u++) {
                const double x = frame_position(u, p->format->plane[i].log2_sub_x, left) - p->width / 2.0;
                const double y = frame_position(v, p->format->plane[i].log2_sub_y, top) - p->height / 2.0;
                const double wave = 0.5 + 0.43 * cos(FREQUENCY[0] * x + FREQUENCY[1] * y + phase);
                for (int c = 0; c < p->plane[i].components; c++)
                    set_level(p, i, u, v, c, (int)lrint(wave * max_level(p)));
            }
}

/* The displacement of a plane, px along the wave's direction. */
static double displacement(const L1L2Mat *map, L1L2StabChromaSite site, const Picture *re, const Picture *im, int plane)
{
    const int left = site != L1L2STAB_CHROMA_SITE_CENTER, top = site == L1L2STAB_CHROMA_SITE_TOP_LEFT;
    const Plane *p = &re->plane[plane];
    const int sub_x = re->format->plane[plane].log2_sub_x, sub_y = re->format->plane[plane].log2_sub_y;
    double sum_re = 0, sum_im = 0;
    for (int v = 3; v < p->height - 3; v++)
        for (int u = 3; u < p->width - 3; u++) {
            const L1L2Point to = {frame_position(u, sub_x, left) - re->width / 2.0,
                                  frame_position(v, sub_y, top) - re->height / 2.0};
            const L1L2Point from = l1l2_mat_apply(map, to);
            const double phase = FREQUENCY[0] * from.x + FREQUENCY[1] * from.y;
            const double a = level(re, plane, u, v, 0) - 0.5 * max_level(re);
            const double b = level(im, plane, u, v, 0) - 0.5 * max_level(im);
            sum_re += a * cos(phase) + b * sin(phase);
            sum_im += b * cos(phase) - a * sin(phase);
        }
    return atan2(sum_im, sum_re) / hypot(FREQUENCY[0], FREQUENCY[1]);
}

/* A wrong site shows only if the map is not a translation: half a pixel at 90 degrees, 0.2 px at a zoom of 0.6. The
 * maps have all phases, since a cubic with a = -0.75 displaces by up to 0.05 samples at some phases and back at others.
 * */
START_TEST(chroma_stays_where_the_luma_is)
{
    const L1L2StabChromaSite site = (L1L2StabChromaSite)_i;
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_NV12, L1L2STAB_FORMAT_Y42B,
                                             L1L2STAB_FORMAT_I420_10LE, L1L2STAB_FORMAT_P010_10LE};
    const L1L2Mat maps[] = {l1l2_mat_similarity(0.97, 0.03, 0.37, -0.21), l1l2_mat_similarity(0.6, 0.0, 0.0, 0.0),
                            l1l2_mat_similarity(0.0, 0.8, 0.0, 0.0), l1l2_mat_similarity(0.0, -0.8, 0.3, 0.1)};
    for (size_t f = 0; f < sizeof formats / sizeof formats[0]; f++)
        for (size_t k = 0; k < 4 && !format_left_out(formats[f]); k++) {
            Picture src = picture_new(formats[f], 101, 103);
            Picture re = picture_new(formats[f], 94, 81), im = picture_new(formats[f], 94, 81);
            L1L2WarpConfig cfg = warp_config(&src, &re);
            cfg.chroma_site = site;
            draw_wave(&src, site, 0.0);
            warp_picture(&cfg, &maps[k], &src, &re);
            draw_wave(&src, site, -PI / 2);
            warp_picture(&cfg, &maps[k], &src, &im);
            for (int i = 0; i < src.format->planes; i++)
                ck_assert_near(displacement(&maps[k], site, &re, &im, i), 0.0, 0.01);
            picture_free(&src);
            picture_free(&re);
            picture_free(&im);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("warp");
    TCase *tc = tcase_create("warp");
    tcase_add_loop_test(tc, every_format_and_kernel_follows_a_floating_point_warp, FIRST_FORMAT,
                        end_of_formats());
    tcase_add_loop_test(tc, maps_that_turn_far_or_zoom_out_follow_it_too, 0, 3);
    tcase_add_loop_test(tc, the_mean_level_is_kept, 0, 3);
    tcase_add_test(tc, affine_maps_that_are_no_similarities_are_followed_too);
    tcase_add_loop_test(tc, chroma_stays_where_the_luma_is, 0, 3);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
