/* SPDX-License-Identifier: MIT */
/* Whole frames: borders that are filled from neighbors, or extended. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "common/geom.h"
#include "common/rng.h"
#include "formats.h"
#include "image/format.h"
#include "synth.h"
#include "warp/warp.h"

enum { WIDTH = 320, HEIGHT = 180, FRAMES = 50, WINDOW = 24, REACH = 12, PIXELS = WIDTH * HEIGHT };

typedef struct Film {
    L1L2StabConfig cfg;
    SynthPicture in[FRAMES], out[FRAMES];
    L1L2StabInfo info[FRAMES];
    uint8_t *map[FRAMES];
    int released[FRAMES];
    double motion[FRAMES][9];  /* given ones, if `given` */
    bool given;
    int cut;                   /* the first frame of another shot; 0: none */
    int frames;                /* of the film, at most FRAMES */
} Film;

static void count_release(void *opaque)
{
    ++*(int *)opaque;
}

/* Of any format, unlike synth_picture_new(). */
static SynthPicture new_picture_of(L1L2StabFormat number, int width, int height)
{
    const L1L2FormatInfo *format = l1l2_image_format_info(number);
    SynthPicture picture = {.format = number, .width = width, .height = height, .planes = format->planes};
    size_t from[4];
    for (int p = 0; p < format->planes; p++) {
        const int samples = l1l2_image_plane_size(width, format->plane[p].log2_sub_x);
        picture.rows[p] = l1l2_image_plane_size(height, format->plane[p].log2_sub_y);
        picture.stride[p] = (ptrdiff_t)samples * format->plane[p].components * l1l2_image_format_bytes(format);
        from[p] = picture.size;
        picture.size += (size_t)picture.stride[p] * (size_t)picture.rows[p];
    }
    uint8_t *memory = calloc(1, picture.size);
    for (int p = 0; p < format->planes; p++)
        picture.data[p] = memory + from[p];
    return picture;
}

static Film *new_film(L1L2StabFormat format, L1L2StabBorder border)
{
    Film *film = calloc(1, sizeof *film);
    l1l2stab_config_init(&film->cfg, sizeof film->cfg);
    film->cfg.format = format;
    film->cfg.width = WIDTH, film->cfg.height = HEIGHT;
    film->cfg.window = WINDOW;
    film->cfg.crop_ratio = 0.85;
    film->cfg.border = border;
    film->cfg.fill_frames = REACH;
    film->cfg.rolling_shutter = L1L2STAB_ROLLING_SHUTTER_NONE;
    film->cfg.threads = 1;
    film->frames = FRAMES;
    for (int t = 0; t < FRAMES; t++) {
        film->in[t] = new_picture_of(format, WIDTH, HEIGHT);
        film->out[t] = new_picture_of(format, WIDTH, HEIGHT);
        film->map[t] = malloc(PIXELS);
    }
    return film;
}

static void free_film(Film *film)
{
    for (int t = 0; t < FRAMES; t++) {
        synth_picture_free(&film->in[t]);
        synth_picture_free(&film->out[t]);
        free(film->map[t]);
    }
    free(film);
}

static Synth *shaky_scene(double noise)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.noise = noise;
    return synth_new(&cfg);
}

/* Packed 4:2:2 with chroma that follows the luma: the scenes have no such format. */
static void render_yuy2(Synth *scene, int t, SynthPicture *picture)
{
    static uint8_t gray[PIXELS];
    synth_render_gray(scene, t, gray, WIDTH);
    for (int i = 0; i < PIXELS; i++) {
        picture->data[0][2 * i] = gray[i];
        picture->data[0][2 * i + 1] = (uint8_t)(96 + gray[i / 2 * 2] / 4);
    }
}

static void render_scene(Film *film, Synth *scene)
{
    for (int t = 0; t < FRAMES; t++)
        if (film->cfg.format == L1L2STAB_FORMAT_YUY2)
            render_yuy2(scene, t, &film->in[t]);
        else
            synth_render(scene, t, film->cfg.format, film->in[t].data, film->in[t].stride);
}

/* A shake that is told, so that pictures without any texture can be used. */
static void give_shake(Film *film)
{
    film->given = true;
    for (int t = 0; t < FRAMES; t++) {
        const L1L2Mat F = l1l2_mat_similarity(1.0, 0.01 * sin(2.1 * t), 6.0 * sin(1.7 * t), 4.0 * cos(1.3 * t));
        memcpy(film->motion[t], F.m, sizeof F.m);
    }
}

