/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "checkx.h"
#include "config.h"

static char last_message[512];

static void remember(void *cookie, L1L2StabLogLevel level, const char *message)
{
    ck_assert_int_eq(level, L1L2STAB_LOG_ERROR);
    snprintf(last_message, sizeof last_message, "%s", message);
}

static const uint8_t one_mask[8] = {1, 1, 1, 1, 1, 1, 0, 0};

static L1L2StabConfig valid_config(void)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = 640;
    cfg.height = 360;
    cfg.logger.write = remember;
    cfg.mask = one_mask;
    cfg.mask_stride = cfg.mask_width = 8;
    cfg.mask_height = 1;
    return cfg;
}

START_TEST(the_defaults_need_format_and_size_alone)
{
    const L1L2StabConfig cfg = valid_config();
    ck_assert_int_eq(l1l2stab_config_delay(&cfg), 150);
    ck_assert_near(cfg.lambda, 0.5, 0.0);
    L1L2StabConfig bare;
    l1l2stab_config_init(&bare, sizeof bare);
    ck_assert_int_eq(l1l2stab_config_delay(&bare), L1L2STAB_ERR_UNSUPPORTED);
}
END_TEST

START_TEST(overlap_zero_is_chosen_by_join_and_fits_every_window)
{
    for (int window = 4; window <= 900; window++)
        for (int join = 0; join < 2; join++) {
            L1L2StabConfig cfg = valid_config(), resolved;
            cfg.window = window;
            cfg.join = (L1L2StabJoin)join;
            const L1L2StabResult result = l1l2_config_resolve(&cfg, &resolved);
            if (join == L1L2STAB_JOIN_BLEND && window < 6) {
                ck_assert_int_eq(result, L1L2STAB_ERR_ARGUMENT);
                continue;
            }
            ck_assert_int_eq(result, L1L2STAB_OK);
            ck_assert_int_ge(resolved.overlap, 3);
            ck_assert_int_lt(resolved.overlap, window);
            if (join == L1L2STAB_JOIN_BLEND)
                ck_assert_int_le(2 * resolved.overlap, window);
        }
    L1L2StabConfig cfg = valid_config(), resolved;
    cfg.join = L1L2STAB_JOIN_BLEND;
    ck_assert_int_eq(l1l2_config_resolve(&cfg, &resolved), L1L2STAB_OK);
    ck_assert_int_eq(resolved.overlap, 30); /* the paper's */
}
END_TEST

