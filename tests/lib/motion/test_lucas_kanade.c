/* SPDX-License-Identifier: MIT */
/* Lucas-Kanade: accuracy on waves, points it must not follow, what it reads, and SIMD against plain C. */
#include <math.h>
#include <string.h>

#include "checkx.h"
#include "common/cpu.h"
#include "common/rng.h"
#include "motion/lucas_kanade.h"
#include "motion/lucas_kanade_patch.h"

enum {
    SIZE = 64,
    WIDE = SIZE + 2 * L1L2_LK_BORDER_X,
    HIGH = SIZE + 2 * L1L2_LK_BORDER_Y,
    FIRST = L1L2_LK_BORDER_Y * WIDE + L1L2_LK_BORDER_X
};

/* A level with its borders. */
typedef struct Picture {
    uint8_t grey[HIGH * WIDE];
    int16_t slope[HIGH * WIDE * 2];
    L1L2LkLevel level;
} Picture;

static Picture a, b;
static L1L2LkFunctions functions; /* of this processor */

static void set_level(Picture *p)
{
    p->level = (L1L2LkLevel){p->grey + FIRST, p->slope + 2 * FIRST, WIDE, 2 * WIDE, SIZE, SIZE};
}

/* Waves with periods of 17 to 29 px, moved by (dx, dy), with their exact slopes. */
static void draw(Picture *p, double dx, double dy)
{
    for (int i = 0; i < HIGH * WIDE; i++) {
        const double x = i % WIDE - L1L2_LK_BORDER_X - dx, y = i / WIDE - L1L2_LK_BORDER_Y - dy;
        const double u = 2 * M_PI / 17, v = 2 * M_PI / 23, w = 2 * M_PI / 29;
        p->grey[i] = (uint8_t)lround(128.0 + 40.0 * sin(u * x) + 40.0 * sin(v * y) + 40.0 * sin(w * (x + y)));
        const double both = w * 40.0 * cos(w * (x + y));
        p->slope[2 * i] = (int16_t)lround(32.0 * (u * 40.0 * cos(u * x) + both));
        p->slope[2 * i + 1] = (int16_t)lround(32.0 * (v * 40.0 * cos(v * y) + both));
    }
    set_level(p);
}

static void draw_flat(Picture *p)
{
    memset(p, 0, sizeof *p);
    memset(p->grey, 100, sizeof p->grey);
    set_level(p);
}

/* Iteration ends at a step of 0.03 px. What is left of the error has no preferred direction. */
START_TEST(points_are_found_to_a_few_hundredths_of_a_pixel)
{
    static const double moves[][2] = {{0.0, 0.0}, {0.25, -0.5}, {1.7, 2.3}, {-3.1, 1.9}, {0.01, 0.02}, {-2.0, -4.0}};
    enum { SIDE = 5, POINTS = SIDE * SIDE };
    draw(&a, 0.0, 0.0);
    for (size_t k = 0; k < sizeof moves / sizeof *moves; k++) {
        double x = 0.0, y = 0.0;
        draw(&b, moves[k][0], moves[k][1]);
        for (int i = 0; i < POINTS; i++) {
            const L1L2LkPoint from = {12.0f + 10.3f * (float)(i % SIDE), 12.0f + 9.7f * (float)(i / SIDE)};
            L1L2LkPoint to = from;
            ck_assert(l1l2_lk_follow(&functions, &a.level, &b.level, 1, from, &to));
            ck_assert_near(to.x, from.x + moves[k][0], 0.06);
            ck_assert_near(to.y, from.y + moves[k][1], 0.06);
            x += to.x - from.x, y += to.y - from.y;
        }
        ck_assert_near(x / POINTS, moves[k][0], 0.01);
        ck_assert_near(y / POINTS, moves[k][1], 0.01);
    }
}
END_TEST

START_TEST(the_search_starts_where_the_caller_says)
{
    draw(&a, 0.0, 0.0);
    draw(&b, 9.0, -8.0);
    const L1L2LkPoint from = {30.0f, 30.0f};
    L1L2LkPoint to = {38.0f, 23.0f};
    ck_assert(l1l2_lk_follow(&functions, &a.level, &b.level, 1, from, &to));
    ck_assert_near(to.x, 39.0, 0.06);
    ck_assert_near(to.y, 22.0, 0.06);
}
END_TEST

START_TEST(nothing_is_followed_where_all_is_flat)
{
    draw_flat(&a);
    draw_flat(&b);
    L1L2LkPoint to = {30.0f, 30.0f};
    ck_assert(!l1l2_lk_follow(&functions, &a.level, &b.level, 1, to, &to));
    ck_assert(to.x == 30.0f && to.y == 30.0f);
}
END_TEST

/* An edge does not tell how far along it a point went. */
START_TEST(nothing_is_followed_along_an_edge)
{
    for (int k = 0; k < 2; k++) {
        Picture *p = k ? &b : &a;
        for (int i = 0; i < HIGH * WIDE; i++) {
            p->grey[i] = (uint8_t)(2 * (i % WIDE));
            p->slope[2 * i] = 64, p->slope[2 * i + 1] = 0;
        }
        set_level(p);
    }
    L1L2LkPoint to = {30.0f, 30.0f};
    ck_assert(!l1l2_lk_follow(&functions, &a.level, &b.level, 1, to, &to));
}
END_TEST