static void set_planes(L1L2StabFrame *frame, const SynthPicture *picture)
{
    memcpy(frame->data, picture->data, sizeof frame->data);
    memcpy(frame->stride, picture->stride, sizeof frame->stride);
}

static void run(Film *film)
{
    L1L2Stab *s;
    int pulled = 0;
    memset(film->released, 0, sizeof film->released);
    ck_assert_int_eq(l1l2stab_create(&s, &film->cfg), L1L2STAB_OK);
    for (int t = 0; t <= film->frames; t++) {
        if (t < film->frames) {
            L1L2StabFrame in = {.pts = L1L2STAB_NO_PTS, .opaque = &film->released[t], .release = count_release,
                                .flags = film->cut && t == film->cut ? L1L2STAB_FRAME_DISCONT : 0,
                                .motion = film->given ? film->motion[t] : NULL};
            set_planes(&in, &film->in[t]);
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        } else {
            l1l2stab_finish(s);
        }
        for (; pulled < film->frames; pulled++) {
            L1L2StabFrame out = {0};
            set_planes(&out, &film->out[pulled]);
            if (l1l2stab_pull(s, &out, &film->info[pulled]) != L1L2STAB_OK)
                break;
            if (film->cfg.border != L1L2STAB_BORDER_CROP)
                ck_assert_int_eq(l1l2stab_border_map(s, film->map[pulled], WIDTH), L1L2STAB_OK);
        }
    }
    ck_assert_int_eq(pulled, film->frames);
    l1l2stab_free(&s);
}

static L1L2Mat mat_of(const double m[9])
{
    L1L2Mat mat;
    memcpy(mat.m, m, sizeof mat.m);
    return mat;
}

/* How far outside the source a map takes the i-th pixel of the output; negative inside. */
static double beyond_source(const L1L2Mat *map, int i)
{
    const L1L2Point out = {i % WIDTH + 0.5 - 0.5 * WIDTH, i / WIDTH + 0.5 - 0.5 * HEIGHT};
    const L1L2Point at = l1l2_mat_apply(map, out);
    return fmax(fabs(at.x) - 0.5 * WIDTH, fabs(at.y) - 0.5 * HEIGHT);
}

START_TEST(a_filled_border_shows_what_the_camera_would_have_seen)
{
    Synth *scene = shaky_scene(5.0);
    Film *film = new_film(L1L2STAB_FORMAT_GRAY8, L1L2STAB_BORDER_FILL);
    SynthPicture truth = synth_picture_new(L1L2STAB_FORMAT_GRAY8, WIDTH, HEIGHT);
    double squares = 0.0, extended = 0.0;
    long filled = 0;
    film->cfg.fill_frames = 30;
    render_scene(film, scene);
    run(film);
    for (int t = 0; t < FRAMES; t++) {
        double M[9];
        synth_camera(scene, t, M);
        const L1L2Mat view = l1l2_mat_mul(mat_of(M), mat_of(film->info[t].warp));
        synth_render_view(scene, view.m, WIDTH, HEIGHT, L1L2STAB_FORMAT_GRAY8, truth.data, truth.stride);
        extended += film->info[t].extended;
        for (int i = 0; i < PIXELS; i++)
            if (film->map[t][i] != 0 && film->map[t][i] != 255) {
                const double error = film->out[t].data[0][i] - truth.data[0][i];
                squares += error * error;
                filled++;
            }
    }
    ck_assert_int_gt(filled, PIXELS / 10);
    ck_assert_double_ge(10.0 * log10(255.0 * 255.0 * (double)filled / squares), 32.0);
    ck_assert_double_le(extended / FRAMES, 0.002);
    synth_picture_free(&truth);
    synth_free(scene);
    free_film(film);
}
END_TEST

START_TEST(the_inside_is_what_the_warp_alone_renders)
{
    Synth *scene = shaky_scene(0.0);
    Film *film = new_film(L1L2STAB_FORMAT_GRAY8, L1L2STAB_BORDER_FILL);
    const L1L2WarpConfig cfg = {.format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .in_width = WIDTH,
                                .in_height = HEIGHT, .out_width = WIDTH, .out_height = HEIGHT,
                                .interpolation = film->cfg.interpolation};
    const double seam = 6.0; /* more than the blend and the rim */
    L1L2Warp *warp;
    uint8_t *alone = malloc(PIXELS);
    long inside = 0;
    ck_assert_int_eq(l1l2_warp_create(&warp, &cfg), L1L2STAB_OK);
    render_scene(film, scene);
    run(film);
    for (int t = 0; t < FRAMES; t++) {
        const L1L2WarpMap map = {.affine = mat_of(film->info[t].warp)};
        uint8_t *const dst[4] = {alone};
        const ptrdiff_t stride[4] = {WIDTH};
        l1l2_warp_render(warp, &map, (const uint8_t *const *)film->in[t].data, film->in[t].stride, dst, stride);
        for (int i = 0; i < PIXELS; i++) {
            if (beyond_source(&map.affine, i) > -seam)
                continue;
            ck_assert_int_eq(film->out[t].data[0][i], alone[i]);
            ck_assert_int_eq(film->map[t][i], 0);
            inside++;
        }
    }
    ck_assert_int_gt(inside, FRAMES * (PIXELS / 2));
    l1l2_warp_free(warp);
    free(alone);
    synth_free(scene);
    free_film(film);
}
END_TEST

