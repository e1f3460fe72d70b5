/* SPDX-License-Identifier: MIT */
/* The public interface as a caller sees it: states, ownership, order, numbers and pictures. */
#include <string.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "geom.h"
#include "synth.h"

enum { WIDTH = 160, HEIGHT = 96, MAX_FRAMES = 128 };

/* A small clip, and how often each of its frames was released. */
typedef struct Clip {
    SynthPicture picture[MAX_FRAMES];
    int released[MAX_FRAMES];
    int frames;
} Clip;

static void count_release(void *opaque)
{
    ++*(int *)opaque;
}

static Clip *new_clip(int frames, L1L2StabFormat format)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.shake = 2.0, cfg.roll = 0.002, cfg.pan_x = 0.4;
    Synth *synth = synth_new(&cfg);
    Clip *clip = calloc(1, sizeof *clip);
    clip->frames = frames;
    for (int t = 0; t < frames; t++) {
        clip->picture[t] = synth_picture_new(format, WIDTH, HEIGHT);
        synth_render(synth, t, format, clip->picture[t].data, clip->picture[t].stride);
    }
    synth_free(synth);
    return clip;
}

static void free_clip(Clip *clip)
{
    for (int t = 0; t < clip->frames; t++)
        synth_picture_free(&clip->picture[t]);
    free(clip);
}

static L1L2StabFrame frame_of(Clip *clip, int t)
{
    L1L2StabFrame frame = {.pts = 1000 + 33 * t, .opaque = &clip->released[t], .release = count_release};
    memcpy(frame.data, clip->picture[t].data, sizeof frame.data);
    memcpy(frame.stride, clip->picture[t].stride, sizeof frame.stride);
    return frame;
}

static L1L2StabConfig small_config(int window)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.frame_rate = 30;
    cfg.window = window;
    cfg.crop_ratio = 0.8;
    cfg.threads = 1;
    return cfg;
}

static L1L2Stab *create(const L1L2StabConfig *cfg)
{
    L1L2Stab *s;
    ck_assert_int_eq(l1l2stab_create(&s, cfg), L1L2STAB_OK);
    return s;
}

/* The public header's loop over a clip. Returns the frames that came out, with their infos and, if wanted, pictures. */
static int stabilize(L1L2Stab *s, Clip *clip, L1L2StabInfo *info, SynthPicture *out)
{
    int pulled = 0;
    L1L2StabResult r = L1L2STAB_OK;
    for (int t = 0; t <= clip->frames; t++) {
        if (t < clip->frames) {
            const L1L2StabFrame in = frame_of(clip, t);
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        } else {
            ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
        }
        for (;;) {
            L1L2StabFrame picture = {0};
            int64_t pts = -1;
            void *opaque = NULL;
            const L1L2StabResult ready = l1l2stab_peek(s, &pts, &opaque);
            if (ready == L1L2STAB_OK) {
                ck_assert_int_eq(pts, 1000 + 33 * pulled); /* in order, its own */
                ck_assert_ptr_eq(opaque, &clip->released[pulled]);
                ck_assert_int_eq(clip->released[pulled], 0);
            }
            if (out) {
                memcpy(picture.data, out[pulled].data, sizeof picture.data);
                memcpy(picture.stride, out[pulled].stride, sizeof picture.stride);
            }
            r = l1l2stab_pull(s, out ? &picture : NULL, info ? &info[pulled] : NULL);
            ck_assert_int_eq(r, ready);
            if (r != L1L2STAB_OK)
                break;
            if (out)
                ck_assert_int_eq(picture.pts, 1000 + 33 * pulled);
            ck_assert_int_eq(clip->released[pulled], 1);
            pulled++;
        }
        ck_assert_int_eq(r, t < clip->frames ? L1L2STAB_AGAIN : L1L2STAB_EOS);
    }
    return pulled;
}

static L1L2Mat mat_of(const double m[9])
{
    L1L2Mat out;
    memcpy(out.m, m, sizeof out.m);
    return out;
}

START_TEST(n_frames_in_are_n_frames_out_each_released_once)
{
    const int window = 8, lengths[] = {0, 1, 2, 3, window - 1, window, window + 1, 2 * window, 31};
    for (int join = 0; join < 2; join++)
        for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
            L1L2StabConfig cfg = small_config(window);
            cfg.join = (L1L2StabJoin)join;
            Clip *clip = new_clip(lengths[i], cfg.format);
            L1L2Stab *s = create(&cfg);
            ck_assert_int_eq(stabilize(s, clip, NULL, NULL), lengths[i]);
            l1l2stab_free(&s);
            ck_assert_ptr_null(s);
            for (int t = 0; t < clip->frames; t++)
                ck_assert_int_eq(clip->released[t], 1);
            free_clip(clip);
        }
}
END_TEST

