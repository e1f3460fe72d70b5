/* SPDX-License-Identifier: MIT */
/* Pixels that are not square: the same film, squeezed sideways, has the same motion and is stabilized as well. */
#include <math.h>
#include <string.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "common/geom.h"
#include "image/area_scale.h"
#include "synth.h"

enum { SHOWN_WIDTH = 640, HEIGHT = 360, FRAMES = 16 };

static const struct {
    int width;
    double aspect;
} films[] = {{640, 1.0}, {450, 64.0 / 45.0}, {320, 2.0}};

enum { FILMS = sizeof films / sizeof *films };

/* A film that rolls, as frames of `width` samples a row. Returns the error of F: rms over frames and corners, px. */
static double stabilize(int width, double aspect, L1L2StabRollingShutter shutter, L1L2StabInfo *info)
{
    static uint8_t shown[SHOWN_WIDTH * HEIGHT], frames[FRAMES][SHOWN_WIDTH * HEIGHT], out[SHOWN_WIDTH * HEIGHT];
    SynthConfig film = synth_defaults();
    film.roll = 0.02;
    Synth *synth = synth_new(&film);
    L1L2StabConfig cfg;
    L1L2Stab *s;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = width, cfg.height = HEIGHT;
    cfg.pixel_aspect = aspect;
    cfg.crop_ratio = 0.8;
    cfg.window = FRAMES;
    cfg.threads = 1;
    cfg.analysis_size = 320; /* each film keeps the same number of samples */
    cfg.rolling_shutter = shutter;
    ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_OK);
    L1L2AreaScaler *squeeze = l1l2_image_scale_new(l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), SHOWN_WIDTH, HEIGHT,
                                                   width, HEIGHT);
    ck_assert_ptr_nonnull(squeeze);
    for (int t = 0; t < FRAMES; t++) {
        synth_render_gray(synth, t, shown, SHOWN_WIDTH);
        l1l2_image_scale_run(squeeze, shown, SHOWN_WIDTH, frames[t], width);
        const L1L2StabFrame in = {.data = {frames[t]}, .stride = {width}};
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    }
    l1l2stab_finish(s);
    double sum = 0.0;
    for (int t = 0; t < FRAMES; t++) {
        L1L2StabFrame picture = {.data = {out}, .stride = {width}};
        L1L2Mat F, truth;
        ck_assert_int_eq(l1l2stab_pull(s, &picture, &info[t]), L1L2STAB_OK);
        if (t == 0)
            continue;
        ck_assert_int_eq(info[t].model, L1L2STAB_MOTION_SOURCE_SIMILARITY);
        memcpy(F.m, info[t].F, sizeof F.m);
        synth_motion(synth, t, truth.m);
        const double error = l1l2_mat_corner_distance(&F, &truth, 0.5 * SHOWN_WIDTH, 0.5 * HEIGHT);
        sum += error * error / (FRAMES - 1);
    }
    l1l2_image_scale_free(squeeze);
    l1l2stab_free(&s);
    synth_free(synth);
    return sqrt(sum);
}

START_TEST(a_squeezed_film_has_the_same_motion)
{
    static L1L2StabInfo info[FRAMES];
    const double square = stabilize(films[0].width, films[0].aspect, L1L2STAB_ROLLING_SHUTTER_NONE, info);
    for (int k = 1; k < FILMS; k++) {
        const double squeezed = stabilize(films[k].width, films[k].aspect, L1L2STAB_ROLLING_SHUTTER_NONE, info);
        ck_assert_double_le(squeezed, 1.3 * square);
    }
}
END_TEST

/* If the library does not know that the film is squeezed, a roll is not a similarity. */
START_TEST(without_the_aspect_a_roll_is_measured_worse)
{
    static L1L2StabInfo info[FRAMES];
    static const L1L2StabRollingShutter none = L1L2STAB_ROLLING_SHUTTER_NONE;
    const double square = stabilize(films[2].width, 2.0, none, info);
    ck_assert_double_gt(stabilize(films[2].width, 1.0, none, info), 5.0 * square);
}
END_TEST

/* The loop test's index is the film's. */
START_TEST(the_rendered_picture_is_a_similarity_as_shown_and_inside_the_source)
{
    static L1L2StabInfo info[FRAMES];
    const double width = films[_i].width, aspect = films[_i].aspect;
    double turned = 0.0;
    stabilize(films[_i].width, aspect, L1L2STAB_ROLLING_SHUTTER_MIXTURE, info);
    for (int t = 0; t < FRAMES; t++) {
        const double *m = info[t].warp;
        ck_assert_double_le(fabs(m[0] - m[4]), 1e-12);
        ck_assert_double_le(fabs(m[3] + aspect * aspect * m[1]), 1e-12);
        ck_assert_double_le(fabs(m[2] - info[t].B[2] / aspect), 1e-9);
        ck_assert_double_le(fabs(m[5] - info[t].B[5]), 1e-9);
        turned = fmax(turned, fabs(m[1]));
        for (int k = 0; k < 4; k++) {
            const double x = (k & 1 ? 0.5 : -0.5) * width, y = (k & 2 ? 0.5 : -0.5) * HEIGHT;
            ck_assert_double_le(fabs(m[0] * x + m[1] * y + m[2]), 0.5 * width + 1e-6);
            ck_assert_double_le(fabs(m[3] * x + m[4] * y + m[5]), 0.5 * HEIGHT + 1e-6);
        }
    }
    ck_assert_double_gt(turned, 1e-3);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pixel aspect");
    TCase *tc = tcase_create("films");
    tcase_add_test(tc, a_squeezed_film_has_the_same_motion);
    tcase_add_test(tc, without_the_aspect_a_roll_is_measured_worse);
    tcase_add_loop_test(tc, the_rendered_picture_is_a_similarity_as_shown_and_inside_the_source, 0, FILMS);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
