/* SPDX-License-Identifier: MIT */
/*
 * Direct alignment on the synthetic clips in which corners fail: the error against the truth, which alignments are
 * accepted, and what it costs.
 *
 * usage: bench_alignment [CASE]     default: all cases of synth_hard.h, noise of sigma 2, 5 and 10, three seeds
 *
 * Errors are in pixels of a picture 640 wide, at the frame's corners: the rms and the worst of the accepted ones, and
 * how many are accepted, of how many. `behind` is the error of the sharp frames after a gap of blurred ones, when they
 * are aligned with the sharp frame before the gap.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "motion/direct_alignment.h"
#include "motion/motion_bridge.h"
#include "synth_hard.h"

enum { WIDTH = 640, HEIGHT = 360, FRAMES = 13, SEEDS = 3 };

typedef struct Tally {
    int frames, accepted, bridges;
    double squares, worst, worst_behind;
    double prepare_ms, align_ms;
    int alignments;
} Tally;

typedef struct Bench {
    SynthHard *clip;
    L1L2DirectAlignment *aligner;
    L1L2FloatPyramid *picture[FRAMES];
} Bench;

static double cpu_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static double error_of(const Bench *b, const L1L2Alignment *r, int t, int back)
{
    const L1L2Mat F = l1l2_mat_rescale(r->F, hypot(WIDTH, HEIGHT));
    double G[9], sum = 0.0;
    synth_hard_motion(b->clip, t, back, G);
    for (int k = 0; k < 4; k++) {
        const double x = (k & 1 ? 0.5 : -0.5) * WIDTH, y = (k & 2 ? 0.5 : -0.5) * HEIGHT;
        const double u = (F.m[0] - G[0]) * x + (F.m[1] - G[1]) * y + F.m[2] - G[2];
        const double v = (F.m[3] - G[3]) * x + (F.m[4] - G[4]) * y + F.m[5] - G[5];
        sum += u * u + v * v;
    }
    return sqrt(0.25 * sum);
}

static L1L2Alignment align(const Bench *b, int t, int back, const L1L2Mat *expected, Tally *tally)
{
    const L1L2AlignmentGuide guide = {.start = {*expected}, .starts = 1};
    L1L2Alignment r;
    const double start = cpu_ms();
    l1l2_motion_align(b->aligner, b->picture[t], b->picture[t - back], &guide, &r);
    tally->align_ms += cpu_ms() - start;
    tally->alignments++;
    return r;
}

static bool blurred(const Bench *b, int t)
{
    double x, y;
    synth_hard_blur(b->clip, t, &x, &y);
    return hypot(x, y) > 6.0;
}

static void run(Bench *b, Tally *tally)
{
    static uint8_t gray[WIDTH * HEIGHT];
    L1L2Mat last = l1l2_mat_identity();
    int sharp = 0; /* the last sharp frame */
    for (int t = 0; t < FRAMES; t++) {
        synth_hard_render(b->clip, t, gray, WIDTH);
        const double start = cpu_ms();
        l1l2_image_float_pyramid_build(b->picture[t], gray, WIDTH);
        tally->prepare_ms += cpu_ms() - start;
        if (t == 0)
            continue;
        const L1L2Alignment r = align(b, t, 1, &last, tally);
        const double error = error_of(b, &r, t, 1);
        tally->frames++;
        if (l1l2_motion_align_accepts(&r.evidence)) {
            last = r.F;
            tally->accepted++;
            tally->squares += error * error;
            tally->worst = fmax(tally->worst, error);
        }
        if (blurred(b, t))
            continue;
        if (t - sharp > 1 && t - sharp <= L1L2_BRIDGE_MAX_FRAMES) {
            const L1L2Mat identity = l1l2_mat_identity();
            const L1L2Alignment over = align(b, t, t - sharp, &identity, tally);
            tally->bridges++;
            tally->worst_behind = fmax(tally->worst_behind, error_of(b, &over, t, t - sharp));
        }
        sharp = t;
    }
}

static void bench_case(const SynthHardCase *c, Tally *all)
{
    static const double noises[] = {2.0, 5.0, 10.0};
    printf("%-18s", c->name);
    Tally tally[3] = {{0}};
    for (int seed = 1; seed <= SEEDS; seed++) {
        SynthHardConfig cfg = c->cfg;
        cfg.seed = (uint64_t)seed;
        Bench b = {synth_hard_new(&cfg), l1l2_motion_align_new(WIDTH, HEIGHT, WIDTH, HEIGHT), {NULL}};
        for (int t = 0; t < FRAMES; t++)
            b.picture[t] = l1l2_image_float_pyramid_new(WIDTH, HEIGHT);
        for (int n = 0; n < 3; n++) {
            cfg.noise = noises[n];
            synth_hard_change(b.clip, &cfg);
            run(&b, &tally[n]);
        }
        for (int t = 0; t < FRAMES; t++)
            l1l2_image_float_pyramid_free(b.picture[t]);
        l1l2_motion_align_free(b.aligner);
        synth_hard_free(b.clip);
    }
    for (int n = 0; n < 3; n++) {
        const Tally *y = &tally[n];
        printf(" | %2.0f: %7.3f %7.2f %2d/%d", noises[n], y->accepted ? sqrt(y->squares / y->accepted) : 0.0, y->worst,
               y->accepted, y->frames);
        if (y->bridges > 0)
            printf(" behind %.2f", y->worst_behind);
        all->prepare_ms += y->prepare_ms, all->align_ms += y->align_ms;
        all->frames += y->frames, all->alignments += y->alignments;
    }
    printf("\n");
    fflush(stdout);
}

int main(int argc, char **argv)
{
    Tally all = {0};
    printf("sigma: rms, worst, accepted of all\n");
    for (int i = 0; i < synth_hard_case_count; i++)
        if (argc < 2 || strcmp(argv[1], synth_hard_cases[i].name) == 0)
            bench_case(&synth_hard_cases[i], &all);
    if (all.frames > 0)
        printf("CPU time: %.2f ms to prepare a picture, %.2f ms an alignment\n", all.prepare_ms / all.frames,
               all.align_ms / all.alignments);
    return EXIT_SUCCESS;
}
