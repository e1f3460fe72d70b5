/* SPDX-License-Identifier: MIT */
/* Static overlays before a moving camera: burnt-in text over a scene of little contrast. */
#include "common/rng.h"
#include "motion/motion_fixture.h"

enum { WIDTH = 640, HEIGHT = 360, TEXT_W = 160, TEXT_H = 28 };

/* Bright blocks on black, about as dense as letters. */
static void burn_in(uint8_t *picture, int left, int top)
{
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (int y = 0; y < TEXT_H; y += 4)
        for (int x = 0; x < TEXT_W; x += 4) {
            const uint8_t level = l1l2_rng_below(&rng, 2) ? 235 : 16;
            for (int k = 0; k < 16; k++)
                picture[(top + y + k / 4) * WIDTH + left + x + k % 4] = level;
        }
}

START_TEST(burnt_in_text_is_not_taken_for_a_dark_scene_that_stands_still)
{
    static const double contrasts[] = {0.45, 0.15, 0.045}; /* of the scene's 256 levels */
    for (int i = 0; i < 3; i++) {
        SynthConfig cfg = synth_defaults();
        cfg.shake = 4.0, cfg.pan_x = 1.0, cfg.roll = 0.003;
        Run run = run_new(&cfg);
        uint8_t *picture = run.picture.data[0];
        double sum = 0.0;
        for (int t = 0; t < 50; t++) {
            double truth[9];
            synth_render_gray(run.synth, t, picture, WIDTH);
            for (int k = 0; k < WIDTH * HEIGHT; k++)
                picture[k] = (uint8_t)lrint(60.0 + contrasts[i] * (picture[k] - 128.0));
            burn_in(picture, 20, 320);
            burn_in(picture, 460, 16);
            const L1L2MotionResult result = push(run.motion, &run.picture, t == 0);
            synth_motion(run.synth, t, truth);
            L1L2Mat expected;
            memcpy(expected.m, truth, sizeof truth);
            const L1L2Mat found = l1l2_mat_rescale(result.F, hypot(WIDTH, HEIGHT));
            sum += corner_rms(&found, &expected, &cfg);
        }
        /* If the text won, the picture would be taken as still: an error of 2.6 px. */
        ck_assert_msg(sum / 49.0 < 0.3, "contrast %g: %g px off in the mean", contrasts[i], sum / 49.0);
        run_free(&run);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion_overlay");
    TCase *tcase = tcase_create("motion_overlay");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, burnt_in_text_is_not_taken_for_a_dark_scene_that_stands_still);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
