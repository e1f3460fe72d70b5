/* SPDX-License-Identifier: MIT */
#include <stdbool.h>

#include "checkx.h"
#include "common/rng.h"
#include "motion/phase_correlation.h"

enum { WIDE = 160, HIGH = 90, BLOBS = 150 };

static float a[WIDE * HIGH], b[WIDE * HIGH];

/* Soft dots, moved by (dx, dy); of those beyond the edges some come in. */
static void draw(float *out, double dx, double dy, double gain, double offset, int width, int height)
{
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (int i = 0; i < width * height; i++)
        out[i] = (float)offset;
    for (int k = 0; k < BLOBS; k++) {
        const double x = (double)l1l2_rng_below(&rng, 2000) / 1000.0 * width - 0.5 * width + dx;
        const double y = (double)l1l2_rng_below(&rng, 2000) / 1000.0 * height - 0.5 * height + dy;
        const double size = 1.5 + (double)l1l2_rng_below(&rng, 400) / 100.0, light = 40.0 + l1l2_rng_below(&rng, 60);
        for (int j = (int)(y - 3 * size); j <= (int)(y + 3 * size); j++)
            for (int i = (int)(x - 3 * size); i <= (int)(x + 3 * size); i++)
                if (i >= 0 && j >= 0 && i < width && j < height)
                    out[j * width + i] +=
                        (float)(gain * light * exp(-0.5 * ((i - x) * (i - x) + (j - y) * (j - y)) / (size * size)));
    }
}

START_TEST(the_highest_peak_is_the_shift)
{
    static const double moves[][2] = {{0.0, 0.0}, {1.3, -0.6}, {-5.0, 3.0}, {16.0, 7.0}, {-24.0, -13.5}};
    L1L2PhaseCorrelator *c = l1l2_motion_phase_new();
    for (int upright = 0; upright < 2; upright++) {
        const int width = upright ? HIGH : WIDE, height = upright ? WIDE : HIGH;
        for (size_t k = 0; k < sizeof moves / sizeof *moves; k++) {
            L1L2Shift shift[3];
            const double x = moves[k][upright], y = moves[k][!upright];
            draw(a, 0.0, 0.0, 1.0, 20.0, width, height);
            draw(b, x, y, 0.6, 60.0, width, height); /* and in another light */
            ck_assert_int_ge(l1l2_motion_phase_correlate(c, a, b, width, height, shift, 3), 1);
            ck_assert_near(shift[0].x * width, x, 0.5);
            ck_assert_near(shift[0].y * height, y, 0.5);
            ck_assert(shift[0].strength > 0.05 && shift[0].strength <= 1.0001);
        }
    }
    l1l2_motion_phase_free(c);
}
END_TEST

START_TEST(two_things_that_move_have_a_peak_each)
{
    L1L2PhaseCorrelator *c = l1l2_motion_phase_new();
    L1L2Shift shift[3];
    bool found[2] = {false, false};
    draw(a, 0.0, 0.0, 1.0, 20.0, WIDE, HIGH);
    draw(b, 9.0, 4.0, 1.0, 20.0, WIDE, HIGH);
    for (int y = 0; y < HIGH; y++) /* the left half stands still */
        for (int x = 0; x < WIDE / 2; x++)
            b[y * WIDE + x] = a[y * WIDE + x];
    const int peaks = l1l2_motion_phase_correlate(c, a, b, WIDE, HIGH, shift, 3);
    for (int i = 0; i < peaks; i++) {
        found[0] = found[0] || hypot(shift[i].x * WIDE, shift[i].y * HIGH) < 1.0;
        found[1] = found[1] || hypot(shift[i].x * WIDE - 9.0, shift[i].y * HIGH - 4.0) < 1.0;
    }
    ck_assert(found[0] && found[1]);
    l1l2_motion_phase_free(c);
}
END_TEST

START_TEST(a_flat_picture_has_no_strong_peak)
{
    L1L2PhaseCorrelator *c = l1l2_motion_phase_new();
    L1L2Shift shift[3];
    draw(a, 0.0, 0.0, 1.0, 20.0, WIDE, HIGH);
    for (int i = 0; i < WIDE * HIGH; i++)
        b[i] = 50.0f;
    const int peaks = l1l2_motion_phase_correlate(c, a, b, WIDE, HIGH, shift, 3);
    for (int i = 0; i < peaks; i++)
        ck_assert(shift[i].strength < 0.05);
    l1l2_motion_phase_free(c);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("phase_correlation");
    TCase *tests = tcase_create("phase_correlation");
    tcase_add_test(tests, the_highest_peak_is_the_shift);
    tcase_add_test(tests, two_things_that_move_have_a_peak_each);
    tcase_add_test(tests, a_flat_picture_has_no_strong_peak);
    suite_add_tcase(suite, tests);
    return checkx_run(suite);
}
