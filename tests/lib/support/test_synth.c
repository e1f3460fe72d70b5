/* SPDX-License-Identifier: MIT */
/* The synthetic clips move as their configs say. Other tests rely on that. */
#include <string.h>

#include "checkx.h"
#include "synth.h"

static double sample(const SynthPicture *p, double x, double y)
{
    const int i = (int)floor(x), j = (int)floor(y);
    const double fx = x - i, fy = y - j;
    const uint8_t *row = p->data[0] + p->stride[0] * j + i, *below = row + p->stride[0];
    return (1.0 - fy) * ((1.0 - fx) * row[0] + fx * row[1]) + fy * ((1.0 - fx) * below[0] + fx * below[1]);
}

/* The mean difference between frame t and frame t-1 looked up where F says. */
static double difference(const Synth *s, int t, const double F[9])
{
    SynthPicture now = synth_picture_new(L1L2STAB_FORMAT_GRAY8, 320, 200);
    SynthPicture before = synth_picture_new(L1L2STAB_FORMAT_GRAY8, 320, 200);
    synth_render_gray(s, t, now.data[0], now.stride[0]);
    synth_render_gray(s, t - 1, before.data[0], before.stride[0]);
    double sum = 0.0;
    int count = 0;
    for (int j = 40; j < 160; j++)
        for (int i = 40; i < 280; i++, count++) {
            const double x = i + 0.5 - 160.0, y = j + 0.5 - 100.0;
            const double u = F[0] * x + F[1] * y + F[2] + 160.0 - 0.5, v = F[3] * x + F[4] * y + F[5] + 100.0 - 0.5;
            sum += fabs(sample(&before, u, v) - now.data[0][now.stride[0] * j + i]);
        }
    synth_picture_free(&now);
    synth_picture_free(&before);
    return sum / count;
}

static SynthConfig small_config(void)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 320, cfg.height = 200;
    cfg.roll = 0.02, cfg.zoom = 0.02, cfg.pan_x = 2.0, cfg.pan_y = -1.0;
    return cfg;
}

START_TEST(a_frame_is_the_one_before_moved_by_the_true_motion)
{
    const SynthConfig cfg = small_config();
    Synth *s = synth_new(&cfg);
    for (int t = 1; t < 500; t += 71) {
        double F[9];
        synth_motion(s, t, F);
        const double right = difference(s, t, F);
        ck_assert_double_le(right, 1.5); /* gray levels: what bilinear sampling costs */
        F[2] += 0.5;
        ck_assert_double_ge(difference(s, t, F), 1.5 * right);
        F[2] -= 0.5, F[1] -= 0.01, F[3] += 0.01;
        ck_assert_double_ge(difference(s, t, F), 1.5 * right);
    }
    synth_free(s);
}
END_TEST

START_TEST(the_motions_add_up_to_the_camera)
{
    const SynthConfig cfg = small_config();
    Synth *s = synth_new(&cfg);
    double M[9], C[9];
    synth_camera(s, 0, C);
    for (int t = 1; t <= 50; t++) { /* M_t = M_0 F_1 ... F_t */
        double F[9], next[9];
        synth_motion(s, t, F);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                next[3 * i + j] = C[3 * i] * F[j] + C[3 * i + 1] * F[3 + j] + C[3 * i + 2] * F[6 + j];
        memcpy(C, next, sizeof C);
    }
    synth_camera(s, 50, M);
    for (int i = 0; i < 9; i++)
        ck_assert_near(C[i], M[i], 1e-9);
    synth_free(s);
}
END_TEST

START_TEST(the_shake_has_the_strength_that_was_asked_for)
{
    SynthConfig cfg = small_config();
    cfg.pan_x = 0.0;
    cfg.shake = 7.0;
    Synth *s = synth_new(&cfg);
    double x = 0.0, roll = 0.0, M[9];
    for (int t = 0; t < 3000; t++) {
        synth_camera(s, t, M);
        x += M[2] * M[2] / 3000.0;
        roll += pow(atan2(M[3], M[0]), 2.0) / 3000.0;
    }
    ck_assert_near(sqrt(x), 7.0, 0.35);
    ck_assert_near(sqrt(roll), 0.02, 0.001);
    synth_free(s);
}
END_TEST