/* No frame has anything in common with another. Even so, what was filmed there is shown, not the mirrored frame. */
START_TEST(neighbors_that_do_not_match_are_shown_rather_than_an_extension)
{
    Film *film = new_film(L1L2STAB_FORMAT_GRAY8, L1L2STAB_BORDER_FILL);
    L1L2Rng rng = l1l2_rng_seeded(5);
    double filled = 0.0, extended = 0.0;
    for (int t = 0; t < FRAMES; t++)
        for (int i = 0; i < PIXELS; i++)
            film->in[t].data[0][i] = (uint8_t)(l1l2_rng_next(&rng) >> 24);
    give_shake(film);
    run(film);
    for (int t = 0; t < FRAMES; t++) {
        filled += film->info[t].filled;
        extended += film->info[t].extended;
    }
    ck_assert_double_gt(filled / FRAMES, 0.01);
    ck_assert_double_lt(extended, 0.1 * filled);
    free_film(film);
}
END_TEST

/* The map says who gave a pixel: the frame where it is seen, a neighbor of the same shot, or nobody. */
START_TEST(the_map_and_the_shares_tell_who_gave_each_pixel)
{
    Synth *scene = shaky_scene(0.0);
    Film *film = new_film(L1L2STAB_FORMAT_I420, L1L2STAB_BORDER_FILL);
    film->cut = 27;
    render_scene(film, scene);
    run(film);
    for (int t = 0; t < FRAMES; t++) {
        const L1L2Mat map = mat_of(film->info[t].warp);
        long filled = 0, extended = 0;
        for (int i = 0; i < PIXELS; i++) {
            const int provider = film->map[t][i], from = t + provider - 128;
            const double beyond = beyond_source(&map, i);
            if (provider == 0)
                ck_assert_double_le(beyond, 0.01);
            else if (provider == 255)
                ck_assert_double_ge(beyond, -0.01);
            if (provider != 0 && provider != 255) {
                ck_assert_int_ge(from, t < film->cut ? 0 : film->cut);
                ck_assert_int_lt(from, t < film->cut ? film->cut : FRAMES);
                ck_assert_int_le(abs(provider - 128), REACH);
            }
            filled += provider != 0 && provider != 255;
            extended += provider == 255;
        }
        ck_assert_near(film->info[t].filled, (double)filled / PIXELS, 1e-12);
        ck_assert_near(film->info[t].extended, (double)extended / PIXELS, 1e-12);
    }
    synth_free(scene);
    free_film(film);
}
END_TEST

static const L1L2StabFormat some_formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_NV12, L1L2STAB_FORMAT_YUY2,
                                              L1L2STAB_FORMAT_P010_10LE, L1L2STAB_FORMAT_BGRA};

START_TEST(the_bytes_do_not_depend_on_the_number_of_threads)
{
    const L1L2StabFormat format = some_formats[_i];
    if (format_left_out(format))
        return;
    Synth *scene = shaky_scene(3.0);
    Film *one = new_film(format, L1L2STAB_BORDER_FILL), *three = new_film(format, L1L2STAB_BORDER_FILL);
    three->cfg.threads = 3;
    one->frames = three->frames = 30;
    render_scene(one, scene);
    render_scene(three, scene);
    run(one);
    run(three);
    for (int t = 0; t < one->frames; t++) {
        ck_assert_mem_eq(one->out[t].data[0], three->out[t].data[0], one->out[t].size);
        ck_assert_mem_eq(one->map[t], three->map[t], PIXELS);
    }
    synth_free(scene);
    free_film(one);
    free_film(three);
}
END_TEST

