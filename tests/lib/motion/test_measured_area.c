/* SPDX-License-Identifier: MIT */
/* The map of what is measured, against its definition. */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "motion/measured_area.h"

enum { MOST = 40 };

static int below(L1L2Rng *rng, int n)
{
    return (int)l1l2_rng_below(rng, (uint32_t)n);
}

/* True if pixel (x, y) of a picture touches a zero of the mask: in units of 1 / (picture's side * mask's side). */
static bool touches_zero(const L1L2MeasuredArea *area, int x, int y, int width, int height)
{
    for (int j = 0; j < area->mask_height; j++)
        for (int i = 0; i < area->mask_width; i++)
            if (area->mask[j * area->mask_stride + i] == 0 && i * width < (x + 1) * area->mask_width &&
                (i + 1) * width > x * area->mask_width && j * height < (y + 1) * area->mask_height &&
                (j + 1) * height > y * area->mask_height)
                return true;
    return false;
}

START_TEST(a_pixel_is_measured_if_all_of_it_lies_in_the_region_and_on_the_mask)
{
    L1L2Rng rng = l1l2_rng_seeded(3);
    for (int round = 0; round < 300; round++) {
        uint8_t mask[MOST * (MOST + 5)], marked[MOST * MOST + 1];
        const int width = 1 + below(&rng, MOST), height = 1 + below(&rng, MOST), grid = 1 + below(&rng, 60);
        const int left = below(&rng, grid), right = left + 1 + below(&rng, grid - left);
        const int top = below(&rng, grid), bottom = top + 1 + below(&rng, grid - top);
        L1L2MeasuredArea area = {
            .region = {(double)left / grid, (double)top / grid, (double)(right - left) / grid,
                       (double)(bottom - top) / grid},
            .mask_width = 1 + below(&rng, MOST), .mask_height = 1 + below(&rng, MOST)};
        area.mask_stride = area.mask_width + below(&rng, 5);
        for (size_t i = 0; i < sizeof mask; i++)
            mask[i] = (uint8_t)(below(&rng, 20) == 0 ? 0 : 1 + below(&rng, 255));
        area.mask = round % 4 ? mask : NULL;
        marked[width * height] = 77;
        const double share = l1l2_motion_area_mark(&area, marked, width, height);
        int measured = 0;
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const bool within = x * grid >= left * width && (x + 1) * grid <= right * width &&
                                    y * grid >= top * height && (y + 1) * grid <= bottom * height;
                const bool expected = within && !(area.mask && touches_zero(&area, x, y, width, height));
                ck_assert_int_eq(marked[y * width + x], !expected);
                measured += expected;
            }
        ck_assert_int_eq(marked[width * height], 77);
        ck_assert_near(share, (double)measured / (width * height), 1e-12);
    }
}
END_TEST

START_TEST(the_whole_frame_is_told_from_less)
{
    const uint8_t mask = 1;
    L1L2MeasuredArea area = {.region = {0.0, 0.0, 1.0, 1.0}};
    ck_assert(l1l2_motion_area_is_whole(&area));
    for (int i = 0; i < 4; i++) {
        area.region[i] += i < 2 ? 0.01 : -0.01;
        ck_assert(!l1l2_motion_area_is_whole(&area));
        area.region[i] = i < 2 ? 0.0 : 1.0;
    }
    area.mask = &mask;
    ck_assert(!l1l2_motion_area_is_whole(&area));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("measured_area");
    TCase *tcase = tcase_create("measured_area");
    tcase_add_test(tcase, a_pixel_is_measured_if_all_of_it_lies_in_the_region_and_on_the_mask);
    tcase_add_test(tcase, the_whole_frame_is_told_from_less);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
