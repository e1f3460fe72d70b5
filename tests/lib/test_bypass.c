/* SPDX-License-Identifier: MIT */
/* The bypass: the change from stabilized to untouched pictures and back, without delay. And reported motions that are
 * given again. */
#include "common/fade.h"
#include "image/format.h"
#include "stabilizer_fixture.h"

enum { WINDOW = 8, FRAMES = 100 };

START_TEST(a_fade_is_exact_at_both_ends_and_never_jumps)
{
    L1L2Fade fade = {.length = 30};
    double last = 0.0;
    for (int i = 0; i < 200; i++) {
        fade.on = i % 70 < 45; /* also reversed halfway */
        const double weight = l1l2_fade_next(&fade, false);
        ck_assert(weight >= 0.0 && weight <= 1.0 && fabs(weight - last) <= 1.5 / 30 + 1e-12);
        if (i % 70 == 29)
            ck_assert(weight == 1.0);
        last = weight;
    }
    fade.on = false;
    ck_assert(l1l2_fade_next(&fade, true) == 0.0);
    fade.on = true;
    ck_assert(l1l2_fade_next(&fade, true) == 1.0);
}
END_TEST

/* A clip with the bypass on from pull `on` to pull `off`. */
static void run(L1L2Stab *s, Clip *clip, int on, int off, L1L2StabInfo *info, SynthPicture *out)
{
    int pulled = 0;
    for (int t = 0; t < clip->frames + WINDOW - 1; t++) {
        if (t < clip->frames) {
            const L1L2StabFrame in = frame_of(clip, t);
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        } else {
            ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
        }
        if (t < WINDOW - 1)
            continue;
        L1L2StabFrame picture = {0};
        memcpy(picture.data, out[pulled].data, sizeof picture.data);
        memcpy(picture.stride, out[pulled].stride, sizeof picture.stride);
        l1l2stab_set_bypass(s, pulled >= on && pulled < off);
        ck_assert_int_eq(l1l2stab_pull(s, &picture, &info[pulled]), L1L2STAB_OK);
        pulled++;
    }
}

static void new_pictures(SynthPicture *out, const L1L2StabConfig *cfg)
{
    int width, height;
    l1l2stab_config_output_size(cfg, &width, &height);
    for (int t = 0; t < FRAMES; t++)
        out[t] = synth_picture_new(cfg->format, width, height);
}