/* A level in the range of each format: everywhere the same, so the output has to be as well, to the last sample. */
static void fill_level(SynthPicture *picture, const L1L2FormatInfo *format, int level)
{
    if (format->depth == 8) {
        memset(picture->data[0], level, picture->size);
        return;
    }
    const unsigned value = (unsigned)level << (format->depth - 8) << format->shift;
    for (size_t i = 0; i + 1 < picture->size; i += 2) {
        picture->data[0][i] = (uint8_t)value;
        picture->data[0][i + 1] = (uint8_t)(value >> 8);
    }
}

START_TEST(no_sample_of_any_format_is_left_out)
{
    const L1L2FormatInfo *format = l1l2_image_format_info((L1L2StabFormat)_i);
    if (!format)
        return;
    for (int extend = 0; extend < 2; extend++) {
        Film *film = new_film((L1L2StabFormat)_i, extend ? L1L2STAB_BORDER_EXTEND : L1L2STAB_BORDER_FILL);
        film->frames = 14;
        film->cfg.window = 6;
        give_shake(film);
        for (int t = 0; t < film->frames; t++)
            fill_level(&film->in[t], format, 77);
        run(film);
        double missing = 0.0;
        for (int t = 0; t < film->frames; t++) {
            ck_assert_mem_eq(film->out[t].data[0], film->in[t].data[0], film->out[t].size);
            missing += film->info[t].filled + film->info[t].extended;
            if (extend)
                ck_assert_double_eq(film->info[t].filled, 0.0);
        }
        ck_assert_double_ge(missing / film->frames, 0.01);
        free_film(film);
    }
}
END_TEST

/* Every second frame is 12 levels brighter; each output frame has one brightness all over. */
START_TEST(a_border_has_the_brightness_of_its_frame)
{
    Film *film = new_film(L1L2STAB_FORMAT_I420, L1L2STAB_BORDER_FILL);
    give_shake(film);
    for (int t = 0; t < FRAMES; t++)
        memset(film->in[t].data[0], 90 + 12 * (t % 2), film->in[t].size);
    run(film);
    double filled = 0.0;
    for (int t = 0; t < FRAMES; t++) {
        for (int i = 0; i < PIXELS; i++)
            ck_assert_int_le(abs(film->out[t].data[0][i] - film->in[t].data[0][0]), 1);
        filled += film->info[t].filled;
    }
    ck_assert_double_ge(filled / FRAMES, 0.01);
    free_film(film);
}
END_TEST

START_TEST(frames_are_kept_for_the_border_and_each_is_released_once)
{
    Film *film = new_film(L1L2STAB_FORMAT_I420, L1L2STAB_BORDER_FILL);
    L1L2Stab *s;
    int pulled = 0;
    ck_assert_int_eq(l1l2stab_create(&s, &film->cfg), L1L2STAB_OK);
    for (int t = 0; t < FRAMES; t++) {
        L1L2StabFrame in = {.pts = t, .opaque = &film->released[t], .release = count_release}, out = {0};
        set_planes(&in, &film->in[t]);
        set_planes(&out, &film->out[t]);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        while (l1l2stab_pull(s, &out, NULL) == L1L2STAB_OK)
            pulled++;
        for (int k = 0; k < FRAMES; k++)
            ck_assert_int_eq(film->released[k], k < pulled - REACH);
    }
    l1l2stab_finish(s);
    L1L2StabFrame out = {0};
    set_planes(&out, &film->out[0]);
    while (l1l2stab_pull(s, &out, NULL) == L1L2STAB_OK)
        ;
    for (int k = 0; k < FRAMES; k++)
        ck_assert_int_eq(film->released[k], 1); /* at the end of the stream, not only when the instance is freed */
    l1l2stab_free(&s);
    for (int k = 0; k < FRAMES; k++)
        ck_assert_int_eq(film->released[k], 1);
    free_film(film);
}
END_TEST

