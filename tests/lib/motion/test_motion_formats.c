/* SPDX-License-Identifier: MIT */
/* The same clip in other formats has the same motion: only its gray picture is tracked, stretched to its levels. */
#include "common/rng.h"
#include "formats.h"
#include "motion/motion_fixture.h"

/* All layouts of the gray picture in a first plane. */
static const L1L2StabFormat formats[] = {
    L1L2STAB_FORMAT_I420_10LE, L1L2STAB_FORMAT_I420_12LE, L1L2STAB_FORMAT_P010_10LE, L1L2STAB_FORMAT_P016_LE,
    L1L2STAB_FORMAT_GRAY16_LE, L1L2STAB_FORMAT_GBR,       L1L2STAB_FORMAT_YUY2,      L1L2STAB_FORMAT_UYVY,
    L1L2STAB_FORMAT_AYUV,      L1L2STAB_FORMAT_VUYA,      L1L2STAB_FORMAT_XRGB,      L1L2STAB_FORMAT_ABGR,
    L1L2STAB_FORMAT_ARGB64_LE, L1L2STAB_FORMAT_BGRA64_LE, L1L2STAB_FORMAT_AYUV64,
};

enum { FORMATS = sizeof formats / sizeof formats[0] };

/* The gray picture as the first plane of a format, with random bits below its 8 and noise in components that are no
 * part of gray. */
static void fill_plane(const SynthPicture *gray, const L1L2FormatInfo *format, uint8_t *plane, ptrdiff_t stride,
                       L1L2Rng *rng)
{
    const int components = l1l2_image_format_pixel_components(format), bytes = l1l2_image_format_bytes(format);
    for (int y = 0; y < gray->height; y++)
        for (int k = 0; k < gray->width * components; k++) {
            const uint32_t level = format->gray[k % components] > 0.0
                                       ? gray->data[0][y * gray->stride[0] + k / components]
                                       : l1l2_rng_below(rng, 256);
            const uint32_t deep = level << (format->depth - 8) | l1l2_rng_below(rng, 1u << (format->depth - 8));
            plane[y * stride + k * bytes] = (uint8_t)(deep << format->shift);
            if (bytes == 2)
                plane[y * stride + k * bytes + 1] = (uint8_t)(deep << format->shift >> 8);
        }
}

/* The loop test's index is the format's. */
START_TEST(the_same_clip_in_another_format_has_the_same_motion)
{
    if (format_left_out(formats[_i]))
        return;
    const L1L2FormatInfo *format = l1l2_image_format_info(formats[_i]);
    const SynthConfig cfg = synth_defaults();
    const ptrdiff_t stride =
        (ptrdiff_t)cfg.width * l1l2_image_format_pixel_components(format) * l1l2_image_format_bytes(format);
    uint8_t *plane = malloc((size_t)stride * (size_t)cfg.height);
    ck_assert_ptr_nonnull(plane);
    L1L2Rng rng = l1l2_rng_seeded(1);
    Run run = run_new(&cfg);
    L1L2Motion *motion = motion_new(cfg.width, cfg.height, formats[_i]);
    double worst = 0.0, moved = 0.0;
    for (int t = 0; t < 12; t++) {
        const L1L2Mat still = l1l2_mat_identity();
        L1L2MotionResult other;
        const L1L2MotionResult gray = push_frame(&run, t);
        fill_plane(&run.picture, format, plane, stride, &rng);
        ck_assert_int_eq(l1l2_motion_push(motion, plane, stride, t == 0, &other), L1L2STAB_OK);
        const L1L2Mat a = in_pixels(&run, &gray.F), b = in_pixels(&run, &other.F);
        worst = fmax(worst, corner_rms(&a, &b, &cfg));
        moved = fmax(moved, corner_rms(&a, &still, &cfg));
    }
    ck_assert_double_ge(moved, 1.0);
    ck_assert_double_le(worst, 0.05);
    l1l2_motion_free(motion);
    run_free(&run);
    free(plane);
}
END_TEST