START_TEST(a_bypass_begins_at_once_changes_smoothly_and_leaves_the_path_as_it_is)
{
    const L1L2StabConfig cfg = small_config(WINDOW);
    const int on = 20, off = 70;
    static L1L2StabInfo plain[FRAMES], info[FRAMES];
    static SynthPicture plain_out[FRAMES], out[FRAMES];
    Clip *clip = new_clip(FRAMES, cfg.format);
    L1L2Stab *s = create(&cfg);
    new_pictures(plain_out, &cfg);
    new_pictures(out, &cfg);
    run(s, clip, FRAMES, FRAMES, plain, plain_out);
    l1l2stab_reset(s);
    run(s, clip, on, off, info, out);
    const size_t luma = WIDTH * HEIGHT;
    for (int t = 0; t < FRAMES; t++) {
        const bool whole = t >= on + L1L2STAB_BYPASS_FRAMES - 1 && t < off;
        const bool stable = t < on || t >= off + L1L2STAB_BYPASS_FRAMES - 1;
        ck_assert_mem_eq(info[t].B, plain[t].B, sizeof info[t].B);
        ck_assert((info[t].bypass == 1.0) == whole && (info[t].bypass == 0.0) == stable);
        if (whole)
            ck_assert_mem_eq(out[t].data[0], clip->picture[t].data[0], luma);
        if (stable)
            ck_assert_mem_eq(out[t].data[0], plain_out[t].data[0], luma);
        const L1L2Mat now = mat_of(info[t].warp), before = mat_of(info[t ? t - 1 : 0].warp);
        const L1L2Mat plain_now = mat_of(plain[t].warp), plain_before = mat_of(plain[t ? t - 1 : 0].warp);
        const double moved = l1l2_mat_corner_distance(&now, &before, WIDTH / 2.0, HEIGHT / 2.0);
        const double plainly = l1l2_mat_corner_distance(&plain_now, &plain_before, WIDTH / 2.0, HEIGHT / 2.0);
        /* The step of the path, and 5 % of the distance to the whole picture. */
        ck_assert_double_le(moved, plainly + 1.5 / L1L2STAB_BYPASS_FRAMES * hypot(WIDTH, HEIGHT) * 0.25);
    }
    for (int t = 0; t < FRAMES; t++) {
        synth_picture_free(&out[t]);
        synth_picture_free(&plain_out[t]);
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(no_sample_leaves_the_source_during_the_transition)
{
    L1L2StabConfig cfg = small_config(WINDOW);
    cfg.output_size = (L1L2StabOutputSize)_i;
    static L1L2StabInfo info[FRAMES];
    static SynthPicture out[FRAMES];
    int width, height, between = 0;
    l1l2stab_config_output_size(&cfg, &width, &height);
    Clip *clip = new_clip(FRAMES, cfg.format);
    L1L2Stab *s = create(&cfg);
    new_pictures(out, &cfg);
    run(s, clip, 20, 60, info, out);
    for (int t = 0; t < FRAMES; t++) {
        const L1L2Mat map = mat_of(info[t].warp);
        between += info[t].bypass > 0.0 && info[t].bypass < 1.0;
        for (int k = 0; k < 4; k++) {
            const L1L2Point corner = {(k & 1 ? width : -width) / 2.0, (k & 2 ? height : -height) / 2.0};
            const L1L2Point p = l1l2_mat_apply(&map, corner);
            ck_assert_double_le(fabs(p.x), WIDTH / 2.0 + 1e-9);
            ck_assert_double_le(fabs(p.y), HEIGHT / 2.0 + 1e-9);
        }
        synth_picture_free(&out[t]);
    }
    ck_assert_int_eq(between, 2 * (L1L2STAB_BYPASS_FRAMES - 1));
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

/* A frame of noise in the bits that the format has. */
static void fill_noise(const L1L2FormatInfo *info, uint8_t *bytes, size_t size)
{
    uint32_t state = 1;
    for (size_t i = 0; i < size; i += 2) {
        state = state * 1664525u + 1013904223u;
        const unsigned noise = state >> 16;
        const unsigned value = info->depth > 8 ? (noise & ((1u << info->depth) - 1)) << info->shift : noise;
        bytes[i] = value & 255, bytes[i + 1] = value >> 8;
    }
}

START_TEST(an_untouched_frame_is_the_source_byte_for_byte_in_every_format)
{
    enum { W = 67, H = 49, STRIDE = W * 8 + 8, PLANE = STRIDE * H };
    static uint8_t source[4 * PLANE], picture[4 * PLANE];
    int formats = 0;
    for (int format = 1; format < 100; format++) {
        const L1L2FormatInfo *info = l1l2_image_format_info((L1L2StabFormat)format);
        if (!info)
            continue;
        L1L2StabConfig cfg = small_config(4);
        cfg.format = info->format, cfg.height = H;
        cfg.width = info->plane[0].log2_sub_x ? W - 1 : W; /* packed 4:2:2: of half a pair one is nothing */
        cfg.interpolation = (L1L2StabInterpolation)(format % 3);
        L1L2StabFrame in = {.stride = {STRIDE, STRIDE, STRIDE, STRIDE}}, out = in;
        for (int p = 0; p < info->planes; p++)
            in.data[p] = source + p * PLANE, out.data[p] = picture + p * PLANE;
        fill_noise(info, source, sizeof source);
        L1L2Stab *s = create(&cfg);
        l1l2stab_set_bypass(s, 1);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        l1l2stab_finish(s);
        ck_assert_int_eq(l1l2stab_pull(s, &out, NULL), L1L2STAB_OK);
        for (int p = 0; p < info->planes; p++) {
            const size_t bytes = (size_t)l1l2_image_plane_size(cfg.width, info->plane[p].log2_sub_x) *
                                 (size_t)(info->plane[p].components * l1l2_image_format_bytes(info));
            for (int y = 0; y < l1l2_image_plane_size(H, info->plane[p].log2_sub_y); y++)
                ck_assert_msg(memcmp(in.data[p] + y * STRIDE, out.data[p] + y * STRIDE, bytes) == 0,
                              "%s: plane %d, row %d", info->name, p, y);
        }
        l1l2stab_free(&s);
        formats++;
    }
    ck_assert_int_ge(formats, 13);
}
END_TEST

START_TEST(reported_motions_that_are_given_again_make_the_same_path_to_the_bit)
{
    L1L2StabConfig cfg = small_config(WINDOW);
    static L1L2StabInfo measured[FRAMES], given[FRAMES];
    Clip *clip = new_clip(FRAMES, cfg.format);
    L1L2Stab *s = create(&cfg);
    ck_assert_int_eq(stabilize(s, clip, measured, NULL), FRAMES);
    l1l2stab_reset(s);
    int pulled = 0;
    for (int t = 0; t < FRAMES; t++) {
        L1L2StabFrame in = frame_of(clip, t);
        in.motion = measured[t].F;
        in.flags = measured[t].flags & L1L2STAB_INFO_PATH_START ? L1L2STAB_FRAME_DISCONT : 0;
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (l1l2stab_pull(s, NULL, &given[pulled]) == L1L2STAB_OK)
            pulled++;
    }
    l1l2stab_finish(s);
    while (l1l2stab_pull(s, NULL, &given[pulled]) == L1L2STAB_OK)
        pulled++;
    ck_assert_int_eq(pulled, FRAMES);
    for (int t = 0; t < FRAMES; t++) {
        ck_assert_mem_eq(given[t].F, measured[t].F, sizeof given[t].F);
        ck_assert_mem_eq(given[t].warp, measured[t].warp, sizeof given[t].warp);
        ck_assert_int_eq(given[t].model, t ? L1L2STAB_MOTION_SOURCE_GIVEN : L1L2STAB_MOTION_SOURCE_NONE);
    }
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bypass");
    TCase *tc = tcase_create("bypass");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, a_fade_is_exact_at_both_ends_and_never_jumps);
    tcase_add_test(tc, a_bypass_begins_at_once_changes_smoothly_and_leaves_the_path_as_it_is);
    tcase_add_test(tc, an_untouched_frame_is_the_source_byte_for_byte_in_every_format);
    tcase_add_loop_test(tc, no_sample_leaves_the_source_during_the_transition, L1L2STAB_OUTPUT_SIZE_INPUT,
                        L1L2STAB_OUTPUT_SIZE_CROP + 1);
    tcase_add_test(tc, reported_motions_that_are_given_again_make_the_same_path_to_the_bit);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