/* Sets one field, and expects a refusal whose message names it. */
#define REFUSED(field, value)                                                          \
    do {                                                                               \
        L1L2StabConfig cfg_ = valid_config();                                          \
        L1L2Stab *s_ = (L1L2Stab *)&cfg_;                                              \
        cfg_.field = value;                                                            \
        last_message[0] = '\0';                                                        \
        ck_assert_int_eq(l1l2stab_create(&s_, &cfg_), L1L2STAB_ERR_ARGUMENT);          \
        ck_assert_ptr_null(s_);                                                        \
        ck_assert_msg(strstr(last_message, #field), "\"%s\" does not name " #field, last_message); \
    } while (0)

START_TEST(every_field_out_of_range_is_refused_by_name)
{
    REFUSED(width, 15);
    REFUSED(width, 16385);
    REFUSED(height, 2);
    REFUSED(height, -1);
    REFUSED(frame_rate, -1.0);
    REFUSED(frame_rate, NAN);
    REFUSED(chroma_site, (L1L2StabChromaSite)9);
    REFUSED(lambda, -0.1);
    REFUSED(lambda, NAN);
    REFUSED(lambda, HUGE_VAL);
    REFUSED(crop_ratio, 0.4);
    REFUSED(crop_ratio, 1.0);
    REFUSED(window, 3);
    REFUSED(window, 901);
    REFUSED(window, INT_MIN); /* what depends on the window is not computed from it */
    REFUSED(window, -1307841428);
    REFUSED(window, INT_MAX);
    REFUSED(overlap, 2);
    REFUSED(overlap, 150);
    REFUSED(overlap, -3);
    REFUSED(join, (L1L2StabJoin)2);
    REFUSED(interpolation, (L1L2StabInterpolation)3);
    REFUSED(output_size, (L1L2StabOutputSize)2);
    REFUSED(analysis_size, 100);
    REFUSED(threads, 65);
    REFUSED(pixel_aspect, 0.0);
    REFUSED(pixel_aspect, 10.1);
    REFUSED(pixel_aspect, NAN);
    REFUSED(mask_width, 0);
    REFUSED(mask_width, 16385);
    REFUSED(mask_height, -3);
    REFUSED(mask_height, 16385);
    REFUSED(mask_stride, 7);
    REFUSED(mask_stride, -8);
}
END_TEST

START_TEST(a_region_that_is_not_part_of_the_frame_is_refused_with_its_numbers)
{
    static const double bad[][4] = {
        {-0.1, 0.0, 0.5, 0.5}, {0.0, -1e-6, 0.5, 0.5}, {0.0, 0.0, 0.12, 1.0},  {0.0, 0.0, 1.0, 0.1},
        {0.0, 0.0, 0.0, 0.0},  {0.6, 0.0, 0.5, 1.0},   {0.0, 0.9, 1.0, 0.2},   {NAN, 0.0, 1.0, 1.0},
        {0.0, 0.0, NAN, 1.0},  {0.0, 0.0, 1.0, NAN},   {0.0, 0.0, 1e300, 1.0}, {0.0, NAN, 1.0, 1.0}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        L1L2StabConfig cfg = valid_config();
        memcpy(cfg.region, bad[i], sizeof bad[i]);
        last_message[0] = '\0';
        ck_assert_int_eq(l1l2stab_config_delay(&cfg), L1L2STAB_ERR_ARGUMENT);
        char number[32];
        snprintf(number, sizeof number, "%g", bad[i][2]);
        ck_assert_msg(strstr(last_message, "region is") && strstr(last_message, number), "\"%s\"", last_message);
    }
    static const double good[][4] = {{0.0, 0.0, 1.0, 1.0}, {0.1 + 0.2, 0.0, 0.7, 1.0}, {0.875, 0.875, 0.125, 0.125}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        L1L2StabConfig cfg = valid_config();
        memcpy(cfg.region, good[i], sizeof good[i]);
        ck_assert_int_eq(l1l2stab_config_delay(&cfg), 150);
    }
}
END_TEST

START_TEST(blend_wants_twice_the_overlap_in_the_window)
{
    L1L2StabConfig cfg = valid_config();
    cfg.join = L1L2STAB_JOIN_BLEND;
    cfg.overlap = 75;
    ck_assert_int_eq(l1l2stab_config_delay(&cfg), 150);
    cfg.overlap = 76;
    ck_assert_int_eq(l1l2stab_config_delay(&cfg), L1L2STAB_ERR_ARGUMENT);
    ck_assert(strstr(last_message, "75"));
}
END_TEST

START_TEST(the_output_size_follows_the_crop)
{
    L1L2StabConfig cfg = valid_config();
    int w, h;
    ck_assert_int_eq(l1l2stab_config_output_size(&cfg, &w, &h), L1L2STAB_OK);
    ck_assert(w == 640 && h == 360);
    cfg.output_size = L1L2STAB_OUTPUT_SIZE_CROP;
    cfg.crop_ratio = 0.8;
    ck_assert_int_eq(l1l2stab_config_output_size(&cfg, &w, &h), L1L2STAB_OK);
    ck_assert(w == 512 && h == 288);
    for (double c = 0.5; c <= 0.99; c += 0.01) {
        cfg.crop_ratio = c;
        cfg.width = 641, cfg.height = 359;
        ck_assert_int_eq(l1l2stab_config_output_size(&cfg, &w, &h), L1L2STAB_OK);
        ck_assert(w % 2 == 0 && h % 2 == 0 && w <= c * 641 && h <= c * 359 && w > c * 641 - 2 && h > c * 359 - 2);
    }
}
END_TEST

START_TEST(a_config_from_an_older_header_gets_defaults_for_what_it_lacks)
{
    L1L2StabConfig cfg = valid_config(), resolved;
    cfg.struct_size = offsetof(L1L2StabConfig, threads);
    cfg.threads = 1234; /* beyond its end */
    memset(&cfg.logger, 0xff, sizeof cfg.logger);
    ck_assert_int_eq(l1l2_config_resolve(&cfg, &resolved), L1L2STAB_OK);
    ck_assert_int_eq(resolved.threads, 0);
    ck_assert_ptr_null(resolved.logger.write);
    cfg = valid_config();
    cfg.struct_size = offsetof(L1L2StabConfig, region); /* what a program of version 0.1 or 0.2 has */
    memset(cfg.region, 0xff, sizeof cfg - offsetof(L1L2StabConfig, region));
    ck_assert_int_eq(l1l2_config_resolve(&cfg, &resolved), L1L2STAB_OK);
    ck_assert(resolved.region[0] == 0.0 && resolved.region[1] == 0.0);
    ck_assert(resolved.region[2] == 1.0 && resolved.region[3] == 1.0);
    ck_assert_ptr_null(resolved.mask);
}
END_TEST

START_TEST(a_config_from_a_newer_header_is_accepted_if_it_sets_nothing_new)
{
    struct {
        L1L2StabConfig cfg;
        unsigned char later[40];
    } newer;
    L1L2StabConfig resolved;
    l1l2stab_config_init(&newer.cfg, sizeof newer); /* clears what this version does not know */
    newer.cfg.format = L1L2STAB_FORMAT_I420;
    newer.cfg.width = 640, newer.cfg.height = 360;
    newer.cfg.logger.write = remember;
    ck_assert_int_eq(l1l2_config_resolve(&newer.cfg, &resolved), L1L2STAB_OK);
    ck_assert_uint_eq(resolved.struct_size, sizeof resolved);
    newer.later[39] = 1;
    last_message[0] = '\0';
    ck_assert_int_eq(l1l2_config_resolve(&newer.cfg, &resolved), L1L2STAB_ERR_UNSUPPORTED);
    ck_assert(strstr(last_message, "update the library"));
    const size_t garbage[] = {0, 1, sizeof(size_t) - 1, 4097, 0xdeadbeef, (size_t)-1};
    for (size_t i = 0; i < sizeof garbage / sizeof *garbage; i++) {
        newer.cfg.struct_size = garbage[i];
        ck_assert_int_eq(l1l2_config_resolve(&newer.cfg, &resolved), L1L2STAB_ERR_ARGUMENT);
    }
}
END_TEST

START_TEST(every_result_has_a_text_of_its_own)
{
    for (int r = L1L2STAB_ERR_BACKEND; r <= L1L2STAB_EOS; r++)
        ck_assert_str_ne(l1l2stab_strerror((L1L2StabResult)r), "unknown result");
    ck_assert_str_eq(l1l2stab_strerror((L1L2StabResult)99), "unknown result");
    ck_assert_int_eq(l1l2stab_create(NULL, NULL), L1L2STAB_ERR_ARGUMENT);
    ck_assert_int_eq(l1l2stab_config_delay(NULL), L1L2STAB_ERR_ARGUMENT);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("config");
    TCase *tcase = tcase_create("config");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_defaults_need_format_and_size_alone);
    tcase_add_test(tcase, overlap_zero_is_chosen_by_join_and_fits_every_window);
    tcase_add_test(tcase, every_field_out_of_range_is_refused_by_name);
    tcase_add_test(tcase, a_region_that_is_not_part_of_the_frame_is_refused_with_its_numbers);
    tcase_add_test(tcase, blend_wants_twice_the_overlap_in_the_window);
    tcase_add_test(tcase, the_output_size_follows_the_crop);
    tcase_add_test(tcase, a_config_from_an_older_header_gets_defaults_for_what_it_lacks);
    tcase_add_test(tcase, a_config_from_a_newer_header_is_accepted_if_it_sets_nothing_new);
    tcase_add_test(tcase, every_result_has_a_text_of_its_own);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