START_TEST(a_frame_is_ready_when_the_window_is_full_and_not_before)
{
    const L1L2StabConfig cfg = small_config(10);
    Clip *clip = new_clip(14, cfg.format);
    L1L2Stab *s = create(&cfg);
    for (int t = 0; t < 14; t++) {
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        ck_assert_int_eq(l1l2stab_peek(s, NULL, NULL), t < 9 ? L1L2STAB_AGAIN : L1L2STAB_OK);
        if (t >= 9) {
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_AGAIN); /* full: pull first */
            ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_OK);
        }
    }
    l1l2stab_free(&s);
    for (int t = 0; t < 14; t++)
        ck_assert_int_eq(clip->released[t], 1); /* what was held is released by free */
    free_clip(clip);
}
END_TEST

START_TEST(reset_releases_and_is_as_good_as_new)
{
    const L1L2StabConfig cfg = small_config(8);
    L1L2StabInfo fresh[20], again[20];
    Clip *other = new_clip(11, cfg.format), *clip = new_clip(20, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, fresh, NULL), 20);
    l1l2stab_reset(s);
    for (int t = 0; t < 7; t++) {
        const L1L2StabFrame in = frame_of(other, 10 - t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    }
    l1l2stab_reset(s);
    for (int t = 4; t < 11; t++)
        ck_assert_int_eq(other->released[t], 1);
    memset(clip->released, 0, sizeof clip->released);
    ck_assert_int_eq(stabilize(s, clip, again, NULL), 20);
    for (int t = 0; t < 20; t++) {
        ck_assert_mem_eq(fresh[t].warp, again[t].warp, sizeof fresh[t].warp);
        ck_assert_uint_eq(again[t].index, (uint64_t)t);
    }
    l1l2stab_free(&s);
    free_clip(clip);
    free_clip(other);
}
END_TEST

