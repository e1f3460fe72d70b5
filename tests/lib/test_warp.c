/* SPDX-License-Identifier: MIT */
/* The warp against a floating-point one, and its chroma against its luma. What must be exact: test_warp_exact.c. */
#include "warp_fixture.h"

#define PI 3.14159265358979323846

/* The reference: for every sample, the sum over its taps in doubles, with positions and weights unrounded. */

static double weigh(L1L2StabInterpolation interpolation, double x)
{
    const double t = fabs(x), a = -0.75;
    if (interpolation == L1L2STAB_INTERPOLATION_BILINEAR)
        return t < 1 ? 1 - t : 0;
    if (interpolation == L1L2STAB_INTERPOLATION_BICUBIC)
        return t < 1 ? (a + 2) * t * t * t - (a + 3) * t * t + 1
                     : t < 2 ? a * t * t * t - 5 * a * t * t + 8 * a * t - 4 * a : 0;
    return t == 0 ? 1 : t < 3 ? sin(PI * t) / (PI * t) * sin(PI * t / 3) / (PI * t / 3) : 0;
}

static int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

/* Where samples of a plane lie in the frame, by axis, from the definition of the sites. */
static double frame_position(int index, int log2_sub, int cosited)
{
    return log2_sub == 0 || cosited ? (index << log2_sub) + 0.5 : 2 * index + 1.0;
}

static double plane_position(double at, int log2_sub, int cosited)
{
    return log2_sub == 0 ? at - 0.5 : cosited ? (at - 0.5) / 2 : (at - 1.0) / 2;
}

/* Output sample (u, v) -> source position in samples of the same plane. */
static L1L2Point source_position(const L1L2WarpConfig *cfg, const L1L2Mat *map, int plane, int u, int v)
{
    const int sub_x = cfg->format->plane[plane].log2_sub_x, sub_y = cfg->format->plane[plane].log2_sub_y;
    const int left = cfg->chroma_site != L1L2STAB_CHROMA_SITE_CENTER;
    const int top = cfg->chroma_site == L1L2STAB_CHROMA_SITE_TOP_LEFT;
    const L1L2Point to = {frame_position(u, sub_x, left) - cfg->out_width / 2.0,
                          frame_position(v, sub_y, top) - cfg->out_height / 2.0};
    const L1L2Point from = l1l2_mat_apply(map, to);
    return (L1L2Point){plane_position(from.x + cfg->in_width / 2.0, sub_x, left),
                       plane_position(from.y + cfg->in_height / 2.0, sub_y, top)};
}

static void weigh_axis(const L1L2WarpConfig *cfg, double at, int size, double weight[6], int index[6])
{
    const int first = (int)floor(at) - 2;
    double sum = 0;
    for (int k = 0; k < 6; k++) {
        weight[k] = weigh(cfg->interpolation, first + k - at);
        index[k] = clamp(first + k, 0, size - 1);
        sum += weight[k];
    }
    for (int k = 0; k < 6; k++)
        weight[k] /= sum;
}

static double reference(const L1L2WarpConfig *cfg, const L1L2Mat *map, const Picture *src, int plane, int u, int v,
                        int component)
{
    const L1L2Point at = source_position(cfg, map, plane, u, v);
    double wx[6], wy[6], sum = 0;
    int ix[6], iy[6];
    weigh_axis(cfg, at.x, src->plane[plane].width, wx, ix);
    weigh_axis(cfg, at.y, src->plane[plane].height, wy, iy);
    for (int r = 0; r < 6; r++)
        for (int k = 0; k < 6; k++)
            sum += wy[r] * wx[k] * sample(src, plane, ix[k], iy[r])[component];
    return fmin(fmax(sum, 0), 255);
}

/*
 * What may the fixed point cost on noise of full range? With G for the largest sum of a kernel's |weights| along an
 * axis and D for half the largest sum of their |slopes|:
 *   the output's rounding           0.5
 *   positions to 1/1024             2 * 255 * D * G / 2048
 *   weights to 14 bits, twice the rounding of each, for the nearest takes what is left over
 *                                   2 * 255 * G * taps / 16384; none for the bilinear's, which are exact
 *   rows cut to 6 bits              G / 128
 * Below 1.5, so that a sample is never more than 1 from the rounded exact value.
 */
static const double WORST[] = {
    [L1L2STAB_INTERPOLATION_BILINEAR] = 0.5 + 0.25 + 0.01,          /* G = 1, D = 1 */
    [L1L2STAB_INTERPOLATION_BICUBIC] = 0.5 + 0.52 + 0.18 + 0.02,    /* G = 1.375, D = 1.5 */
    [L1L2STAB_INTERPOLATION_LANCZOS] = 0.5 + 0.63 + 0.30 + 0.02,    /* G = 1.55, D = 1.59 */
};

static void assert_close_to_reference(const L1L2WarpConfig *cfg, const L1L2Mat *map, const Picture *src,
                                      const Picture *dst)
{
    double squares = 0;
    int number = 0;
    for (int i = 0; i < dst->format->planes; i++)
        for (int v = 0; v < dst->plane[i].height; v++)
            for (int u = 0; u < dst->plane[i].width; u++)
                for (int c = 0; c < dst->plane[i].components; c++) {
                    const double exact = reference(cfg, map, src, i, u, v, c);
                    const double error = sample(dst, i, u, v)[c] - exact;
                    if (fabs(error) > WORST[cfg->interpolation])
                        ck_abort_msg("%s kernel %d site %d plane %d (%d, %d): %d for %f", cfg->format->name,
                                     cfg->interpolation, cfg->chroma_site, i, u, v, sample(dst, i, u, v)[c], exact);
                    squares += error * error;
                    number++;
                }
    /* Rounding alone gives 58.9 dB. */
    ck_assert_double_ge(10 * log10(255.0 * 255.0 * number / squares), 58.0);
}

