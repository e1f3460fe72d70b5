/* SPDX-License-Identifier: MIT */
/* The rolling shutter of the synthetic clips: each row equals that row of a picture that a camera with a global shutter
 * takes at the row's time. */
#include <string.h>

#include "checkx.h"
#include "synth.h"

enum { WIDTH = 256, HEIGHT = 144 };

static SynthConfig shaking_config(void)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.pan_x = 12.0, cfg.turn = 0.01;
    cfg.vibration = 3.0, cfg.vibration_roll = 0.01, cfg.vibration_hz = 20.0;
    cfg.readout = 0.03;
    return cfg;
}

START_TEST(each_row_is_seen_from_where_the_camera_is_at_its_time)
{
    const SynthConfig cfg = shaking_config();
    Synth *s = synth_new(&cfg);
    SynthPicture frame = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
    SynthPicture view = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
    synth_render(s, 4, frame.format, frame.data, frame.stride);
    for (int plane = 0; plane < 2; plane++) {
        const int pixels = plane ? 2 : 1; /* that a row is high */
        for (int j = 0; j < frame.rows[plane]; j += 7) {
            double M[9];
            const size_t at = (size_t)(j * frame.stride[plane]), size = (size_t)frame.stride[plane];
            synth_camera_at(s, 4.0 + 0.03 * 30.0 * ((j + 0.5) * pixels / HEIGHT - 0.5), M);
            synth_render_view(s, M, WIDTH, HEIGHT, view.format, view.data, view.stride);
            ck_assert_mem_eq(frame.data[plane] + at, view.data[plane] + at, size);
            synth_camera(s, 4, M); /* a global shutter gives another picture */
            synth_render_view(s, M, WIDTH, HEIGHT, view.format, view.data, view.stride);
            if (abs(j * pixels - HEIGHT / 2) > 8)
                ck_assert_mem_ne(frame.data[plane] + at, view.data[plane] + at, size);
        }
    }
    synth_picture_free(&frame);
    synth_picture_free(&view);
    synth_free(s);
}
END_TEST

START_TEST(the_last_row_of_a_long_readout_is_close_to_the_first_of_the_next_frame)
{
    SynthConfig cfg = shaking_config();
    cfg.readout = 1.0 / cfg.fps;
    Synth *s = synth_new(&cfg);
    ck_assert_near(synth_row_time(s, 7, -HEIGHT / 2.0), 6.5, 1e-12);
    ck_assert_near(synth_row_time(s, 7, 0.0), 7.0, 1e-12);
    ck_assert_near(synth_row_time(s, 7, HEIGHT / 2.0), synth_row_time(s, 8, -HEIGHT / 2.0), 1e-12);
    synth_free(s);
}
END_TEST

/* The amplitude of one frequency in the camera's motion: its Fourier coefficient over ten seconds. */
static void measure_tone(const Synth *s, double hz, double amplitude[3])
{
    enum { SAMPLES = 3000 };
    double sum[3][2] = {{0.0}};
    for (int i = 0; i < SAMPLES; i++) {
        const double seconds = 10.0 * i / SAMPLES, phase = 6.283185307179586 * hz * seconds;
        double M[9];
        synth_camera_at(s, 30.0 * seconds, M);
        const double value[3] = {M[2], M[5], atan2(M[3], M[0])};
        for (int k = 0; k < 3; k++) {
            sum[k][0] += value[k] * cos(phase) * 2.0 / SAMPLES;
            sum[k][1] += value[k] * sin(phase) * 2.0 / SAMPLES;
        }
    }
    for (int k = 0; k < 3; k++)
        amplitude[k] = hypot(sum[k][0], sum[k][1]);
}

START_TEST(the_vibration_has_the_frequency_and_amplitude_that_were_asked_for)
{
    static const double hz[] = {5.0, 10.0, 20.0, 30.0};
    SynthConfig cfg = synth_defaults();
    cfg.shake = cfg.roll = 0.0;
    cfg.vibration = 3.0, cfg.vibration_roll = 0.01, cfg.vibration_hz = hz[_i];
    Synth *s = synth_new(&cfg);
    for (double f = 5.0; f <= 30.0; f += 5.0) {
        double amplitude[3];
        measure_tone(s, f, amplitude);
        ck_assert_near(amplitude[0], f == hz[_i] ? 3.0 : 0.0, 1e-9);
        ck_assert_near(amplitude[1], f == hz[_i] ? 3.0 : 0.0, 1e-9);
        ck_assert_near(amplitude[2], f == hz[_i] ? 0.01 : 0.0, 1e-9);
    }
    synth_free(s);
}
END_TEST

START_TEST(without_readout_or_motion_the_shutter_does_not_show)
{
    SynthConfig cfg = shaking_config();
    SynthPicture p[2];
    for (int i = 0; i < 2; i++) {
        cfg.readout = i ? 0.033 : 0.0;
        cfg.shake = cfg.roll = cfg.pan_x = cfg.turn = cfg.vibration = cfg.vibration_roll = 0.0;
        Synth *s = synth_new(&cfg);
        p[i] = synth_picture_new(L1L2STAB_FORMAT_NV12, WIDTH, HEIGHT);
        synth_render(s, 3, p[i].format, p[i].data, p[i].stride);
        synth_free(s);
    }
    ck_assert_mem_eq(p[0].data[0], p[1].data[0], p[0].size);
    synth_picture_free(&p[0]);
    synth_picture_free(&p[1]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth_shutter");
    TCase *tc = tcase_create("synth_shutter");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, each_row_is_seen_from_where_the_camera_is_at_its_time);
    tcase_add_test(tc, the_last_row_of_a_long_readout_is_close_to_the_first_of_the_next_frame);
    tcase_add_loop_test(tc, the_vibration_has_the_frequency_and_amplitude_that_were_asked_for, 0, 4);
    tcase_add_test(tc, without_readout_or_motion_the_shutter_does_not_show);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