START_TEST(calls_out_of_order_are_errors_and_change_nothing)
{
    const L1L2StabConfig cfg = small_config(8);
    Clip *clip = new_clip(2, cfg.format);
    L1L2Stab *s = create(&cfg);
    L1L2StabFrame in = frame_of(clip, 0);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_AGAIN);
    in.data[1] = NULL;
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(clip->released[0], 0); /* still the caller's */
    in = frame_of(clip, 0);
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
    in = frame_of(clip, 1);
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_ERR_STATE);
    L1L2StabFrame empty = {0};
    ck_assert_int_eq(l1l2stab_pull(s, &empty, NULL), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_EOS);
    ck_assert_int_eq(l1l2stab_push(NULL, &in), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_pull(NULL, NULL, NULL), L1L2STAB_ERR_ARGUMENT);
    l1l2stab_reset(NULL);
    l1l2stab_free(NULL);
    l1l2stab_free(&s);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(the_infos_matrices_agree_with_each_other)
{
    const L1L2StabConfig cfg = small_config(16);
    L1L2StabInfo info[60];
    Clip *clip = new_clip(60, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, info, NULL), 60);
    L1L2Mat C = l1l2_mat_identity(), P_before = l1l2_mat_identity();
    for (int t = 0; t < 60; t++) {
        const L1L2Mat F = mat_of(info[t].F), B = mat_of(info[t].B), S = mat_of(info[t].S);
        C = t == 0 ? C : l1l2_mat_mul(C, F); /* eq. (1) */
        const L1L2Mat P = l1l2_mat_mul(C, B); /* eq. (2) */
        const L1L2Mat info_C = mat_of(info[t].C), info_P = mat_of(info[t].P), warp = mat_of(info[t].warp);
        ck_assert_near(l1l2_mat_corner_distance(&C, &info_C, 80, 48), 0.0, 1e-6);
        ck_assert_near(l1l2_mat_corner_distance(&P, &info_P, 80, 48), 0.0, 1e-6);
        if (t > 0) {
            const L1L2Mat moved = l1l2_mat_mul(P_before, S);
            ck_assert_near(l1l2_mat_corner_distance(&P, &moved, 80, 48), 0.0, 1e-6);
        }
        const L1L2Mat zoomed = l1l2_mat_mul(B, l1l2_mat_diagonal(0.8, 0.8)); /* output pixel u reads B (crop u) */
        ck_assert_near(l1l2_mat_corner_distance(&warp, &zoomed, 80, 48), 0.0, 1e-9);
        for (int k = 0; k < 4; k++) { /* inclusion */
            const L1L2Point p = l1l2_mat_apply(&warp, (L1L2Point){k & 1 ? 80 : -80, k & 2 ? 48 : -48});
            ck_assert(fabs(p.x) <= 80 + 1e-9 && fabs(p.y) <= 48 + 1e-9);
        }
        ck_assert_int_eq(info[t].flags & L1L2STAB_INFO_PATH_START ? 1 : 0, t == 0);
        ck_assert_int_eq(info[t].model, t == 0 ? L1L2STAB_MODEL_NONE : L1L2STAB_MODEL_SIMILARITY);
        P_before = P;
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(a_discontinuity_starts_a_path_without_a_change_of_delay)
{
    const L1L2StabConfig cfg = small_config(12);
    L1L2StabInfo info[40];
    Clip *clip = new_clip(40, cfg.format);
    L1L2Stab *s = create(&cfg);
    int pulled = 0;
    for (int t = 0; t < 40; t++) {
        L1L2StabFrame in = frame_of(clip, t);
        in.flags = t == 19 ? L1L2STAB_FRAME_DISCONT : 0;
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (l1l2stab_pull(s, NULL, &info[pulled]) == L1L2STAB_OK)
            pulled++;
        ck_assert_int_eq(pulled, t < 11 ? 0 : t - 10);
    }
    ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
    while (l1l2stab_pull(s, NULL, &info[pulled]) == L1L2STAB_OK)
        pulled++;
    ck_assert_int_eq(pulled, 40);
    for (int t = 0; t < 40; t++) {
        ck_assert_uint_eq(info[t].index, (uint64_t)t);
        ck_assert_uint_eq(info[t].path_index, (uint64_t)(t < 19 ? t : t - 19));
        ck_assert_int_eq(info[t].flags & L1L2STAB_INFO_PATH_START ? 1 : 0, t == 0 || t == 19);
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

/* RMS of the second difference of the crop window's corner path, px: of the truth, as filmed and as given out. */
static void true_jitter(const SynthConfig *scene, const L1L2StabInfo *info, int frames, double *before, double *after)
{
    Synth *synth = synth_new(scene);
    const double hw = scene->width / 2.0, hh = scene->height / 2.0;
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
    synth_free(synth);
}

START_TEST(the_true_shake_falls_to_a_tenth)
{
    L1L2StabConfig cfg = small_config(60);
    L1L2StabInfo info[120];
    Clip *clip = new_clip(120, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, info, NULL), 120);
    SynthConfig scene = synth_defaults();
    scene.width = WIDTH, scene.height = HEIGHT;
    scene.shake = 2.0, scene.roll = 0.002, scene.pan_x = 0.4;
    double before, after;
    true_jitter(&scene, info, 120, &before, &after);
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
    SynthConfig scene = synth_defaults();
    scene.width = WIDTH, scene.height = HEIGHT;
    scene.shake = 2.0, scene.roll = 0.002, scene.pan_x = 0.4;
    Synth *synth = synth_new(&scene);
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
    synth_free(synth);
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

START_TEST(every_format_is_stabilised_alike)
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
    Suite *suite = suite_create("stabilizer");
    TCase *tcase = tcase_create("stabilizer");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, n_frames_in_are_n_frames_out_each_released_once);
    tcase_add_test(tcase, a_frame_is_ready_when_the_window_is_full_and_not_before);
    tcase_add_test(tcase, reset_releases_and_is_as_good_as_new);
    tcase_add_test(tcase, calls_out_of_order_are_errors_and_change_nothing);
    tcase_add_test(tcase, the_infos_matrices_agree_with_each_other);
    tcase_add_test(tcase, a_discontinuity_starts_a_path_without_a_change_of_delay);
    tcase_add_test(tcase, the_true_shake_falls_to_a_tenth);
    tcase_add_test(tcase, the_picture_is_what_a_steady_camera_would_have_filmed);
    tcase_add_test(tcase, the_number_of_threads_changes_no_bit);
    tcase_add_test(tcase, every_format_is_stabilised_alike);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
