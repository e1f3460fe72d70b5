/* SPDX-License-Identifier: MIT */
/* The range of levels that deep pictures use. */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "formats.h"
#include "image/level_range.h"

enum { W = 160, H = 120 };

static uint16_t picture[W * H];

/* Levels from low to high, in equal numbers. */
static void fill(int low, int high)
{
    for (int i = 0; i < W * H; i++)
        picture[i] = (uint16_t)(low + (i * 7919) % (high - low + 1));
}

static L1L2Levels push_as(L1L2LevelRange *range, L1L2StabFormat format)
{
    return l1l2_image_levels_push(range, l1l2_image_format_info(format), (const uint8_t *)picture, 2 * W, W, H);
}

static L1L2Levels push(L1L2LevelRange *range)
{
    return push_as(range, L1L2STAB_FORMAT_GRAY16_LE);
}

static bool is_full(L1L2Levels levels, L1L2StabFormat format)
{
    return l1l2_image_levels_equal(levels, l1l2_image_levels_full(l1l2_image_format_info(format)));
}

START_TEST(a_picture_of_few_levels_is_stretched_to_them_with_a_margin)
{
    for (int span = 100; span <= 4000; span *= 2) {
        L1L2LevelRange range = {0};
        fill(7000, 7000 + span);
        const L1L2Levels levels = push(&range);
        ck_assert_int_le(levels.low, 7000);
        ck_assert_int_ge(levels.low, 7000 - span / 2);
        ck_assert_int_ge(levels.high, 7000 + span);
        ck_assert_int_le(levels.high, 7000 + span + span / 2);
    }
}
END_TEST

START_TEST(a_picture_that_uses_its_range_is_left_as_it_is)
{
    L1L2LevelRange range = {0};
    fill(0, 65535);
    ck_assert(is_full(push(&range), L1L2STAB_FORMAT_GRAY16_LE));
    memset(&range, 0, sizeof range);
    fill(7000, 16000);
    ck_assert(is_full(push(&range), L1L2STAB_FORMAT_GRAY16_LE));
    memset(&range, 0, sizeof range);
    fill(64, 400);
    ck_assert(is_full(push_as(&range, L1L2STAB_FORMAT_I420_10LE), L1L2STAB_FORMAT_I420_10LE));
}
END_TEST

START_TEST(eight_bits_are_left_as_they_are)
{
    L1L2LevelRange range = {0};
    fill(7000, 7200);
    ck_assert(is_full(push_as(&range, L1L2STAB_FORMAT_GRAY8), L1L2STAB_FORMAT_GRAY8));
}
END_TEST

START_TEST(an_empty_picture_is_left_as_it_is)
{
    L1L2LevelRange range = {0};
    fill(7000, 7030);
    ck_assert(is_full(push(&range), L1L2STAB_FORMAT_GRAY16_LE));
    memset(&range, 0, sizeof range);
    fill(7000, 7000);
    ck_assert(is_full(push(&range), L1L2STAB_FORMAT_GRAY16_LE));
}
END_TEST

START_TEST(a_few_dead_pixels_do_not_matter)
{
    L1L2LevelRange range = {0}, spotted = {0};
    fill(7000, 7800);
    const L1L2Levels clean = push(&range);
    L1L2Rng rng = l1l2_rng_seeded(1);
    for (int i = 0; i < W * H / 250; i++)
        picture[l1l2_rng_below(&rng, W * H)] = i % 2 ? 65535 : 0;
    const L1L2Levels levels = push(&spotted);
    ck_assert_int_ge(levels.low, clean.low - 100);
    ck_assert_int_le(levels.high, clean.high + 100);
}
END_TEST

START_TEST(the_range_depends_on_the_last_30_pictures_only)
{
    L1L2LevelRange range = {0}, later = {0};
    L1L2Rng rng = l1l2_rng_seeded(1);
    for (int t = 0; t < 100; t++) {
        const int low = 7000 + (int)l1l2_rng_below(&rng, 500), span = 100 + (int)l1l2_rng_below(&rng, 900);
        fill(low, low + span);
        const L1L2Levels levels = push(&range);
        if (t < 40)
            continue;
        const L1L2Levels same = push(&later);
        if (t >= 40 + L1L2_LEVEL_FRAMES - 1)
            ck_assert(l1l2_image_levels_equal(levels, same));
    }
}
END_TEST

START_TEST(colors_are_mixed_to_gray)
{
    static uint16_t colors[4 * W * H];
    for (int i = 0; i < W * H; i++) {
        colors[4 * i] = (uint16_t)(i * 31); /* alpha: any level */
        for (int k = 1; k < 4; k++)
            colors[4 * i + k] = (uint16_t)(7000 + (i * 7919) % 801);
    }
    L1L2LevelRange range = {0}, gray = {0};
    fill(7000, 7800);
    const L1L2Levels expected = push(&gray);
    const L1L2Levels levels = l1l2_image_levels_push(&range, l1l2_image_format_info(L1L2STAB_FORMAT_ARGB64_LE),
                                                     (const uint8_t *)colors, 8 * W, W, H);
    ck_assert(l1l2_image_levels_equal(levels, expected));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("level range");
    TCase *tc = tcase_create("levels");
    tcase_add_test(tc, eight_bits_are_left_as_they_are);
    suite_add_tcase(suite, tc);
    if (format_left_out(L1L2STAB_FORMAT_GRAY16_LE))
        return checkx_run(suite);
    tcase_add_test(tc, a_picture_of_few_levels_is_stretched_to_them_with_a_margin);
    tcase_add_test(tc, a_picture_that_uses_its_range_is_left_as_it_is);
    tcase_add_test(tc, an_empty_picture_is_left_as_it_is);
    tcase_add_test(tc, a_few_dead_pixels_do_not_matter);
    tcase_add_test(tc, the_range_depends_on_the_last_30_pictures_only);
    tcase_add_test(tc, colors_are_mixed_to_gray);
    return checkx_run(suite);
}
