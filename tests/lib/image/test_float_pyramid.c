/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "image/float_pyramid.h"

enum { MAX_WIDTH = 900, MAX_HEIGHT = 700 };

static uint8_t picture[MAX_HEIGHT * MAX_WIDTH];

static void build(L1L2FloatPyramid *p)
{
    l1l2_image_float_pyramid_build(p, picture, MAX_WIDTH);
}

START_TEST(a_flat_picture_is_flat_at_every_level)
{
    L1L2FloatPyramid *p = l1l2_image_float_pyramid_new(641, 359);
    memset(picture, 77, sizeof picture);
    build(p);
    ck_assert_int_eq(p->levels, 4);
    for (int i = 0; i < p->levels; i++)
        for (int k = 0; k < p->level[i].width * p->level[i].height; k++)
            ck_assert_near(p->level[i].sample[k], 77.0, 1e-4);
    l1l2_image_float_pyramid_free(p);
}
END_TEST

/* A ramp is its own blur: each sample has the level of its center. */
START_TEST(samples_lie_where_the_header_says)
{
    static const int sizes[][2] = {{640, 360}, {641, 359}, {320, 180}, {900, 700}, {200, 640}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        L1L2FloatPyramid *p = l1l2_image_float_pyramid_new(sizes[k][0], sizes[k][1]);
        for (int y = 0; y < MAX_HEIGHT; y++)
            for (int x = 0; x < MAX_WIDTH; x++)
                picture[y * MAX_WIDTH + x] = (uint8_t)((3 * x + 4 * y) / 32);
        build(p);
        ck_assert_int_ge(p->levels, 3);
        for (int i = 0; i < p->levels; i++) {
            const L1L2FloatLevel *l = p->level + i;
            ck_assert_int_eq(l->width, sizes[k][0] / l->step);
            ck_assert_int_eq(l->height, sizes[k][1] / l->step);
            const int margin = l->width > 20 && l->height > 20 ? 6 : 4;
            for (int y = margin; y < l->height - margin; y++)
                for (int x = margin; x < l->width - margin; x++) {
                    const double at_x = (x + 0.5) * l->step - 0.5, at_y = (y + 0.5) * l->step - 0.5;
                    /* 0.5 is the mean of what rounding down takes off. 0.3 is a margin for the pattern that rounding
                     * leaves. */
                    ck_assert_near(l->sample[y * l->width + x], (3.0 * at_x + 4.0 * at_y) / 32 - 0.484, 0.6);
                }
        }
        l1l2_image_float_pyramid_free(p);
    }
}
END_TEST

START_TEST(a_negative_stride_turns_the_picture_over)
{
    L1L2FloatPyramid *p = l1l2_image_float_pyramid_new(100, 60), *q = l1l2_image_float_pyramid_new(100, 60);
    for (int i = 0; i < MAX_HEIGHT * MAX_WIDTH; i++)
        picture[i] = (uint8_t)((unsigned)i * 2654435761u >> 24);
    build(p);
    l1l2_image_float_pyramid_build(q, picture + 59 * MAX_WIDTH, -MAX_WIDTH);
    for (int y = 0; y < 60; y++)
        for (int x = 0; x < 100; x++)
            ck_assert_near(p->level[0].sample[y * 100 + x], q->level[0].sample[(59 - y) * 100 + x], 1e-4);
    l1l2_image_float_pyramid_free(p);
    l1l2_image_float_pyramid_free(q);
}
END_TEST

START_TEST(the_largest_level_is_limited_and_the_smallest_too)
{
    static const int sizes[][2] = {{16, 16}, {900, 16}, {33, 700}, {400, 400}, {401, 300}, {900, 700}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        L1L2FloatPyramid *p = l1l2_image_float_pyramid_new(sizes[k][0], sizes[k][1]);
        ck_assert_int_ge(p->levels, 1);
        build(p);
        for (int i = 0; i < p->levels; i++) {
            ck_assert_int_ge(p->level[i].width, L1L2_FLOAT_PYRAMID_MIN_SIDE);
            ck_assert_int_ge(p->level[i].height, L1L2_FLOAT_PYRAMID_MIN_SIDE);
        }
        l1l2_image_float_pyramid_free(p);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("float_pyramid");
    TCase *tests = tcase_create("float_pyramid");
    tcase_add_test(tests, a_flat_picture_is_flat_at_every_level);
    tcase_add_test(tests, samples_lie_where_the_header_says);
    tcase_add_test(tests, a_negative_stride_turns_the_picture_over);
    tcase_add_test(tests, the_largest_level_is_limited_and_the_smallest_too);
    suite_add_tcase(suite, tests);
    return checkx_run(suite);
}
