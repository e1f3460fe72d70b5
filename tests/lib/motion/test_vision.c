/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "motion/vision.h"
#include "synth.h"

enum { POINTS = 200 };

static L1L2Vision *vision;
static int messages;

static void count_message(void *cookie, L1L2StabLogLevel level, const char *message)
{
    ck_assert_int_eq(level, L1L2STAB_LOG_ERROR);
    ck_assert_int_gt(strlen(message), 10);
    messages++;
}

static const L1L2StabLogger logger = {count_message, NULL, L1L2STAB_LOG_TRACE};

static void create(int width, int height, L1L2StabFormat format)
{
    const L1L2VisionConfig cfg = {l1l2_image_format_info(format), width, height, 640, &l1l2_motion_defaults,
                                   &logger};
    ck_assert_int_eq(l1l2_vision_create(&vision, &cfg), L1L2STAB_OK);
}

static void setup(void)
{
    vision = NULL;
    messages = 0;
}

static void teardown(void)
{
    l1l2_vision_free(vision);
}

/* A new picture of one gray level, `bytes` in all. */
static void advance_flat(int width, int height, int components, uint8_t level)
{
    const size_t bytes = (size_t)width * (size_t)height * (size_t)components;
    uint8_t *data = malloc(bytes);
    ck_assert_ptr_nonnull(data);
    memset(data, level, bytes);
    ck_assert_int_eq(l1l2_vision_advance(vision, data, (ptrdiff_t)width * components), L1L2STAB_OK);
    free(data);
}

/* A new picture: frame t of a clip. */
static void advance_synth(const SynthConfig *cfg, int t)
{
    Synth *s = synth_new(cfg);
    SynthPicture p = synth_picture_new(L1L2STAB_FORMAT_GRAY8, cfg->width, cfg->height);
    synth_render(s, t, p.format, p.data, p.stride);
    ck_assert_int_eq(l1l2_vision_advance(vision, p.data[0], p.stride[0]), L1L2STAB_OK);
    synth_picture_free(&p);
    synth_free(s);
}

static int corners(const L1L2Pixel *taken, int count, L1L2Pixel *out, int capacity)
{
    int found = -1;
    ck_assert_int_eq(l1l2_vision_corners(vision, taken, count, NULL, 12.0, out, capacity, &found), L1L2STAB_OK);
    ck_assert_int_ge(found, 0);
    ck_assert_int_le(found, capacity);
    return found;
}

START_TEST(the_longer_side_is_scaled_to_the_analysis_size)
{
    static const int sizes[][4] = {{1280, 720, 640, 360}, {1920, 1080, 640, 360}, {1080, 1920, 360, 640},
                                   {855, 483, 640, 362},  {640, 361, 640, 361},   {320, 240, 320, 240},
                                   {16, 16, 16, 16},      {8000, 16, 640, 16},    {16384, 100, 640, 32}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        int width, height;
        create(sizes[i][0], sizes[i][1], L1L2STAB_FORMAT_GRAY8);
        l1l2_vision_size(vision, &width, &height);
        ck_assert_int_eq(width, sizes[i][2]);
        ck_assert_int_eq(height, sizes[i][3]);
        l1l2_vision_free(vision);
    }
    vision = NULL;
}
END_TEST

