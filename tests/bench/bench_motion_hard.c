/* SPDX-License-Identifier: MIT */
/*
 * The motion of the synthetic clips in which corners fail, as the library measures it, against the truth.
 *
 * For each case and noise, over three seeds: the rms and the worst error of F_t, px at the frame's corners; frames
 * whose motion was not measured; frames measured from whole pictures; frames whose motion a bridge changed later; and
 * `behind`: the worst error of the motion from the last sharp frame before a gap of blurred ones to the first sharp one
 * behind it.
 *
 * usage: bench_motion_hard [CASE [NOISE]]     default: all cases of synth_hard.h, noise of sigma 2, 5 and 10
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion/motion.h"
#include "synth_hard.h"

enum { WIDTH = 640, HEIGHT = 360, FRAMES = 60, SEEDS = 3 };

typedef struct Tally {
    int frames, lost, aligned, bridged;
    double squares, worst, behind;
} Tally;

static double corner_error(const L1L2Mat *F, const L1L2Mat *G)
{
    return l1l2_mat_corner_distance(F, G, 0.5 * WIDTH, 0.5 * HEIGHT);
}

static bool is_blurred(const SynthHard *clip, int t)
{
    double x, y;
    synth_hard_blur(clip, t, &x, &y);
    return hypot(x, y) > 6.0;
}

static void count_errors(const SynthHard *clip, const L1L2Mat *F, const L1L2Mat *truth, Tally *tally)
{
    L1L2Mat chain = l1l2_mat_identity(), true_chain = chain; /* from the last sharp frame on */
    int sharp = 0;
    for (int t = 1; t < FRAMES; t++) {
        const double error = corner_error(&F[t], &truth[t]);
        tally->frames++;
        tally->squares += error * error;
        tally->worst = fmax(tally->worst, error);
        chain = l1l2_mat_mul(chain, F[t]);
        true_chain = l1l2_mat_mul(true_chain, truth[t]);
        if (is_blurred(clip, t))
            continue;
        if (t - sharp > 1)
            tally->behind = fmax(tally->behind, corner_error(&chain, &true_chain));
        chain = true_chain = l1l2_mat_identity();
        sharp = t;
    }
}

static void run(const SynthHard *clip, Tally *tally)
{
    static uint8_t gray[WIDTH * HEIGHT];
    const L1L2MotionConfig cfg = {
        .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8),
        .width = WIDTH,
        .height = HEIGHT,
        .analysis_size = WIDTH,
        .model = L1L2STAB_MOTION_MODEL_SIMILARITY,
        .seed = 1,
    };
    L1L2Motion *motion;
    if (l1l2_motion_create(&motion, &cfg) != L1L2STAB_OK)
        abort();
    L1L2Mat F[FRAMES], truth[FRAMES];
    for (int t = 0; t < FRAMES; t++) {
        L1L2MotionResult r;
        synth_hard_render(clip, t, gray, WIDTH);
        if (l1l2_motion_push(motion, gray, WIDTH, t == 0, &r) != L1L2STAB_OK)
            abort();
        F[t] = l1l2_mat_rescale(r.F, hypot(WIDTH, HEIGHT));
        if (t == 0)
            continue;
        synth_hard_motion(clip, t, 1, truth[t].m);
        for (int i = 0; i < r.bridged; i++)
            F[t - r.bridged + i] = l1l2_mat_rescale(r.bridged_F[i], hypot(WIDTH, HEIGHT));
        tally->lost += r.model < L1L2STAB_MOTION_SOURCE_GIVEN;
        tally->aligned += r.model == L1L2STAB_MOTION_SOURCE_ALIGNMENT;
        tally->bridged += r.bridged;
    }
    count_errors(clip, F, truth, tally);
    l1l2_motion_free(motion);
}

static void bench_case(const SynthHardCase *c, const double *noises, int count)
{
    Tally tally[3] = {{0}};
    for (int seed = 1; seed <= SEEDS; seed++) {
        SynthHardConfig cfg = c->cfg;
        cfg.seed = (uint64_t)seed;
        SynthHard *clip = synth_hard_new(&cfg);
        for (int n = 0; n < count; n++) {
            cfg.noise = noises[n];
            synth_hard_change(clip, &cfg);
            run(clip, &tally[n]);
        }
        synth_hard_free(clip);
    }
    printf("%-20s", c->name);
    for (int n = 0; n < count; n++) {
        const Tally *y = &tally[n];
        printf(" | %2.0f: %6.3f %6.2f lost %3d whole %3d bridged %3d", noises[n],
               sqrt(y->squares / y->frames), y->worst, y->lost, y->aligned, y->bridged);
        if (y->behind > 0.0)
            printf(" behind %5.2f", y->behind);
    }
    printf("\n");
    fflush(stdout);
}

int main(int argc, char **argv)
{
    static const double noises[] = {2.0, 5.0, 10.0};
    const double one = argc > 2 ? atof(argv[2]) : 0.0;
    printf("sigma: rms px, worst px, of %d frames\n", SEEDS * (FRAMES - 1));
    for (int i = 0; i < synth_hard_case_count; i++)
        if (argc < 2 || strcmp(argv[1], "all") == 0 || strcmp(argv[1], synth_hard_cases[i].name) == 0)
            bench_case(&synth_hard_cases[i], argc > 2 ? &one : noises, argc > 2 ? 1 : 3);
    return EXIT_SUCCESS;
}
