/* SPDX-License-Identifier: MIT */
/* The same clip in other formats has the same motion: only its gray picture is tracked. */
#include "common/rng.h"
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
            const uint32_t level = format->grey[k % components] > 0.0
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

int main(void)
{
    Suite *suite = suite_create("motion by format");
    TCase *tc = tcase_create("formats");
    tcase_add_loop_test(tc, the_same_clip_in_another_format_has_the_same_motion, 0, FORMATS);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
