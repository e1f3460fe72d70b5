/* SPDX-License-Identifier: MIT */
#include "synth_trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "synth_scene.h"

/* Below this contrast, with some noise, a viewer cannot see how the picture moves. */
static const double min_contrast = 0.05;

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void multiply(const double A[9], const double B[9], double out[9])
{
    double product[9];
    for (int i = 0; i < 9; i++)
        product[i] = A[i / 3 * 3] * B[i % 3] + A[i / 3 * 3 + 1] * B[3 + i % 3] + A[i / 3 * 3 + 2] * B[6 + i % 3];
    memcpy(out, product, sizeof product);
}

/* The frame's corner k, through an affine map. */
static void corner(const SynthConfig *cfg, const double M[9], int k, double out[2])
{
    const double x = (k & 1 ? 0.5 : -0.5) * cfg->width, y = (k & 2 ? 0.5 : -0.5) * cfg->height;
    out[0] = M[0] * x + M[1] * y + M[2];
    out[1] = M[3] * x + M[4] * y + M[5];
}

double synth_trial_distance(const SynthConfig *cfg, const double A[9], const double B[9])
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        double p[2], q[2];
        corner(cfg, A, k, p);
        corner(cfg, B, k, q);
        sum += ((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1])) / 4.0;
    }
    return sqrt(sum);
}

/* The mean square of the corners' second difference over three poses. */
static double acceleration(const SynthConfig *cfg, const double A[9], const double B[9], const double C[9])
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        double p[2], q[2], r[2];
        corner(cfg, A, k, p);
        corner(cfg, B, k, q);
        corner(cfg, C, k, r);
        for (int i = 0; i < 2; i++)
            sum += pow(p[i] - 2.0 * q[i] + r[i], 2.0) / 4.0;
    }
    return sum;
}

static L1L2Stab *stabilizer_new(const SynthConfig *cfg, L1L2StabFormat format, SynthTrialSetting set)
{
    L1L2StabConfig config;
    l1l2stab_config_init(&config, sizeof config);
    config.format = format;
    config.width = cfg->width;
    config.height = cfg->height;
    config.frame_rate = cfg->fps;
    config.threads = 1;
    if (set)
        set(&config);
    L1L2Stab *stab;
    if (l1l2stab_create(&stab, &config) != L1L2STAB_OK)
        abort();
    return stab;
}

static void push(L1L2Stab *stab, const Synth *synth, const SynthConfig *cfg, L1L2StabFormat format, int t)
{
    const SynthPicture picture = synth_picture_new(format, cfg->width, cfg->height);
    synth_render(synth, t, format, picture.data, picture.stride);
    L1L2StabFrame frame = {.pts = t, .opaque = picture.data[0], .release = free};
    memcpy(frame.data, picture.data, sizeof frame.data);
    memcpy(frame.stride, picture.stride, sizeof frame.stride);
    if (l1l2stab_push(stab, &frame) != L1L2STAB_OK)
        abort();
}

static int pull_all(L1L2Stab *stab, L1L2StabInfo *info)
{
    int count = 0;
    while (l1l2stab_pull(stab, NULL, &info[count]) == L1L2STAB_OK)
        count++;
    return count;
}

static void judge_motion(SynthTrial *trial, const SynthConfig *cfg, const Synth *synth)
{
    double measured[9], truth[9], sum = 0.0;
    int count = 0;
    trial->quality = 1.0;
    for (int t = 0; t < trial->frames; t++) {
        const L1L2StabInfo *info = &trial->info[t];
        double F[9];
        synth_motion(synth, t, F);
        trial->contrast[t] = synth_contrast(synth, t);
        for (int i = 0; i < L1L2STAB_STAGE_COUNT; i++)
            trial->stage_ms[i] += 1e-6 * (double)info->stage_ns[i] / trial->frames;
        if (t == 0 || synth_shot(synth, t) != synth_shot(synth, t - 1)) {
            memcpy(measured, identity, sizeof measured);
            memcpy(truth, identity, sizeof truth);
        } else {
            multiply(measured, info->F, measured);
            multiply(truth, F, truth);
        }
        trial->bias[t] = synth_trial_distance(cfg, measured, truth);
        if (info->model == L1L2STAB_MOTION_SOURCE_NONE) {
            trial->starts += t > 0;
            continue;
        }
        trial->error[t] = synth_trial_distance(cfg, info->F, F);
        if (info->flags & L1L2STAB_INFO_MOTION_LOST) {
            trial->lost++;
            continue;
        }
        sum += trial->error[t] * trial->error[t];
        count++;
        trial->worst = fmax(trial->worst, trial->error[t]);
        trial->quality = fmin(trial->quality, info->quality);
    }
    trial->rms = sqrt(sum / (count > 0 ? count : 1));
    trial->drift = trial->bias[trial->frames - 1];
}

static void judge_path(SynthTrial *trial, const SynthConfig *cfg, const Synth *synth)
{
    double in[3][9], out[3][9], sum_in = 0.0, sum_out = 0.0;
    int count = 0, seen = 0; /* frames of one shot in a row */
    for (int t = 0; t < trial->frames; t++) {
        double *M = in[t % 3];
        synth_camera(synth, t, M);
        multiply(M, trial->info[t].B, out[t % 3]);
        const bool cut = t > 0 && synth_shot(synth, t) != synth_shot(synth, t - 1);
        seen = trial->contrast[t] < min_contrast ? 0 : cut ? 1 : seen + 1;
        if (seen < 3)
            continue;
        sum_in += acceleration(cfg, in[(t - 2) % 3], in[(t - 1) % 3], M);
        sum_out += acceleration(cfg, out[(t - 2) % 3], out[(t - 1) % 3], out[t % 3]);
        count++;
    }
    trial->jitter_in = sqrt(sum_in / (count > 0 ? count : 1));
    trial->jitter_out = sqrt(sum_out / (count > 0 ? count : 1));
}

SynthTrial synth_trial_new(const SynthConfig *cfg, int frames)
{
    return synth_trial_in(cfg, frames, L1L2STAB_FORMAT_GRAY8);
}

SynthTrial synth_trial_in(const SynthConfig *cfg, int frames, L1L2StabFormat format)
{
    return synth_trial_with(cfg, frames, format, NULL);
}

SynthTrial synth_trial_with(const SynthConfig *cfg, int frames, L1L2StabFormat format, SynthTrialSetting set)
{
    SynthTrial trial = {.frames = frames};
    trial.info = synth_alloc((size_t)frames + 1, sizeof *trial.info);
    trial.error = synth_alloc((size_t)frames, sizeof *trial.error);
    trial.bias = synth_alloc((size_t)frames, sizeof *trial.bias);
    trial.contrast = synth_alloc((size_t)frames, sizeof *trial.contrast);
    Synth *synth = synth_new(cfg);
    L1L2Stab *stab = stabilizer_new(cfg, format, set);
    int got = 0;
    for (int t = 0; t < frames; t++) {
        push(stab, synth, cfg, format, t);
        got += pull_all(stab, trial.info + got);
    }
    l1l2stab_finish(stab);
    got += pull_all(stab, trial.info + got);
    l1l2stab_free(&stab);
    if (got != frames)
        abort();
    judge_motion(&trial, cfg, synth);
    judge_path(&trial, cfg, synth);
    synth_free(synth);
    return trial;
}

void synth_trial_free(SynthTrial *trial)
{
    free(trial->info);
    free(trial->error);
    free(trial->bias);
    free(trial->contrast);
    *trial = (SynthTrial){0};
}
