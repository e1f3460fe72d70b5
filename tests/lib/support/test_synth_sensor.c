/* SPDX-License-Identifier: MIT */
/* Depth of samples, noise, coding and overlays of synthetic clips, seen in their pixels. */
#include "support/synth_fixture.h"

static uint8_t plain[PIXELS], other[PIXELS], frame[PIXELS];
static uint16_t deep[PIXELS];

/* Ten bits are little-endian on any machine. */
static int level_of_ten_bits(int pixel)
{
    const uint8_t *bytes = (const uint8_t *)&deep[pixel];
    return bytes[0] + 256 * bytes[1];
}

START_TEST(ten_bits_show_the_same_picture_more_finely)
{
    for (int noisy = 0; noisy < 2; noisy++) {
        SynthConfig cfg = small_clip();
        cfg.noise = noisy ? 4.0 : 0.0;
        Synth *s = synth_new(&cfg);
        gray(s, 3, frame);
        synth_render_gray10(s, 3, deep, sizeof deep[0] * WIDTH);
        int finer = 0;
        for (int i = 0; i < PIXELS; i++) {
            /* the rounding of 8 bits and of 10 bits; with noise twice that, and white is clipped */
            ck_assert_near(frame[i], level_of_ten_bits(i) / 4.0, noisy ? 1.26 : 0.626);
            finer += level_of_ten_bits(i) % 4 != 0;
        }
        ck_assert_near(finer, 0.75 * PIXELS, 0.02 * PIXELS);
        synth_free(s);
    }
}
END_TEST

/* A format of more bits, and the format of eight bits with the same layout. */
typedef struct Twins {
    L1L2StabFormat deep, eight;
    int depth, shift;
} Twins;

static const Twins twins[] = {
    {L1L2STAB_FORMAT_GRAY16_LE, L1L2STAB_FORMAT_GRAY8, 16, 0}, {L1L2STAB_FORMAT_I420_10LE, L1L2STAB_FORMAT_I420, 10, 0},
    {L1L2STAB_FORMAT_I422_12LE, L1L2STAB_FORMAT_Y42B, 12, 0},  {L1L2STAB_FORMAT_Y444_16LE, L1L2STAB_FORMAT_Y444, 16, 0},
    {L1L2STAB_FORMAT_P010_10LE, L1L2STAB_FORMAT_NV12, 10, 6},  {L1L2STAB_FORMAT_P012_LE, L1L2STAB_FORMAT_NV12, 12, 4},
    {L1L2STAB_FORMAT_P016_LE, L1L2STAB_FORMAT_NV12, 16, 0},
};

START_TEST(formats_of_more_bits_show_the_same_in_all_planes)
{
    const Twins *f = &twins[_i];
    const SynthConfig cfg = small_clip();
    Synth *s = synth_new(&cfg);
    SynthPicture p = synth_picture_new(f->eight, WIDTH, HEIGHT), q = synth_picture_new(f->deep, WIDTH, HEIGHT);
    ck_assert(p.planes == q.planes && 2 * p.size == q.size);
    synth_render(s, 3, p.format, p.data, p.stride);
    synth_render(s, 3, q.format, q.data, q.stride);
    for (size_t i = 0; i < p.size; i++) {
        const int word = q.data[0][2 * i] + 256 * q.data[0][2 * i + 1];
        ck_assert_int_eq(word % (1 << f->shift), 0);
        ck_assert_near((double)word / (1 << f->shift) / (1 << (f->depth - 8)), p.data[0][i], 0.626);
    }
    synth_picture_free(&p);
    synth_picture_free(&q);
    synth_free(s);
}
END_TEST

START_TEST(the_noise_has_the_strength_that_was_asked_for_at_each_depth)
{
    SynthConfig cfg = small_clip();
    gray_once(&cfg, 3, plain);
    cfg.noise = 5.0;
    Synth *s = synth_new(&cfg);
    gray(s, 3, frame);
    synth_render_gray10(s, 3, deep, sizeof deep[0] * WIDTH);
    double sum[2] = {0.0}, square[2] = {0.0};
    for (int i = 0; i < PIXELS; i++) {
        const double off[2] = {frame[i] - plain[i], level_of_ten_bits(i) / 4.0 - plain[i]};
        for (int k = 0; k < 2; k++) {
            sum[k] += off[k] / PIXELS;
            square[k] += off[k] * off[k] / PIXELS;
        }
    }
    for (int k = 0; k < 2; k++) {
        ck_assert_near(sum[k], 0.0, 0.1);
        ck_assert_near(sqrt(square[k]), 5.0, 0.1);
    }
    synth_free(s);
}
END_TEST

START_TEST(coding_rounds_the_levels_differently_in_each_frame)
{
    SynthConfig cfg = small_clip();
    cfg.repeat_every = 5;
    gray_once(&cfg, 4, plain);
    cfg.coding = 12.0;
    gray_once(&cfg, 3, other);
    gray_once(&cfg, 4, frame);
    ck_assert_int_le(worst_difference(frame, plain), 7);
    ck_assert_near(mean_difference(frame, plain), 12.0 / 4.0, 0.2);
    ck_assert_double_gt(mean_difference(frame, other), 2.0);
    bool seen[256] = {false};
    int levels = 0;
    for (int y = 0; y < 8; y++) /* of one block */
        for (int x = 0; x < 8; x++) {
            levels += !seen[frame[y * WIDTH + x]];
            seen[frame[y * WIDTH + x]] = true;
        }
    ck_assert_int_le(levels, 256 / 12 + 2);
}
END_TEST