START_TEST(a_point_outside_the_picture_or_not_a_number_is_not_followed)
{
    static const L1L2LkPoint out[] = {{-20.0f, 30.0f}, {30.0f, 90.0f}, {1e30f, 30.0f}, {30.0f, -1e30f}, {NAN, NAN}};
    draw(&a, 0.0, 0.0);
    draw(&b, 0.0, 0.0);
    const L1L2LkPoint inside = {30.0f, 30.0f};
    for (size_t k = 0; k < sizeof out / sizeof *out; k++) {
        L1L2LkPoint to = inside;
        ck_assert(!l1l2_lk_follow(&functions, &a.level, &b.level, 1, out[k], &to));
        to = out[k];
        ck_assert(!l1l2_lk_follow(&functions, &a.level, &b.level, 1, inside, &to));
    }
}
END_TEST

/* Points whose window hangs over each border. */
START_TEST(windows_read_nothing_beyond_the_borders)
{
    draw(&a, 0.0, 0.0);
    draw(&b, 0.4, 0.4);
    for (int i = 0; i <= 2 * SIZE; i++) {
        const float t = (float)i / 2 - 0.5f, last = SIZE - 0.51f;
        const L1L2LkPoint sides[] = {{t, -5.9f}, {t, last + 5.5f}, {-5.9f, t}, {last + 5.5f, t}};
        for (int k = 0; k < 4; k++) {
            L1L2LkPoint to = sides[k];
            l1l2_lk_follow(&functions, &a.level, &b.level, 1, sides[k], &to);
            ck_assert(isfinite(to.x) && isfinite(to.y));
        }
    }
}
END_TEST

/* Slopes and gray levels as far apart as Scharr's filter and bytes can be. */
START_TEST(every_processor_gives_the_sums_and_patches_of_plain_c)
{
    L1L2LkFunctions plain;
    l1l2_lk_functions_init(&plain, L1L2_CPU_PLAIN);
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (int round = 0; round < 200; round++) {
        const bool extreme = round % 2;
        for (int k = 0; k < 2; k++) {
            Picture *p = k ? &b : &a;
            for (int i = 0; i < HIGH * WIDE; i++) {
                const uint32_t any = l1l2_rng_next(&rng);
                p->grey[i] = (uint8_t)(round == 1 ? 255u * (uint32_t)k : extreme ? (any & 1) * 255 : any);
                for (int c = 0; c < 2; c++)
                    p->slope[2 * i + c] =
                        (int16_t)(round == 1 ? 4080 : extreme ? (any >> (8 + c) & 1 ? 4080 : -4080)
                                                              : (int)l1l2_rng_below(&rng, 8161) - 4080);
            }
            set_level(p);
        }
        L1L2LkPlace place = {.x = (int)l1l2_rng_below(&rng, SIZE + L1L2_LK_WINDOW) - L1L2_LK_WINDOW,
                               .y = (int)l1l2_rng_below(&rng, SIZE + L1L2_LK_WINDOW) - L1L2_LK_WINDOW};
        for (int i = 0, left = 1 << L1L2_LK_WEIGHT_BITS; i < 4; left -= place.weight[i++])
            place.weight[i] = (int16_t)(i == 3 ? left : (int)l1l2_rng_below(&rng, (uint32_t)left + 1));
        L1L2LkPatch plain_patch, patch;
        const L1L2LkSums plain_sums = plain.take(&a.level, &place, &plain_patch);
        const L1L2LkSums sums = functions.take(&a.level, &place, &patch);
        ck_assert_mem_eq(&sums, &plain_sums, sizeof sums);
        ck_assert_mem_eq(&patch, &plain_patch, sizeof patch);
        const L1L2LkSums plain_compared = plain.compare(&b.level, &place, &plain_patch);
        const L1L2LkSums compared = functions.compare(&b.level, &place, &patch);
        ck_assert_mem_eq(&compared, &plain_compared, sizeof compared);
    }
}
END_TEST

int main(void)
{
    l1l2_lk_functions_init(&functions, l1l2_cpu_features());
    Suite *suite = suite_create("Lucas-Kanade");
    TCase *tc = tcase_create("Lucas-Kanade");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, points_are_found_to_a_few_hundredths_of_a_pixel);
    tcase_add_test(tc, the_search_starts_where_the_caller_says);
    tcase_add_test(tc, nothing_is_followed_where_all_is_flat);
    tcase_add_test(tc, nothing_is_followed_along_an_edge);
    tcase_add_test(tc, a_point_outside_the_picture_or_not_a_number_is_not_followed);
    tcase_add_test(tc, windows_read_nothing_beyond_the_borders);
    tcase_add_test(tc, every_processor_gives_the_sums_and_patches_of_plain_c);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
