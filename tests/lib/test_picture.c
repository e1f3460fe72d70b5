/* SPDX-License-Identifier: MIT */
/* What a viewer sees: the remaining shake compared with the truth, and the rendered picture compared with that of an
 * ideal camera. */
#include <pthread.h>

#include "stabilizer_fixture.h"

/* RMS of the second difference of the crop window's corner path, px: of the truth, as filmed and as emitted. */
static void true_jitter(const L1L2StabInfo *info, int frames, double *before, double *after)
{
    Synth *synth = the_scene();
    const double hw = WIDTH / 2.0, hh = HEIGHT / 2.0;
    double sum[2] = {0, 0}, last[2][8] = {{0}};
    for (int t = 1; t < frames; t++) {
        double F[9];
        synth_motion(synth, t, F);
        L1L2Mat inverse;
        l1l2_mat_inverse(mat_of(info[t - 1].B), &inverse);
        const L1L2Mat step[2] = {mat_of(F), l1l2_mat_mul(l1l2_mat_mul(inverse, mat_of(F)), mat_of(info[t].B))};
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 4; k++) {
                const L1L2Point u = {k & 1 ? hw : -hw, k & 2 ? hh : -hh}, p = l1l2_mat_apply(&step[i], u);
                const double v[2] = {p.x - u.x, p.y - u.y};
                for (int a = 0; a < 2; a++) {
                    if (t > 1)
                        sum[i] += (v[a] - last[i][2 * k + a]) * (v[a] - last[i][2 * k + a]);
                    last[i][2 * k + a] = v[a];
                }
            }
    }
    *before = sqrt(sum[0] / (4.0 * (frames - 2)));
    *after = sqrt(sum[1] / (4.0 * (frames - 2)));
}

START_TEST(the_true_shake_falls_to_a_tenth)
{
    L1L2StabConfig cfg = small_config(60);
    L1L2StabInfo info[120];
    Clip *clip = new_clip(120, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, info, NULL), 120);
    double before, after;
    true_jitter(info, 120, &before, &after);
    ck_assert_msg(after < 0.1 * before, "shake %g px before, %g px after", before, after);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