START_TEST(all_planar_formats_show_the_same_and_packed_ones_its_gray)
{
    SynthConfig cfg = small_config();
    cfg.width = 321, cfg.height = 201;
    cfg.noise = 3.0, cfg.foreground = 0.2;
    Synth *s = synth_new(&cfg);
    SynthPicture gray = synth_picture_new(L1L2STAB_FORMAT_GRAY8, cfg.width, cfg.height);
    synth_render_gray(s, 5, gray.data[0], gray.stride[0]);
    for (int format = L1L2STAB_FORMAT_I420; format <= L1L2STAB_FORMAT_RGB; format++) {
        SynthPicture p = synth_picture_new((L1L2StabFormat)format, cfg.width, cfg.height);
        synth_render(s, 5, p.format, p.data, p.stride);
        if (format < L1L2STAB_FORMAT_BGRX) {
            ck_assert_mem_eq(p.data[0], gray.data[0], gray.size);
        } else {
            const int bytes = (int)(p.stride[0] / cfg.width);
            const int red = format == L1L2STAB_FORMAT_RGBX || format == L1L2STAB_FORMAT_RGBA ||
                            format == L1L2STAB_FORMAT_RGB ? 0 : 2;
            double off = 0.0;
            for (size_t i = 0; i < gray.size; i++) {
                const uint8_t *v = p.data[0] + i * (size_t)bytes;
                off += fabs(0.299 * v[red] + 0.587 * v[1] + 0.114 * v[2 - red] - gray.data[0][i]) / (double)gray.size;
            }
            ck_assert_double_le(off, 1.0);
        }
        synth_picture_free(&p);
    }
    synth_picture_free(&gray);
    synth_free(s);
}
END_TEST

START_TEST(equal_configs_give_equal_bytes_and_other_seeds_other_ones)
{
    SynthConfig cfg = small_config();
    cfg.noise = 3.0;
    SynthPicture p[3];
    for (int i = 0; i < 3; i++) {
        cfg.seed = i < 2 ? 1 : 2;
        Synth *s = synth_new(&cfg);
        p[i] = synth_picture_new(L1L2STAB_FORMAT_I420, cfg.width, cfg.height);
        synth_render(s, 9, p[i].format, p[i].data, p[i].stride);
        synth_free(s);
    }
    ck_assert_mem_eq(p[0].data[0], p[1].data[0], p[0].size);
    ck_assert_mem_ne(p[0].data[0], p[2].data[0], p[0].size);
    for (int i = 0; i < 3; i++)
        synth_picture_free(&p[i]);
}
END_TEST

START_TEST(a_view_through_the_camera_is_the_frame)
{
    const SynthConfig cfg = small_config();
    Synth *s = synth_new(&cfg);
    SynthPicture frame = synth_picture_new(L1L2STAB_FORMAT_NV12, cfg.width, cfg.height);
    SynthPicture view = synth_picture_new(L1L2STAB_FORMAT_NV12, cfg.width, cfg.height);
    double M[9];
    synth_camera(s, 12, M);
    synth_render(s, 12, frame.format, frame.data, frame.stride);
    synth_render_view(s, M, cfg.width, cfg.height, view.format, view.data, view.stride);
    ck_assert_mem_eq(frame.data[0], view.data[0], frame.size);
    synth_picture_free(&frame);
    synth_picture_free(&view);
    synth_free(s);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth");
    TCase *tc = tcase_create("synth");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, a_frame_is_the_one_before_moved_by_the_true_motion);
    tcase_add_test(tc, the_motions_add_up_to_the_camera);
    tcase_add_test(tc, the_shake_has_the_strength_that_was_asked_for);
    tcase_add_test(tc, all_planar_formats_show_the_same_and_packed_ones_its_gray);
    tcase_add_test(tc, equal_configs_give_equal_bytes_and_other_seeds_other_ones);
    tcase_add_test(tc, a_view_through_the_camera_is_the_frame);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
