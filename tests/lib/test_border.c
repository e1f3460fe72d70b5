/* SPDX-License-Identifier: MIT */
/* What passes between the caller and the library: struct sizes, addresses, given motions, and settings that a reset
 * keeps. */
#include <stdio.h>

#include "common/rng.h"
#include "formats.h"
#include "stabilizer_fixture.h"

enum { WINDOW = 8, FRAMES = 24 };

static char last_message[512];

static void remember(void *cookie, L1L2StabLogLevel level, const char *message)
{
    (void)cookie;
    if (level == L1L2STAB_LOG_ERROR)
        snprintf(last_message, sizeof last_message, "%s", message);
}

static L1L2Stab *create_logged(L1L2StabConfig cfg)
{
    cfg.logger.write = remember;
    last_message[0] = '\0';
    return create(&cfg);
}

START_TEST(a_frame_carries_its_size_and_zero_stands_for_the_first_layout)
{
    Clip *clip = new_clip(1, L1L2STAB_FORMAT_I420);
    const struct {
        size_t size;
        int later; /* a byte beyond the struct that this version knows */
        L1L2StabResult result;
    } cases[] = {
        {0, 0, L1L2STAB_OK},
        {0, 1, L1L2STAB_OK}, /* not read: 0 means the first layout */
        {sizeof(L1L2StabFrame), 0, L1L2STAB_OK},
        {sizeof(L1L2StabFrame), 1, L1L2STAB_OK},
        {sizeof(L1L2StabFrame) + 32, 0, L1L2STAB_OK}, /* a newer header, nothing new set */
        {sizeof(L1L2StabFrame) + 32, 1, L1L2STAB_ERR_UNSUPPORTED},
        {1, 0, L1L2STAB_ERR_ARGUMENT},
        {sizeof(L1L2StabFrame) - 1, 0, L1L2STAB_ERR_ARGUMENT},
        {4097, 0, L1L2STAB_ERR_ARGUMENT},
        {0xdeadbeef, 0, L1L2STAB_ERR_ARGUMENT},
        {(size_t)-1, 0, L1L2STAB_ERR_ARGUMENT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int pulling = 0; pulling < 2; pulling++) {
            struct {
                L1L2StabFrame frame;
                unsigned char later[32];
            } newer = {0};
            L1L2Stab *s = create_logged(small_config(4));
            L1L2StabFrame plain = frame_of(clip, 0);
            newer.frame = plain;
            newer.frame.struct_size = cases[i].size;
            newer.later[31] = (unsigned char)cases[i].later;
            clip->released[0] = 0;
            if (pulling) {
                ck_assert_int_eq(l1l2stab_push(s, &plain), L1L2STAB_OK);
                l1l2stab_finish(s);
                SynthPicture out = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
                memcpy(newer.frame.data, out.data, sizeof out.data);
                ck_assert_int_eq(l1l2stab_pull(s, &newer.frame, NULL), cases[i].result);
                synth_picture_free(&out);
            } else {
                ck_assert_int_eq(l1l2stab_push(s, &newer.frame), cases[i].result);
            }
            ck_assert_int_eq(last_message[0] != '\0', cases[i].result != L1L2STAB_OK);
            ck_assert_uint_eq(newer.frame.struct_size, cases[i].size);
            l1l2stab_free(&s);
            ck_assert_int_eq(clip->released[0], pulling || cases[i].result == L1L2STAB_OK);
        }
    free_clip(clip);
}
END_TEST

START_TEST(info_is_written_whole_and_its_reserved_bytes_are_zero)
{
    Clip *clip = new_clip(1, L1L2STAB_FORMAT_I420);
    L1L2Stab *s = create_logged(small_config(4));
    const L1L2StabFrame in = frame_of(clip, 0);
    L1L2StabInfo info;
    memset(&info, 0xa5, sizeof info); /* callers need not initialize it */
    ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    l1l2stab_finish(s);
    ck_assert_int_eq(l1l2stab_pull(s, NULL, &info), L1L2STAB_OK);
    for (size_t i = 0; i < sizeof info.reserved; i++)
        ck_assert_uint_eq(info.reserved[i], 0);
    for (int i = 0; i < 9; i++)
        ck_assert_double_eq(info.F[i], i % 4 == 0);
    l1l2stab_free(&s);
    free_clip(clip);
}
END_TEST

START_TEST(two_byte_components_need_even_addresses_and_strides)
{
    enum { STRIDE = WIDTH * 2 + 2, ROWS = HEIGHT * STRIDE };
    static uint16_t memory[ROWS + 8], written[ROWS + 8];
    L1L2StabConfig cfg = small_config(4);
    cfg.format = L1L2STAB_FORMAT_GRAY16_LE;
    if (format_left_out(cfg.format))
        return;
    const struct {
        int offset, stride;
        L1L2StabResult result;
    } cases[] = {{0, STRIDE, L1L2STAB_OK},
                 {2, STRIDE, L1L2STAB_OK},
                 {1, STRIDE, L1L2STAB_ERR_ARGUMENT},
                 {0, STRIDE + 1, L1L2STAB_ERR_ARGUMENT},
                 {1, STRIDE - 1, L1L2STAB_ERR_ARGUMENT}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        L1L2Stab *s = create_logged(cfg);
        L1L2StabFrame good = {.data = {(uint8_t *)memory}, .stride = {STRIDE}};
        const L1L2StabFrame frame = {.data = {(uint8_t *)memory + cases[i].offset}, .stride = {cases[i].stride}};
        L1L2StabFrame out = {.data = {(uint8_t *)written + cases[i].offset}, .stride = {cases[i].stride}};
        ck_assert_int_eq(l1l2stab_push(s, &frame), cases[i].result);
        ck_assert_int_eq(strstr(last_message, "must be even") != NULL, cases[i].result != L1L2STAB_OK);
        if (cases[i].result != L1L2STAB_OK)
            ck_assert_int_eq(l1l2stab_push(s, &good), L1L2STAB_OK);
        l1l2stab_finish(s);
        ck_assert_int_eq(l1l2stab_pull(s, &out, NULL), cases[i].result);
        if (cases[i].result != L1L2STAB_OK) { /* it is still there */
            good.data[0] = (uint8_t *)written;
            ck_assert_int_eq(l1l2stab_pull(s, &good, NULL), L1L2STAB_OK);
        }
        l1l2stab_free(&s);
    }
}
END_TEST

START_TEST(a_given_motion_must_be_one_that_a_camera_makes)
{
    const double d = hypot(WIDTH, HEIGHT);
    const struct {
        double m[9];
        L1L2StabResult result;
    } cases[] = {
        {{1, 0, 9.99 * d, 0, 1, 0, 0, 0, 1}, L1L2STAB_OK},
        {{1, 0, 10.01 * d, 0, 1, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
        {{1, 0, 1e30, 0, 1, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
        {{1, 0, 0, 0, 1, -1e308, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
        {{1.99, 0, 0, 0, 1.99, 0, 0, 0, 1}, L1L2STAB_OK},
        {{2.01, 0, 0, 0, 2.01, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
        {{0.51, 0, 0, 0, 0.51, 0, 0, 0, 1}, L1L2STAB_OK},
        {{0.49, 0, 0, 0, 0.49, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
        {{0, -1, 0, 1, 0, 0, 0, 0, 1}, L1L2STAB_OK},               /* a quarter turn */
        {{1, 0, 0, 0, -1, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},     /* mirrored */
        {{1, 1.6, 0, 0, 1, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},    /* shear */
        {{1e200, 0, 0, 0, 1e200, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
        {{NAN, 0, 0, 0, 1, 0, 0, 0, 1}, L1L2STAB_ERR_ARGUMENT},
    };
    L1L2StabConfig cfg = small_config(WINDOW);
    cfg.motion_model = L1L2STAB_MOTION_MODEL_AFFINE;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        L1L2Stab *s = create_logged(cfg);
        const L1L2StabFrame in = {.motion = cases[i].m};
        ck_assert_msg(l1l2stab_push(s, &in) == cases[i].result, "case %zu", i);
        ck_assert_int_eq(strstr(last_message, "motion") != NULL, cases[i].result != L1L2STAB_OK);
        l1l2stab_free(&s);
    }
}
END_TEST

static void assert_finite(const double m[9])
{
    for (int i = 0; i < 9; i++)
        ck_assert(isfinite(m[i]));
}

START_TEST(every_number_stays_finite_however_long_a_motion_goes_on)
{
    static const double motions[4][9] = {{2, 0, 0, 0, 2, 0, 0, 0, 1},
                                         {0.5, 0, 300, 0, 0.5, 300, 0, 0, 1},
                                         {1, 0, 1800, 0, 1, -200, 0, 0, 1},
                                         {2, 0, 0, 0, 0.5, 0, 0, 0, 1}};
    for (int i = 0; i < 4; i++) {
        L1L2StabConfig cfg = small_config(WINDOW);
        cfg.motion_model = L1L2STAB_MOTION_MODEL_AFFINE;
        L1L2Stab *s = create_logged(cfg);
        L1L2StabInfo info;
        for (int t = 0; t < 3000; t++) {
            const L1L2StabFrame in = {.motion = motions[i]};
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
            if (l1l2stab_pull(s, NULL, &info) != L1L2STAB_OK)
                continue;
            assert_finite(info.C);
            assert_finite(info.P);
            assert_finite(info.S);
            assert_finite(info.B);
        }
        l1l2stab_free(&s);
    }
}
END_TEST

START_TEST(a_given_motion_is_reported_as_it_was_given_to_the_bit)
{
    const L1L2StabConfig cfg = small_config(4);
    L1L2Stab *s = create_logged(cfg);
    L1L2Rng rng = l1l2_rng_seeded(1);
    static double given[2000][9];
    L1L2StabInfo info;
    for (int t = 0; t < 2000; t++) {
        const double a = 1.0 + l1l2_rng_next(&rng) * 0x1p-34, b = l1l2_rng_next(&rng) * 0x1p-34;
        const double x = l1l2_rng_next(&rng) / 3e8 - 7.0, y = t - 1000;
        const double m[9] = {a, -b, x, b, a, y, 0.0, 0.0, 1.0};
        memcpy(given[t], m, sizeof m);
        const L1L2StabFrame in = {.motion = given[t]};
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        if (l1l2stab_pull(s, NULL, &info) == L1L2STAB_OK && info.index > 0)
            ck_assert_mem_eq(info.F, given[info.index], sizeof info.F);
    }
    l1l2stab_free(&s);
}
END_TEST

/* Runs a clip, and gives its infos. */
static void run(L1L2Stab *s, Clip *clip, L1L2StabInfo *info)
{
    memset(clip->released, 0, sizeof clip->released);
    ck_assert_int_eq(stabilize(s, clip, info, NULL), clip->frames);
}

static void set_live(L1L2Stab *s)
{
    ck_assert_int_eq(l1l2stab_set_lambda(s, 2.0), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_set_crop_ratio(s, 0.95), L1L2STAB_OK);
    ck_assert_int_eq(l1l2stab_set_bypass(s, 1), L1L2STAB_OK);
}

START_TEST(a_reset_keeps_live_settings_in_full_effect_as_if_set_on_a_new_instance)
{
    const L1L2StabConfig cfg = small_config(WINDOW);
    static L1L2StabInfo fresh[FRAMES], again[FRAMES], other[FRAMES];
    Clip *clip = new_clip(FRAMES, cfg.format);
    L1L2Stab *s = create(&cfg);
    set_live(s);
    run(s, clip, fresh);
    l1l2stab_free(&s);

    s = create(&cfg);
    run(s, clip, other);
    l1l2stab_reset(s);
    for (int t = 0; t < WINDOW; t++) { /* the reset comes in the middle of all gradual changes */
        if (t == WINDOW / 2)
            set_live(s);
        const L1L2StabFrame in = frame_of(clip, t);
        ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
    }
    ck_assert_int_eq(l1l2stab_pull(s, NULL, NULL), L1L2STAB_OK);
    l1l2stab_reset(s);
    run(s, clip, again);
    l1l2stab_free(&s);
    for (int t = 0; t < FRAMES; t++) {
        ck_assert_mem_eq(again[t].B, fresh[t].B, sizeof again[t].B);
        ck_assert_mem_eq(again[t].warp, fresh[t].warp, sizeof again[t].warp);
        ck_assert_double_eq(again[t].lambda, 2.0);
        ck_assert_double_eq(again[t].crop_ratio, 0.95);
        ck_assert_double_eq(again[t].bypass, 1.0);
    }
    free_clip(clip);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("border");
    TCase *tcase = tcase_create("border");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, a_frame_carries_its_size_and_zero_stands_for_the_first_layout);
    tcase_add_test(tcase, info_is_written_whole_and_its_reserved_bytes_are_zero);
    tcase_add_test(tcase, two_byte_components_need_even_addresses_and_strides);
    tcase_add_test(tcase, a_given_motion_must_be_one_that_a_camera_makes);
    tcase_add_test(tcase, a_given_motion_is_reported_as_it_was_given_to_the_bit);
    tcase_add_test(tcase, every_number_stays_finite_however_long_a_motion_goes_on);
    tcase_add_test(tcase, a_reset_keeps_live_settings_in_full_effect_as_if_set_on_a_new_instance);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