/* The rendered picture against what a camera on the smoothed path would have filmed. */
START_TEST(the_picture_is_what_a_steady_camera_would_have_filmed)
{
    L1L2StabConfig cfg = small_config(30);
    L1L2StabInfo info[40];
    SynthPicture out[40];
    Clip *clip = new_clip(40, cfg.format);
    L1L2Stab *s = create(&cfg);
    for (int t = 0; t < 40; t++)
        out[t] = synth_picture_new(cfg.format, WIDTH, HEIGHT);
    ck_assert_int_eq(stabilize(s, clip, info, out), 40);
    Synth *synth = the_scene();
    SynthPicture ideal = synth_picture_new(cfg.format, WIDTH, HEIGHT);
    for (int t = 0; t < 40; t += 3) {
        double M[9], error = 0.0;
        synth_camera(synth, t, M);
        const L1L2Mat view = l1l2_mat_mul(mat_of(M), mat_of(info[t].warp));
        synth_render_view(synth, view.m, WIDTH, HEIGHT, cfg.format, ideal.data, ideal.stride);
        for (int y = 4; y < HEIGHT - 4; y++)
            for (int x = 4; x < WIDTH - 4; x++) {
                const double d = out[t].data[0][y * out[t].stride[0] + x] - ideal.data[0][y * ideal.stride[0] + x];
                error += d * d / ((WIDTH - 8) * (HEIGHT - 8));
            }
        ck_assert_msg(error < 65025.0 / pow(10, 3.2), "frame %d: PSNR %.1f dB", t, 10 * log10(65025.0 / error));
    }
    for (int t = 0; t < 40; t++)
        synth_picture_free(&out[t]);
    synth_picture_free(&ideal);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(the_number_of_threads_changes_no_bit)
{
    SynthPicture out[2][20];
    for (int run = 0; run < 2; run++) {
        L1L2StabConfig cfg = small_config(10);
        cfg.threads = run == 0 ? 1 : 7;
        Clip *clip = new_clip(20, cfg.format);
        L1L2Stab *s = create(&cfg);
        for (int t = 0; t < 20; t++)
            out[run][t] = synth_picture_new(cfg.format, WIDTH, HEIGHT);
        ck_assert_int_eq(stabilize(s, clip, NULL, out[run]), 20);
        l1l2stab_free(&s);
        free_clip(clip);
    }
    for (int t = 0; t < 20; t++) {
        ck_assert_mem_eq(out[0][t].data[0], out[1][t].data[0], out[0][t].size);
        synth_picture_free(&out[0][t]);
        synth_picture_free(&out[1][t]);
    }
}
END_TEST

typedef struct Listener {
    pthread_t caller;
    int heard, elsewhere;
} Listener;

static void listen_to(void *cookie, L1L2StabLogLevel level, const char *message)
{
    Listener *listener = cookie;
    listener->heard++;
    listener->elsewhere += !pthread_equal(pthread_self(), listener->caller);
}

/* Gray frames: the tracking logs, from its own thread, that the motion is lost. */
START_TEST(messages_come_on_the_callers_thread)
{
    Listener listener = {.caller = pthread_self()};
    L1L2StabConfig cfg = small_config(8);
    cfg.threads = 3;
    cfg.logger = (L1L2StabLogger){listen_to, &listener, L1L2STAB_LOG_TRACE};
    Clip *clip = new_clip(12, cfg.format);
    for (int t = 4; t < 12; t++)
        memset(clip->picture[t].data[0], 128, clip->picture[t].size);
    L1L2Stab *s = create(&cfg);
    const int before = listener.heard;
    ck_assert_int_eq(stabilize(s, clip, NULL, NULL), 12);
    ck_assert_int_gt(listener.heard, before);
    ck_assert_int_eq(listener.elsewhere, 0);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

/* reset and free wait for a frame that is being read. */
START_TEST(a_frame_is_released_only_when_nobody_reads_it_any_more)
{
    L1L2StabConfig cfg = small_config(8);
    cfg.threads = 3;
    Clip *clip = new_clip(8, cfg.format);
    L1L2Stab *s = create(&cfg);
    for (int round = 0; round < 40; round++) {
        const int t = round % 8;
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (round % 2) {
            l1l2stab_reset(s);
        } else {
            l1l2stab_free(&s);
            s = create(&cfg);
        }
        ck_assert_int_eq(clip->released[t], round / 8 + 1);
        /* a thread sanitizer reports if the frame is still being read */
        memset(clip->picture[t].data[0], round, clip->picture[t].size);
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(every_format_is_stabilized_alike)
{
    L1L2StabInfo reference[12], info[12];
    for (int format = L1L2STAB_FORMAT_GRAY8; format <= L1L2STAB_FORMAT_RGB; format++) {
        L1L2StabConfig cfg = small_config(8);
        cfg.format = (L1L2StabFormat)format;
        SynthPicture out[12];
        Clip *clip = new_clip(12, cfg.format);
        for (int t = 0; t < 12; t++)
            out[t] = synth_picture_new(cfg.format, WIDTH, HEIGHT);
        L1L2Stab *s = create(&cfg);
        ck_assert_int_eq(stabilize(s, clip, info, out), 12);
        l1l2stab_free(&s);
        if (format == L1L2STAB_FORMAT_GRAY8)
            memcpy(reference, info, sizeof info);
        for (int t = 0; t < 12; t++) {
            const L1L2Mat a = mat_of(reference[t].B), b = mat_of(info[t].B);
            ck_assert_near(l1l2_mat_corner_distance(&a, &b, 64, 38), 0.0, 0.25);
            synth_picture_free(&out[t]);
        }
        free_clip(clip);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("picture");
    TCase *tcase = tcase_create("picture");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_true_shake_falls_to_a_tenth);
    tcase_add_test(tcase, the_picture_is_what_a_steady_camera_would_have_filmed);
    tcase_add_test(tcase, the_number_of_threads_changes_no_bit);
    tcase_add_test(tcase, messages_come_on_the_callers_thread);
    tcase_add_test(tcase, a_frame_is_released_only_when_nobody_reads_it_any_more);
    tcase_add_test(tcase, every_format_is_stabilized_alike);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