/* The loop test's index is the format. */
START_TEST(every_format_and_kernel_follows_a_floating_point_warp)
{
    static const int sizes[][4] = {
        {16, 16, 16, 16}, {33, 17, 33, 17}, {64, 48, 64, 48}, {65, 31, 40, 22}, {30, 34, 51, 41}};
    const L1L2StabFormat format = (L1L2StabFormat)_i;
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        Picture src = picture_new(format, sizes[k][0], sizes[k][1]);
        Picture dst = picture_new(format, sizes[k][2], sizes[k][3]);
        picture_randomize(&src, k);
        for (int kernel = 0; kernel < 3; kernel++)
            for (int site = 0; site < 3; site++) {
                const L1L2Mat map = random_similarity(&rng);
                L1L2WarpConfig cfg = warp_config(&src, &dst);
                cfg.interpolation = (L1L2StabInterpolation)kernel;
                cfg.chroma_site = (L1L2StabChromaSite)site;
                warp_picture(&cfg, &map, &src, &dst);
                assert_close_to_reference(&cfg, &map, &src, &dst);
                assert_guards_untouched(&dst);
            }
        picture_free(&src);
        picture_free(&dst);
    }
}
END_TEST

/* Rows are cut, not rounded, before the columns are summed: that alone would darken by 0.008. */
START_TEST(the_mean_level_is_kept)
{
    L1L2Rng rng = l1l2_rng_seeded(11);
    Picture src = picture_new(L1L2STAB_FORMAT_GRAY8, 320, 240), dst = picture_new(L1L2STAB_FORMAT_GRAY8, 320, 240);
    for (int v = 0; v < src.height; v++)
        for (int u = 0; u < src.width; u++)
            *sample(&src, 0, u, v) = (uint8_t)(80 + l1l2_rng_below(&rng, 96)); /* no overshoot that is cut off */
    const L1L2Mat map = random_similarity(&rng);
    L1L2WarpConfig cfg = warp_config(&src, &dst);
    cfg.interpolation = (L1L2StabInterpolation)_i;
    warp_picture(&cfg, &map, &src, &dst);
    double sum = 0;
    for (int v = 0; v < dst.height; v++)
        for (int u = 0; u < dst.width; u++)
            sum += *sample(&dst, 0, u, v) - reference(&cfg, &map, &src, 0, u, v, 0);
    ck_assert_near(sum / (dst.width * dst.height), 0.0, 0.004);
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
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_NV12, L1L2STAB_FORMAT_BGR, L1L2STAB_FORMAT_BGRX};
    for (size_t f = 0; f < 3; f++) {
        Picture src = picture_new(formats[f], 61, 43), dst = picture_new(formats[f], 61, 43);
        picture_randomize(&src, 7);
        for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++)
            for (int kernel = 0; kernel < 3; kernel++) {
                L1L2WarpConfig cfg = warp_config(&src, &dst);
                cfg.interpolation = (L1L2StabInterpolation)kernel;
                warp_picture(&cfg, &maps[k], &src, &dst);
                assert_close_to_reference(&cfg, &maps[k], &src, &dst);
            }
        picture_free(&src);
        picture_free(&dst);
    }
}
END_TEST

/*
 * Chroma against luma: a wave, drawn at every sample's own place in the frame, is warped. If the planes are warped as
 * one, the wave comes out where the map says, in each of them. Drawn twice, a quarter of a wave apart (re, im), it has
 * a phase at each sample, and the mean difference from the phase that the map says, divided by the wave's frequency,
 * is how far the plane is displaced.
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
                const double level = 127.5 + 110 * cos(FREQUENCY[0] * x + FREQUENCY[1] * y + phase);
                for (int c = 0; c < p->plane[i].components; c++)
                    sample(p, i, u, v)[c] = (uint8_t)lrint(level);
            }
}

/* px, along the wave's direction */
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
            const double a = sample(re, plane, u, v)[0] - 127.5, b = sample(im, plane, u, v)[0] - 127.5;
            sum_re += a * cos(phase) + b * sin(phase);
            sum_im += b * cos(phase) - a * sin(phase);
        }
    return atan2(sum_im, sum_re) / hypot(FREQUENCY[0], FREQUENCY[1]);
}

/* A wrong site shows only where the map is no translation: at 90 degrees by half a pixel, at a zoom of 0.6 by 0.2. The
 * maps make all phases, for a cubic with a = -0.75 displaces by up to 0.05 samples at some, and back at others. */
START_TEST(chroma_stays_where_the_luma_is)
{
    const L1L2StabChromaSite site = (L1L2StabChromaSite)_i;
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_NV12, L1L2STAB_FORMAT_Y42B};
    const L1L2Mat maps[] = {l1l2_mat_similarity(0.97, 0.03, 0.37, -0.21), l1l2_mat_similarity(0.6, 0.0, 0.0, 0.0),
                            l1l2_mat_similarity(0.0, 0.8, 0.0, 0.0), l1l2_mat_similarity(0.0, -0.8, 0.3, 0.1)};
    for (size_t f = 0; f < 3; f++)
        for (size_t k = 0; k < 4; k++) {
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
    tcase_add_loop_test(tc, every_format_and_kernel_follows_a_floating_point_warp, L1L2STAB_FORMAT_GRAY8,
                        L1L2STAB_FORMAT_RGB + 1);
    tcase_add_loop_test(tc, the_mean_level_is_kept, 0, 3);
    tcase_add_test(tc, affine_maps_that_are_no_similarities_are_followed_too);
    tcase_add_loop_test(tc, chroma_stays_where_the_luma_is, 0, 3);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