/* Raw counts of 16 bits: the clip's levels span `span` counts, and all counts rise by `drift` a frame. */
typedef struct Counts {
    int low, span, drift;
    double noise; /* largest, counts */
} Counts;

static L1L2MotionResult push_counts(Run *run, L1L2Motion *motion, const Counts *counts, int t, L1L2Rng *rng)
{
    static uint16_t plane[1280 * 720];
    const int width = run->cfg.width, height = run->cfg.height;
    L1L2MotionResult result;
    synth_render_gray(run->synth, t, run->picture.data[0], run->picture.stride[0]);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const double level = run->picture.data[0][y * run->picture.stride[0] + x] / 255.0;
            const double noise = counts->noise * (2.0 * l1l2_rng_below(rng, 10001) / 10000.0 - 1.0);
            plane[y * width + x] = (uint16_t)(counts->low + counts->drift * t + counts->span * level + noise + 0.5);
        }
    ck_assert_int_eq(
        l1l2_motion_push(motion, (const uint8_t *)plane, (ptrdiff_t)2 * width, t == 0, &result), L1L2STAB_OK);
    return result;
}

/* The error of the motion, px, rms over frames that are all measured. */
static double error_of_counts(Counts counts)
{
    const SynthConfig cfg = synth_defaults();
    Run run = run_new(&cfg);
    L1L2Motion *motion = motion_new(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY16_LE);
    L1L2Rng rng = l1l2_rng_seeded(1);
    double sum = 0.0;
    const int frames = 12;
    for (int t = 0; t < frames; t++) {
        const L1L2MotionResult r = push_counts(&run, motion, &counts, t, &rng);
        if (t == 0)
            continue;
        ck_assert_int_eq(r.model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
        sum += error_at(&run, &r, t) * error_at(&run, &r, t) / (frames - 1);
    }
    l1l2_motion_free(motion);
    run_free(&run);
    return sqrt(sum);
}

static const Counts clips[] = {{7000, 16383, 0, 0.0}, {7000, 4000, 0, 0.0}, {7000, 800, 0, 0.0},
                               {7000, 200, 0, 0.0},   {7000, 800, 0, 10.0}, {7000, 200, 0, 4.0},
                               {7000, 800, 90, 0.0},  {60000, 800, -40, 0.0}};

/* The loop test's index is the clip's. */
START_TEST(raw_counts_are_measured_however_few_levels_they_span)
{
    if (format_left_out(L1L2STAB_FORMAT_GRAY16_LE))
        return;
    const double full = error_of_counts((Counts){0, 65535, 0, 0.0});
    ck_assert_double_le(error_of_counts(clips[_i]), 1.5 * full + 0.005);
}
END_TEST

START_TEST(noise_without_a_scene_is_no_motion)
{
    const SynthConfig cfg = synth_defaults();
    const L1L2Mat still = l1l2_mat_identity();
    if (format_left_out(L1L2STAB_FORMAT_GRAY16_LE))
        return;
    for (double noise = 5.0; noise <= 80.0; noise *= 4.0) {
        Run run = run_new(&cfg);
        L1L2Motion *motion = motion_new(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY16_LE);
        L1L2Rng rng = l1l2_rng_seeded(1);
        for (int t = 0; t < 6; t++) {
            const L1L2MotionResult r = push_counts(&run, motion, &(Counts){7000, 0, 0, noise}, t, &rng);
            ck_assert_double_le(corner_rms(&r.F, &still, &cfg), 1e-12);
        }
        l1l2_motion_free(motion);
        run_free(&run);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion by format");
    TCase *tc = tcase_create("formats");
    tcase_add_loop_test(tc, the_same_clip_in_another_format_has_the_same_motion, 0, FORMATS);
    tcase_add_loop_test(tc, raw_counts_are_measured_however_few_levels_they_span, 0, sizeof clips / sizeof *clips);
    tcase_add_test(tc, noise_without_a_scene_is_no_motion);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
