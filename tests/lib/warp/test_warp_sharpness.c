/* SPDX-License-Identifier: MIT */
/* A slow pan must look smooth: sharpness does not pulse, and motion has no steps. */
#include "warp/coords.h"
#include "warp/warp_fixture.h"
#include "warp/warp_tables.h"

enum { FRAMES = 41 };
static const double PAN_PX = 0.05;

/* Noise with about the detail of a picture: every sample is the mean of 2x2 random levels. */
static void draw_texture(Picture *p)
{
    picture_randomize(p, 3);
    for (int v = 0; v < p->height - 1; v++)
        for (int u = 0; u < p->width - 1; u++)
            *sample(p, 0, u, v) = (uint8_t)((*sample(p, 0, u, v) + *sample(p, 0, u + 1, v) +
                                             *sample(p, 0, u, v + 1) + *sample(p, 0, u + 1, v + 1) + 2) / 4);
}

/* Mean of the squared differences to the right and below. */
static double gradient_energy(const Picture *p)
{
    double sum = 0.0;
    for (int v = 0; v < p->height - 1; v++)
        for (int u = 0; u < p->width - 1; u++) {
            const int dx = *sample(p, 0, u + 1, v) - *sample(p, 0, u, v);
            const int dy = *sample(p, 0, u, v + 1) - *sample(p, 0, u, v);
            sum += dx * dx + dy * dy;
        }
    return sum / ((p->width - 1) * (p->height - 1));
}

/* The change of the gradient energy over the pan, divided by its maximum. */
static double pulse(L1L2StabInterpolation interpolation, double zoom)
{
    Picture src = picture_new(L1L2STAB_FORMAT_GRAY8, 480, 360), dst = picture_new(L1L2STAB_FORMAT_GRAY8, 400, 300);
    L1L2WarpConfig cfg = warp_config(&src, &dst);
    cfg.interpolation = interpolation;
    draw_texture(&src);
    double least = INFINITY, most = 0.0;
    for (int t = 0; t < FRAMES; t++) {
        const L1L2Mat map = {{zoom, 0, PAN_PX * t, 0, zoom, PAN_PX * t, 0, 0, 1}};
        warp_picture(&cfg, &map, &src, &dst);
        const double energy = gradient_energy(&dst);
        least = fmin(least, energy);
        most = fmax(most, energy);
    }
    picture_free(&src);
    picture_free(&dst);
    return (most - least) / most;
}

/* The loop tests' index is the interpolation. A crop that is zoomed to fill the frame has all phases in every frame. */
START_TEST(sharpness_does_not_pulse_when_the_crop_fills_the_frame)
{
    ck_assert_double_le(pulse((L1L2StabInterpolation)_i, 0.9), 0.02);
}
END_TEST

/* Without zoom a frame has one phase, and a kernel that blurs some phases shows. This is why bicubic is the default. */
START_TEST(without_zoom_the_default_pulses_far_less_than_bilinear)
{
    ck_assert_double_le(pulse(L1L2STAB_INTERPOLATION_BICUBIC, 1.0), 0.5 * pulse(L1L2STAB_INTERPOLATION_BILINEAR, 1.0));
}
END_TEST

/* 0.05 px are 51.2 phases: every sample of every frame must move by 51 or 52. */
START_TEST(a_slow_pan_moves_without_steps)
{
    enum { COUNT = 200 };
    int32_t x[COUNT + L1L2_WARP_RUN_SLACK], y[COUNT + L1L2_WARP_RUN_SLACK], last[COUNT];
    const double step = PAN_PX * L1L2_WARP_PHASES;
    for (int t = 0; t < 100; t++) {
        const L1L2WarpAffine affine = {{0.9, 0.0, PAN_PX * t}, {0.0, 0.9, 0.0}};
        fast_functions().generators.affine(&affine, 0, 7, COUNT, x, y);
        for (int u = 0; t > 0 && u < COUNT; u++)
            if (fabs(x[u] - last[u] - step) >= 1.0)
                ck_abort_msg("frame %d, sample %d moved by %d phases", t, u, x[u] - last[u]);
        memcpy(last, x, sizeof last);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("warp, sharpness");
    TCase *tc = tcase_create("sharpness");
    tcase_add_loop_test(tc, sharpness_does_not_pulse_when_the_crop_fills_the_frame, 0, 3);
    tcase_add_test(tc, without_zoom_the_default_pulses_far_less_than_bilinear);
    tcase_add_test(tc, a_slow_pan_moves_without_steps);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
