/* SPDX-License-Identifier: MIT */
/*
 * Accuracy and cost of the measured motion against synthetic truth, at the library's defaults: planar clips with noise
 * sigma 5. Error: rms over the frame's corners of where F_t puts them, px of the frame; drift: of the product of all
 * F_t, at the corners, px. Times: one core where the process is bound to one.
 *
 * usage: bench_motion [WIDTH HEIGHT]      default: 1280 720
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion.h"
#include "synth.h"

enum { FRAMES = 120 };

typedef struct Case {
    const char *name;
    double pan, shake, roll, zoom, foreground; /* px/frame, px, rad, ratio, part of the frame */
} Case;

static const Case cases[] = {
    {"still, noise only", 0, 0, 0, 0, 0},      {"shake 0.5 px", 0, 0.5, 0.0005, 0, 0},
    {"shake 2 px", 1, 2, 0.002, 0.001, 0},     {"shake 5 px", 1, 5, 0.005, 0.002, 0},
    {"shake 10 px", 2, 10, 0.01, 0.005, 0},    {"shake 20 px", 2, 20, 0.02, 0.01, 0},
    {"shake 30 px", 2, 30, 0.03, 0.02, 0},     {"roll 3 degrees rms", 0, 2, 0.052, 0, 0},
    {"zoom 5 % rms", 0, 2, 0.002, 0.05, 0},    {"pan 60 px/frame", 60, 2, 0.002, 0, 0},
    {"mover on 40 %", 1, 4, 0.003, 0.002, 0.4},
};

static L1L2Mat to_mat(const double F[9])
{
    L1L2Mat m;
    memcpy(m.m, F, sizeof m.m);
    return m;
}

static double corner_rms(const L1L2Mat *a, const L1L2Mat *b, double half_w, double half_h)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {k & 1 ? half_w : -half_w, k & 2 ? half_h : -half_h};
        const L1L2Point p = l1l2_mat_apply(a, u), q = l1l2_mat_apply(b, u);
        sum += ((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y)) / 4.0;
    }
    return sqrt(sum);
}

static int ascending(const void *a, const void *b)
{
    return *(const double *)a < *(const double *)b ? -1 : *(const double *)a > *(const double *)b;
}

static void bench(const Case *c, int width, int height)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = width, cfg.height = height;
    cfg.noise = 5.0;
    cfg.pan_x = c->pan, cfg.shake = c->shake, cfg.roll = c->roll, cfg.zoom = c->zoom, cfg.foreground = c->foreground;
    Synth *synth = synth_new(&cfg);
    uint8_t *picture = malloc((size_t)width * (size_t)height);
    const L1L2MotionConfig motion = {
        .format = l1l2_format_info(L1L2STAB_FORMAT_GRAY8), .width = width, .height = height,
        .analysis_size = 640, .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1};
    L1L2Motion *m;
    if (!picture || l1l2_motion_create(&m, &motion) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    const double diagonal = hypot(width, height);
    double error[FRAMES], ms[3] = {0.0};
    int worst_model = L1L2STAB_MODEL_SIMILARITY;
    L1L2Mat measured = l1l2_mat_identity(), truth = measured;
    for (int t = 0; t < FRAMES; t++) {
        L1L2MotionResult result;
        double F[9];
        synth_render_gray(synth, t, picture, width);
        if (l1l2_motion_push(m, picture, width, t == 0, &result) != L1L2STAB_OK)
            exit(EXIT_FAILURE);
        synth_motion(synth, t, F);
        const L1L2Mat found = l1l2_mat_rescale(result.F, diagonal), expected = to_mat(F);
        error[t] = corner_rms(&found, &expected, width / 2.0, height / 2.0);
        measured = l1l2_mat_mul(measured, found);
        truth = l1l2_mat_mul(truth, expected);
        ms[0] += 1e-6 * (double)result.scale_ns / FRAMES;
        ms[1] += 1e-6 * (double)result.track_ns / FRAMES;
        ms[2] += 1e-6 * (double)result.fit_ns / FRAMES;
        if (t > 0 && (int)result.model < worst_model)
            worst_model = (int)result.model;
    }
    qsort(error + 1, FRAMES - 1, sizeof *error, ascending);
    printf("%-20s  %7.3f %7.3f %7.2f   %5.2f %5.2f %5.2f  %s\n", c->name, error[FRAMES / 2], error[FRAMES - 1],
           corner_rms(&measured, &truth, width / 2.0, height / 2.0), ms[0], ms[1], ms[2],
           worst_model == L1L2STAB_MODEL_SIMILARITY ? "" : "lost");
    fflush(stdout);
    l1l2_motion_free(m);
    synth_free(synth);
    free(picture);
}

int main(int argc, char **argv)
{
    const int width = argc > 2 ? atoi(argv[1]) : 1280, height = argc > 2 ? atoi(argv[2]) : 720;
    printf("%4dx%-4d               error, px         drift   ms a frame\n", width, height);
    printf("                       median   worst      px   scale track   fit\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        bench(&cases[i], width, height);
    return EXIT_SUCCESS;
}