START_TEST(corners_keep_their_distance_from_each_other_and_from_those_taken)
{
    const SynthConfig cfg = synth_defaults();
    L1L2Pixel found[2 * POINTS];
    create(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
    advance_synth(&cfg, 0);
    advance_synth(&cfg, 1);
    const int before = corners(NULL, 0, found, POINTS / 2);
    ck_assert_int_eq(before, POINTS / 2);
    for (int i = 0; i < before; i++) /* tracked points do not lie on pixels */
        found[i].x += 0.3f, found[i].y -= 0.4f;
    const int count = before + corners(found, before, found + before, POINTS);
    ck_assert_int_gt(count, POINTS);
    for (int i = 0; i < count; i++) {
        ck_assert(found[i].x >= 0.0f && found[i].x <= (float)(cfg.width - 1));
        ck_assert(found[i].y >= -0.4f && found[i].y <= (float)(cfg.height - 1));
        for (int j = 0; j < i; j++)
            ck_assert_float_ge(hypotf(found[i].x - found[j].x, found[i].y - found[j].y), 12.0f);
    }
}
END_TEST

START_TEST(points_are_tracked_to_their_true_positions)
{
    SynthConfig cfg = synth_defaults();
    cfg.noise = 3.0;
    L1L2Pixel from[POINTS], to[POINTS];
    bool ok[POINTS];
    create(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
    advance_synth(&cfg, 0);
    advance_synth(&cfg, 1);
    const int count = corners(NULL, 0, from, POINTS);
    ck_assert_int_eq(count, POINTS);
    ck_assert_int_eq(l1l2_vision_track(vision, from, to, ok, count, 0.5), L1L2STAB_OK);
    double F[9];
    Synth *s = synth_new(&cfg);
    synth_motion(s, 1, F);
    synth_free(s);
    int good = 0, near = 0;
    for (int i = 0; i < count; i++) {
        if (!ok[i])
            continue;
        const double x = to[i].x + 0.5 - 0.5 * cfg.width, y = to[i].y + 0.5 - 0.5 * cfg.height;
        const double dx = F[0] * x + F[1] * y + F[2] - (from[i].x + 0.5 - 0.5 * cfg.width);
        const double dy = F[3] * x + F[4] * y + F[5] - (from[i].y + 0.5 - 0.5 * cfg.height);
        good++;
        near += hypot(dx, dy) < 0.25;
    }
    ck_assert_int_ge(good, POINTS * 9 / 10);
    ck_assert_int_ge(near, good * 95 / 100);
}
END_TEST

START_TEST(points_that_leave_the_picture_are_not_ok)
{
    SynthConfig cfg = synth_defaults();
    cfg.shake = cfg.roll = 0.0;
    cfg.pan_x = 30.0;
    L1L2Pixel from[POINTS], to[POINTS];
    bool ok[POINTS];
    create(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
    advance_synth(&cfg, 0);
    advance_synth(&cfg, 1);
    const int count = corners(NULL, 0, from, POINTS);
    ck_assert_int_eq(l1l2_vision_track(vision, from, to, ok, count, 0.5), L1L2STAB_OK);
    int left = 0;
    for (int i = 0; i < count; i++) {
        ck_assert(!ok[i] || (to[i].x >= 0.0f && to[i].x <= (float)(cfg.width - 1)));
        if (from[i].x < 30.0f) {
            ck_assert(!ok[i]);
            left++;
        }
    }
    ck_assert_int_gt(left, 0);
}
END_TEST

START_TEST(points_that_do_not_come_back_are_not_ok)
{
    const SynthConfig cfg = synth_defaults();
    SynthConfig other = cfg;
    other.seed = 2;
    L1L2Pixel from[POINTS], to[POINTS];
    bool ok[POINTS];
    create(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
    advance_synth(&cfg, 0);
    advance_synth(&other, 0); /* nothing in it is of the first picture */
    const int count = corners(NULL, 0, from, POINTS);
    int strict = 0, lax = 0;
    ck_assert_int_eq(l1l2_vision_track(vision, from, to, ok, count, 0.5), L1L2STAB_OK);
    for (int i = 0; i < count; i++)
        strict += ok[i];
    ck_assert_int_eq(l1l2_vision_track(vision, from, to, ok, count, 1e9), L1L2STAB_OK);
    for (int i = 0; i < count; i++)
        lax += ok[i];
    ck_assert_int_gt(lax, 100);
    ck_assert_int_lt(strict, lax / 5);
}
END_TEST

START_TEST(a_flat_picture_has_no_corners)
{
    create(320, 240, L1L2STAB_FORMAT_GRAY8);
    advance_flat(320, 240, 1, 0);
    advance_flat(320, 240, 1, 200);
    L1L2Pixel found[POINTS];
    ck_assert_int_eq(corners(NULL, 0, found, POINTS), 0);
    advance_flat(320, 240, 1, 200);
    ck_assert_int_eq(corners(NULL, 0, found, POINTS), 0);
}
END_TEST

START_TEST(without_two_pictures_no_corner_is_found_or_tracked)
{
    const SynthConfig cfg = synth_defaults();
    L1L2Pixel at = {100.0f, 100.0f}, to;
    bool ok = true;
    create(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
    for (int round = 0; round < 2; round++) {
        advance_synth(&cfg, 0);
        ck_assert_int_eq(corners(NULL, 0, &to, 1), 0);
        ck_assert_int_eq(l1l2_vision_track(vision, &at, &to, &ok, 1, 0.5), L1L2STAB_OK);
        ck_assert(!ok);
        advance_synth(&cfg, 1);
        ck_assert_int_eq(corners(NULL, 0, &to, 1), 1);
        ck_assert_int_eq(corners(NULL, 0, &to, 0), 0);
        l1l2_vision_reset(vision);
    }
}
END_TEST

/* The corners of the synthetic clip's first frame, as seen through one format and memory layout. */
static int corners_through(L1L2StabFormat format, bool bottom_up, L1L2Pixel *out)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 1282, cfg.height = 721;
    Synth *s = synth_new(&cfg);
    SynthPicture p = synth_picture_new(format, cfg.width, cfg.height);
    synth_render(s, 0, format, p.data, p.stride);
    uint8_t *padded = malloc((size_t)(p.stride[0] + 13) * (size_t)cfg.height);
    ck_assert_ptr_nonnull(padded);
    for (int y = 0; y < cfg.height; y++)
        memcpy(padded + (p.stride[0] + 13) * (bottom_up ? cfg.height - 1 - y : y), p.data[0] + p.stride[0] * y,
               (size_t)p.stride[0]);
    create(cfg.width, cfg.height, format);
    const ptrdiff_t stride = bottom_up ? -(p.stride[0] + 13) : p.stride[0] + 13;
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(l1l2_vision_advance(vision, bottom_up ? padded - stride * (cfg.height - 1) : padded, stride),
                         L1L2STAB_OK);
    const int found = corners(NULL, 0, out, POINTS);
    l1l2_vision_free(vision);
    vision = NULL;
    free(padded);
    synth_picture_free(&p);
    synth_free(s);
    return found;
}

START_TEST(the_rows_may_run_bottom_up)
{
    L1L2Pixel down[POINTS], up[POINTS];
    ck_assert_int_eq(corners_through(L1L2STAB_FORMAT_GRAY8, false, down), POINTS);
    ck_assert_int_eq(corners_through(L1L2STAB_FORMAT_GRAY8, true, up), POINTS);
    for (int i = 0; i < POINTS; i++)
        ck_assert(down[i].x == up[i].x && down[i].y == up[i].y);
}
END_TEST

START_TEST(packed_pictures_have_the_corners_of_their_luma)
{
    static const L1L2StabFormat packed[] = {L1L2STAB_FORMAT_BGR, L1L2STAB_FORMAT_RGB, L1L2STAB_FORMAT_BGRX,
                                            L1L2STAB_FORMAT_RGBA};
    L1L2Pixel gray[POINTS], color[POINTS];
    ck_assert_int_eq(corners_through(L1L2STAB_FORMAT_GRAY8, false, gray), POINTS);
    for (size_t k = 0; k < sizeof packed / sizeof packed[0]; k++) {
        ck_assert_int_eq(corners_through(packed[k], false, color), POINTS);
        int same = 0;
        for (int i = 0; i < POINTS; i++)
            for (int j = 0; j < POINTS; j++)
                same += fabsf(gray[i].x - color[j].x) <= 2.0f && fabsf(gray[i].y - color[j].y) <= 2.0f;
        ck_assert_int_ge(same, POINTS * 9 / 10);
    }
}
END_TEST

START_TEST(small_and_thin_pictures_do_no_harm)
{
    static const int sizes[][2] = {{16, 16}, {17, 31}, {8000, 16}, {16, 8000}, {16384, 17}, {40, 24}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        SynthConfig cfg = synth_defaults();
        cfg.width = sizes[i][0], cfg.height = sizes[i][1];
        cfg.shake = 1.0;
                L1L2Pixel from[POINTS], to[POINTS];
        bool ok[POINTS];
        create(cfg.width, cfg.height, L1L2STAB_FORMAT_GRAY8);
        for (int t = 0; t < 3; t++) {
            advance_synth(&cfg, t);
            const int count = corners(NULL, 0, from, POINTS);
            ck_assert_int_eq(l1l2_vision_track(vision, from, to, ok, count, 0.5), L1L2STAB_OK);
        }
        ck_assert_int_eq(messages, 0);
        l1l2_vision_free(vision);
        vision = NULL;
    }
}
END_TEST

START_TEST(an_exception_becomes_an_error_code_and_a_log_message)
{
    create(64, 64, L1L2STAB_FORMAT_GRAY8);
    advance_flat(64, 64, 1, 0);
    advance_flat(64, 64, 1, 0);
    const L1L2Pixel taken = {32.0f, 32.0f};
    L1L2Pixel corner;
    int found; /* a circle of a negative radius is refused */
    ck_assert_int_eq(l1l2_vision_corners(vision, &taken, 1, NULL, -10.0, &corner, 1, &found), L1L2STAB_ERR_BACKEND);
    ck_assert_int_eq(messages, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("vision");
    TCase *tc = tcase_create("vision");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, the_longer_side_is_scaled_to_the_analysis_size);
    tcase_add_test(tc, corners_keep_their_distance_from_each_other_and_from_those_taken);
    tcase_add_test(tc, points_are_tracked_to_their_true_positions);
    tcase_add_test(tc, points_that_leave_the_picture_are_not_ok);
    tcase_add_test(tc, points_that_do_not_come_back_are_not_ok);
    tcase_add_test(tc, a_flat_picture_has_no_corners);
    tcase_add_test(tc, without_two_pictures_no_corner_is_found_or_tracked);
    tcase_add_test(tc, the_rows_may_run_bottom_up);
    tcase_add_test(tc, packed_pictures_have_the_corners_of_their_luma);
    tcase_add_test(tc, small_and_thin_pictures_do_no_harm);
    tcase_add_test(tc, an_exception_becomes_an_error_code_and_a_log_message);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