/* Pixels that are equal in all of some frames of a moving clip. */
static int unmoved_pixels(const SynthConfig *cfg, bool unmoved[PIXELS])
{
    int count = 0;
    Synth *s = synth_new(cfg);
    memset(unmoved, true, PIXELS * sizeof unmoved[0]);
    gray(s, 0, plain);
    for (int t = 11; t < 200; t += 11) {
        gray(s, t, frame);
        for (int i = 0; i < PIXELS; i++)
            unmoved[i] = unmoved[i] && frame[i] == plain[i];
    }
    for (int i = 0; i < PIXELS; i++)
        count += unmoved[i];
    synth_free(s);
    return count;
}

START_TEST(a_logo_stays_in_its_corner_and_has_the_contrast_of_letters)
{
    static bool unmoved[PIXELS];
    SynthConfig cfg = small_clip();
    cfg.pan_x = 2.0, cfg.noise = 3.0;
    ck_assert_int_le(unmoved_pixels(&cfg, unmoved), PIXELS / 1000);
    cfg.overlay = SYNTH_OVERLAY_LOGO;
    const int count = unmoved_pixels(&cfg, unmoved), logo = WIDTH / 8 * (WIDTH / 24);
    ck_assert_int_ge(count, logo);
    ck_assert_int_le(count, logo + logo / 4);
    int dark = 0, light = 0;
    for (int y = HEIGHT / 2; y < HEIGHT; y++)
        for (int x = WIDTH / 2; x < WIDTH; x++) {
            dark += unmoved[y * WIDTH + x] && plain[y * WIDTH + x] == 16;
            light += unmoved[y * WIDTH + x] && plain[y * WIDTH + x] == 235;
        }
    ck_assert_int_ge(dark + light, logo);
    ck_assert(dark > logo / 4 && light > logo / 4);
}
END_TEST

/* True if the box around digit k, from 0 to 5, changed between two frames. */
static bool digit_changes(const Synth *s, int k, int a, int b)
{
    const double block = HEIGHT / 160.0, left = (4 + 6 * k) * block;
    gray(s, a, plain);
    gray(s, b, other);
    for (int y = 5; y < 14; y++)
        for (int x = (int)ceil(left); x < left + 5.0 * block; x++)
            if (plain[y * WIDTH + x] != other[y * WIDTH + x])
                return true;
    return false;
}

START_TEST(a_timecode_counts_the_frames)
{
    SynthConfig cfg = small_clip();
    cfg.overlay = SYNTH_OVERLAY_TIMECODE;
    Synth *s = synth_new(&cfg);
    for (int a = 0; a < 10; a++)
        for (int b = 0; b < 10; b++) {
            ck_assert_int_eq(digit_changes(s, 5, a, b), a != b); /* ten different digits */
            ck_assert_int_eq(digit_changes(s, 4, 10 * a, 10 * b), a != b);
        }
    ck_assert(!digit_changes(s, 5, 37, 137) && digit_changes(s, 3, 37, 137));
    synth_free(s);
}
END_TEST

START_TEST(bars_are_black_and_the_picture_between_them_is_as_without)
{
    SynthConfig cfg = small_clip();
    Synth *open = synth_new(&cfg);
    cfg.letterbox = 0.2, cfg.pillarbox = 0.1; /* 18 rows and 16 columns on each side */
    Synth *barred = synth_new(&cfg);
    SynthPicture p = synth_picture_new(L1L2STAB_FORMAT_Y444, WIDTH, HEIGHT);
    SynthPicture q = synth_picture_new(p.format, WIDTH, HEIGHT);
    synth_render(open, 3, p.format, p.data, p.stride);
    synth_render(barred, 3, q.format, q.data, q.stride);
    for (int plane = 0; plane < 3; plane++)
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const bool bar = y < 18 || y >= HEIGHT - 18 || x < 16 || x >= WIDTH - 16;
                const int level = q.data[plane][y * WIDTH + x];
                ck_assert_int_eq(level, bar ? (plane ? 128 : 16) : p.data[plane][y * WIDTH + x]);
            }
    synth_picture_free(&p);
    synth_picture_free(&q);
    synth_free(open);
    synth_free(barred);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("synth_sensor");
    TCase *tc = tcase_create("synth_sensor");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, ten_bits_show_the_same_picture_more_finely);
    tcase_add_loop_test(tc, formats_of_more_bits_show_the_same_in_all_planes, 0, sizeof twins / sizeof twins[0]);
    tcase_add_test(tc, the_noise_has_the_strength_that_was_asked_for_at_each_depth);
    tcase_add_test(tc, coding_rounds_the_levels_differently_in_each_frame);
    tcase_add_test(tc, a_logo_stays_in_its_corner_and_has_the_contrast_of_letters);
    tcase_add_test(tc, a_timecode_counts_the_frames);
    tcase_add_test(tc, bars_are_black_and_the_picture_between_them_is_as_without);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