/* Sizes of which the grids and strips have one cell or an odd rest. */
START_TEST(frames_of_any_size_are_filled)
{
    const int sizes[][2] = {{16, 16}, {17, 33}, {16, 301}, {301, 16}, {131, 67}};
    const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_Y41B, L1L2STAB_FORMAT_YUY2,
                                      L1L2STAB_FORMAT_P010_10LE};
    const int width = sizes[_i][0], height = sizes[_i][1];
    for (int f = 0; f < (int)(sizeof formats / sizeof *formats); f++) {
        const L1L2FormatInfo *format = l1l2_image_format_info(formats[f]);
        L1L2StabConfig cfg;
        L1L2Stab *s;
        if (format_left_out(formats[f]))
            continue;
        if (formats[f] == L1L2STAB_FORMAT_YUY2 && width % 2)
            continue; /* the last pair has a pixel of any level */
        double missing = 0.0;
        l1l2stab_config_init(&cfg, sizeof cfg);
        cfg.format = formats[f];
        cfg.width = width, cfg.height = height;
        cfg.window = 6;
        cfg.crop_ratio = 0.6;
        cfg.border = L1L2STAB_BORDER_FILL;
        ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_OK);
        SynthPicture in = new_picture_of(formats[f], width, height), out = new_picture_of(formats[f], width, height);
        fill_level(&in, format, 77);
        for (int t = 0, pulled = 0; pulled < 20; t++) {
            const L1L2Mat F = l1l2_mat_similarity(1.0, 0.02 * sin(2.1 * t), 3.0 * sin(1.7 * t), 2.0 * cos(1.3 * t));
            L1L2StabFrame frame = {.pts = L1L2STAB_NO_PTS, .motion = F.m}, target = {0};
            L1L2StabInfo info;
            set_planes(&frame, &in);
            set_planes(&target, &out);
            ck_assert_int_eq(l1l2stab_push(s, &frame), L1L2STAB_OK);
            if (l1l2stab_pull(s, &target, &info) != L1L2STAB_OK)
                continue;
            ck_assert_mem_eq(in.data[0], out.data[0], in.size);
            missing += info.filled + info.extended;
            pulled++;
        }
        ck_assert_double_gt(missing, 0.0);
        l1l2stab_free(&s);
        synth_picture_free(&in);
        synth_picture_free(&out);
    }
}
END_TEST

START_TEST(bypass_shows_the_frame_untouched)
{
    Synth *scene = shaky_scene(0.0);
    Film *film = new_film(L1L2STAB_FORMAT_I420, L1L2STAB_BORDER_FILL);
    L1L2Stab *s;
    render_scene(film, scene);
    ck_assert_int_eq(l1l2stab_create(&s, &film->cfg), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_set_bypass(s, 1), L1L2STAB_OK);
    for (int t = 0, pulled = 0; t < FRAMES; t++) {
        L1L2StabFrame in = {.pts = t}, out = {0};
        set_planes(&in, &film->in[t]);
        set_planes(&out, &film->out[pulled]);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (l1l2stab_pull(s, &out, &film->info[pulled]) != L1L2STAB_OK)
            continue;
        ck_assert_mem_eq(film->out[pulled].data[0], film->in[pulled].data[0], film->in[pulled].size);
        ck_assert_double_eq(film->info[pulled].filled + film->info[pulled].extended, 0.0);
        pulled++;
    }
    l1l2stab_free(&s);
    synth_free(scene);
    free_film(film);
}
END_TEST

START_TEST(whole_frames_of_the_crop_windows_size_are_refused)
{
    L1L2StabConfig cfg;
    L1L2Stab *s;
    uint8_t map[1];
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.output_size = L1L2STAB_OUTPUT_SIZE_CROP;
    for (int border = L1L2STAB_BORDER_FILL; border <= L1L2STAB_BORDER_EXTEND; border++) {
        cfg.border = (L1L2StabBorder)border;
        ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_ERR_ARGUMENT);
    }
    cfg.border = L1L2STAB_BORDER_CROP;
    ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_border_map(s, map, 1), L1L2STAB_ERR_STATE);
    l1l2stab_free(&s);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fill");
    TCase *tcase = tcase_create("fill");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, a_filled_border_shows_what_the_camera_would_have_seen);
    tcase_add_test(tcase, the_inside_is_what_the_warp_alone_renders);
    tcase_add_test(tcase, neighbors_that_do_not_match_are_shown_rather_than_an_extension);
    tcase_add_test(tcase, the_map_and_the_shares_tell_who_gave_each_pixel);
    tcase_add_loop_test(tcase, the_bytes_do_not_depend_on_the_number_of_threads, 0,
                        (int)(sizeof some_formats / sizeof *some_formats));
    tcase_add_loop_test(tcase, no_sample_of_any_format_is_left_out, L1L2STAB_FORMAT_GRAY8, L1L2STAB_FORMAT_AYUV64 + 1);
    tcase_add_test(tcase, a_border_has_the_brightness_of_its_frame);
    tcase_add_test(tcase, frames_are_kept_for_the_border_and_each_is_released_once);
    tcase_add_loop_test(tcase, frames_of_any_size_are_filled, 0, 5);
    tcase_add_test(tcase, bypass_shows_the_frame_untouched);
    tcase_add_test(tcase, whole_frames_of_the_crop_windows_size_are_refused);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
