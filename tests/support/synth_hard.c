/* SPDX-License-Identifier: MIT */
#include "synth_hard.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "synth_path.h"
#include "synth_scene.h"

enum { MIN_INSTANTS = 16, MAX_INSTANTS = 64, STARS = 400, NOISE_SIZE = 1 << 16 };

static const double pi = 3.14159265358979323846;
/* Part of a frame's time that the shutter is open, and how long a jerk lasts, frames. */
static const double exposure = 0.5, jerk_length = 1.5;
/* Of the water and the head, px/frame. */
static const double drift_x = 2.5, drift_y = 0.6, sway_px = 5.0, sway_hz = 0.05;
static const double tile_px = 24.0;

struct SynthHard {
    SynthHardConfig cfg;
    SynthConfig camera;
    SynthScene scene, other;
    bool drawn_other;
    float *sum, *part;   /* of the instants of an exposure */
    int16_t *noise;      /* 1/256 of sigma */
};

static bool has_other(const SynthHardConfig *cfg)
{
    return cfg->cover == SYNTH_HARD_WATER || cfg->cover == SYNTH_HARD_HEAD;
}

void synth_hard_change(SynthHard *s, const SynthHardConfig *cfg)
{
    if (cfg->width != s->cfg.width || cfg->height != s->cfg.height || cfg->seed != s->cfg.seed)
        abort();
    s->cfg = *cfg;
    s->camera = synth_defaults();
    s->camera.width = cfg->width, s->camera.height = cfg->height;
    s->camera.shake = cfg->shake, s->camera.roll = cfg->roll, s->camera.seed = cfg->seed;
    if (has_other(cfg) && !s->drawn_other) {
        synth_scene_init(&s->other, ~cfg->seed, false);
        s->drawn_other = true;
    }
}

SynthHard *synth_hard_new(const SynthHardConfig *cfg)
{
    SynthHard *s = synth_alloc(1, sizeof *s);
    s->cfg = *cfg;
    synth_hard_change(s, cfg);
    synth_scene_init(&s->scene, cfg->seed, false);
    const size_t pixels = (size_t)cfg->width * (size_t)cfg->height;
    s->sum = synth_alloc(pixels, sizeof *s->sum);
    s->part = synth_alloc(pixels, sizeof *s->part);
    s->noise = synth_alloc(NOISE_SIZE, sizeof *s->noise);
    for (uint64_t i = 0; i < NOISE_SIZE; i++) { /* Box-Muller transform */
        const double radius = sqrt(-2.0 * log(1.0 - synth_fraction(cfg->seed + 2 * i)));
        s->noise[i] = (int16_t)lrint(256.0 * radius * cos(2.0 * pi * synth_fraction(cfg->seed + 2 * i + 1)));
    }
    return s;
}

void synth_hard_free(SynthHard *s)
{
    if (!s)
        return;
    synth_scene_clear(&s->scene);
    if (s->drawn_other)
        synth_scene_clear(&s->other);
    free(s->sum);
    free(s->part);
    free(s->noise);
    free(s);
}

static double smooth_step(double v)
{
    const double u = fmin(fmax(v, 0.0), 1.0);
    return u * u * (3.0 - 2.0 * u);
}

static bool is_jerk(const SynthHardConfig *cfg, int t)
{
    const int phase = t - cfg->jerk_from;
    return cfg->jerks > 0 && phase >= 0 && (cfg->jerk_every > 0 ? phase % cfg->jerk_every : phase) < cfg->jerks;
}

/* The camera's displacement by all jerks up to a time. The jerk of frame k is centered on the middle of its exposure;
 * the part of it that falls into the exposure is `jerk_px`. */
static void add_jerks(const SynthHardConfig *cfg, double time, double *x, double *y)
{
    const double reach = 0.5 * exposure / jerk_length, seen = smooth_step(0.5 + reach) - smooth_step(0.5 - reach);
    const double size = cfg->jerk_px / seen;
    double turned = 2.0 * pi * synth_fraction(synth_hash(cfg->seed + 77));
    for (int k = cfg->jerk_from; k < time + 2.0 && cfg->jerks > 0; k++) {
        if (!is_jerk(cfg, k))
            continue;
        const double part = smooth_step((time - k) / jerk_length + 0.5);
        *x += size * part * cos(turned), *y += size * part * sin(turned);
        /* roughly the opposite direction, so that the camera comes back */
        turned += pi + 1.2 * (synth_fraction(cfg->seed + (uint64_t)k) - 0.5);
    }
}

static void pose(const SynthHard *s, double time, double M[9])
{
    synth_path_pose(&s->camera, time, M);
    const double scale = exp(-s->cfg.zoom * time);
    M[0] *= scale, M[1] *= scale, M[3] *= scale, M[4] *= scale;
    add_jerks(&s->cfg, time, &M[2], &M[5]);
}

void synth_hard_camera(const SynthHard *s, int t, double M[9])
{
    pose(s, t, M);
}

void synth_hard_motion(const SynthHard *s, int t, int back, double F[9])
{
    double M[9], N[9];
    pose(s, t, M);
    pose(s, t - back, N);
    synth_path_motion(M, N, F);
}

void synth_hard_blur(const SynthHard *s, int t, double *x, double *y)
{
    double A[9], B[9];
    pose(s, t - 0.5 * exposure, A);
    pose(s, t + 0.5 * exposure, B);
    *x = B[2] - A[2], *y = B[5] - A[5];
}

static void draw_tile_row(const SynthTile *tile, const double M[9], double x, double y, int n, float *out)
{
    uint16_t deep[SYNTH_SPAN];
    for (int i = 0; i < n; i += SYNTH_SPAN) {
        const int count = n - i < SYNTH_SPAN ? n - i : SYNTH_SPAN;
        synth_tile_lookup(tile, M[0] * (x + i) + M[1] * y + M[2], M[3] * (x + i) + M[4] * y + M[5], M[0], M[3], count,
                          deep);
        for (int k = 0; k < count; k++)
            out[i + k] = (float)deep[k] / SYNTH_DEEP;
    }
}

/* Tiles with joints 3 px wide, whose edges are one pixel soft. */
static float floor_at(double x, double y)
{
    const double u = fabs(x / tile_px - floor(x / tile_px) - 0.5), v = fabs(y / tile_px - floor(y / tile_px) - 0.5);
    const double joint = smooth_step(((u > v ? u : v) - 0.5) * tile_px + 2.5);
    return (float)(170.0 - 90.0 * joint);
}

static void draw_floor_row(const SynthHard *s, const double M[9], double x, double y, int n, float *out)
{
    draw_tile_row(&s->scene.luma, M, x, y, n, out);
    for (int i = 0; i < n; i++)
        out[i] = floor_at(M[0] * (x + i) + M[1] * y + M[2], M[3] * (x + i) + M[4] * y + M[5]) +
                 0.12f * (out[i] - 128.0f);
}

/* A spot of light: its center in the frame moves on a curve of its own. */
static float light_at(const SynthHard *s, double time, double x, double y)
{
    double light = 0.0;
    for (int k = 0; k < 3; k++) {
        const double phase = 2.0 * pi * synth_fraction(s->cfg.seed + 300 + (uint64_t)k), speed = 0.06 + 0.02 * k;
        const double u = (x - 0.35 * s->cfg.width * sin(speed * time + phase)) / (0.14 * s->cfg.width);
        const double v = (y - 0.25 * s->cfg.height * cos(1.3 * speed * time + phase)) / (0.22 * s->cfg.height);
        light += exp(-0.5 * (u * u + v * v));
    }
    return (float)light;
}

/* Draws the water or the head, which move by themselves, over the scene. The rest of the row is unchanged. */
static void cover_row(const SynthHard *s, const double M[9], double time, double x, double y, int n, float *out)
{
    const SynthHardConfig *cfg = &s->cfg;
    if (cfg->cover == SYNTH_HARD_WATER) {
        if (y < (0.5 - cfg->covered) * cfg->height)
            return;
        double N[9];
        memcpy(N, M, sizeof N);
        N[2] += drift_x * time, N[5] += drift_y * time;
        draw_tile_row(&s->other.luma, N, x, y, n, out);
    } else if (cfg->cover == SYNTH_HARD_HEAD) {
        const double half_h = 0.5 * cfg->height, half_w = cfg->covered * cfg->width / (0.5 * pi);
        const double mx = sway_px * sin(2.0 * pi * sway_hz * time), my = sway_px * cos(1.7 * pi * sway_hz * time);
        const double v = (y - my) / half_h, chord = v * v < 1.0 ? half_w * sqrt(1.0 - v * v) : 0.0;
        const int from = (int)fmax(0.0, ceil(mx - chord - x)), to = (int)fmin(n, ceil(mx + chord - x));
        const double N[9] = {1.0, 0.0, 200.0 - mx, 0.0, 1.0, 300.0 - my, 0.0, 0.0, 1.0};
        if (from < to)
            draw_tile_row(&s->other.luma, N, x + from, y, to - from, out + from);
    }
}

static void draw_stars(const SynthHard *s, const double M[9], float *out)
{
    const int w = s->cfg.width, h = s->cfg.height;
    const double norm = M[0] * M[0] + M[3] * M[3];
    for (int i = 0; i < w * h; i++)
        out[i] = 12.0f;
    for (uint64_t k = 0; k < STARS; k++) {
        /* Of a sky of 1600 x 1000 px. */
        const double X = 1600.0 * (synth_fraction(s->cfg.seed + 3 * k + 500) - 0.5) - M[2];
        const double Y = 1000.0 * (synth_fraction(s->cfg.seed + 3 * k + 501) - 0.5) - M[5];
        const double u = synth_fraction(s->cfg.seed + 3 * k + 502), light = 15.0 + 150.0 * u * u * u;
        const double x = (M[0] * X + M[3] * Y) / norm + 0.5 * w - 0.5, y = (M[0] * Y - M[3] * X) / norm + 0.5 * h - 0.5;
        for (int j = (int)floor(y) - 3; j <= (int)floor(y) + 4; j++)
            for (int i = (int)floor(x) - 3; i <= (int)floor(x) + 4; i++)
                if (i >= 0 && j >= 0 && i < w && j < h)
                    out[j * w + i] += (float)(light * exp(-0.5 * ((i - x) * (i - x) + (j - y) * (j - y))));
    }
}

/* What the lens shows at an instant. */
static void draw_instant(const SynthHard *s, double time, float *out)
{
    const int w = s->cfg.width, h = s->cfg.height;
    double M[9];
    pose(s, time, M);
    if (s->cfg.scene == SYNTH_HARD_STARS) {
        draw_stars(s, M, out);
        return;
    }
    for (int j = 0; j < h; j++) {
        const double x = 0.5 - 0.5 * w, y = j + 0.5 - 0.5 * h;
        float *row = out + (ptrdiff_t)j * w;
        if (s->cfg.scene == SYNTH_HARD_TILES)
            draw_floor_row(s, M, x, y, w, row);
        else
            draw_tile_row(&s->scene.luma, M, x, y, w, row);
        for (int i = 0; i < w && s->cfg.scene == SYNTH_HARD_STAGE; i++)
            row[i] = 6.0f + row[i] * (0.06f + 0.8f * light_at(s, time, x + i, y));
        cover_row(s, M, time, x, y, w, row);
    }
}

/* The mean picture over the exposure. */
static void expose(const SynthHard *s, int t)
{
    const size_t pixels = (size_t)s->cfg.width * (size_t)s->cfg.height;
    double x, y;
    synth_hard_blur(s, t, &x, &y);
    const double length = hypot(x, y);
    int instants = length > 1.0 ? (int)fmin(fmax(ceil(length), MIN_INSTANTS), MAX_INSTANTS) : 1;
    memset(s->sum, 0, pixels * sizeof *s->sum);
    for (int k = 0; k < instants; k++) {
        draw_instant(s, t + exposure * ((k + 0.5) / instants - 0.5), s->part);
        for (size_t i = 0; i < pixels; i++)
            s->sum[i] += s->part[i] / (float)instants;
    }
}

static void dot(const SynthHard *s, double x, double y, double radius_x, double radius_y, float level, float opacity)
{
    const int w = s->cfg.width, h = s->cfg.height;
    for (int j = (int)(y - radius_y) - 1; j <= (int)(y + radius_y) + 1; j++)
        for (int i = (int)(x - radius_x) - 1; i <= (int)(x + radius_x) + 1; i++) {
            const double u = (i - x) / radius_x, v = (j - y) / radius_y;
            if (i >= 0 && j >= 0 && i < w && j < h && u * u + v * v < 1.0)
                s->sum[j * w + i] += opacity * (level - s->sum[j * w + i]);
        }
}

/* Draws a word made of blocks, an eighth of the width long. */
static void label(const SynthHard *s, uint64_t key)
{
    const int w = s->cfg.width, h = s->cfg.height;
    const int block = (int)fmax(1.0, lrint(2.0 * w / 640)), wide = 36 * block, high = 6 * block;
    const int left = (int)(synth_fraction(key) * (w - wide)), top = (int)(synth_fraction(key + 1) * (h - high));
    for (int j = 0; j < high; j++)
        for (int i = 0; i < wide; i++) {
            const int x = i / block, y = j / block;
            const bool lit = x % 4 < 3 && synth_fraction(key + 10 + (uint64_t)(x + 40 * (y / 2))) > 0.5;
            s->sum[(top + j) * w + left + i] = lit ? 245.0f : 8.0f;
        }
}

static double wrapped(double v, double period)
{
    return v - period * floor(v / period);
}

/* Draws rain, snow, specks or labels over the scene. */
static void scatter_things(const SynthHard *s, int t)
{
    const double w = s->cfg.width, h = s->cfg.height, size = w / 640.0;
    for (int k = 0; k < s->cfg.count; k++) {
        const uint64_t key = synth_hash(s->cfg.seed + 9000 + (uint64_t)k);
        const double x = w * synth_fraction(key), y = h * synth_fraction(key + 1), u = synth_fraction(key + 2);
        switch (s->cfg.cover) {
        case SYNTH_HARD_RAIN:
            dot(s, wrapped(x + 4.0 * size * t, w), wrapped(y + (30.0 + 20.0 * u) * size * t, h), fmax(1.0, size),
                9.0 * size, 220.0f, 0.6f);
            break;
        case SYNTH_HARD_SNOW:
            dot(s, wrapped(x + (4.0 * u - 1.0) * size * t, w), wrapped(y + (6.0 + 6.0 * u) * size * t, h),
                fmax(1.0, (1.5 + 2.0 * u) * size), fmax(1.0, (1.5 + 2.0 * u) * size), 240.0f, 0.8f);
            break;
        case SYNTH_HARD_SPECKS:
            dot(s, x, y, fmax(1.0, (1.5 + 2.5 * u) * size), fmax(1.0, (1.5 + 2.5 * u) * size), 20.0f, 0.8f);
            break;
        case SYNTH_HARD_LABELS: label(s, key); break;
        default: break;
        }
    }
}

/* Noise of sigma 1 at a pixel. */
static float noise_at(const SynthHard *s, uint64_t start, int i)
{
    return (float)s->noise[(start + (uint64_t)i) % NOISE_SIZE] * (1.0f / 256.0f);
}

void synth_hard_render(const SynthHard *s, int t, uint8_t *data, ptrdiff_t stride)
{
    const SynthHardConfig *cfg = &s->cfg;
    const float contrast = (float)(cfg->levels > 0.0 ? cfg->levels / 240.0 : cfg->contrast > 0.0 ? cfg->contrast : 1.0);
    const float gain = (float)(cfg->step_at > 0 && t >= cfg->step_at ? cfg->step_gain : 1.0);
    expose(s, t);
    scatter_things(s, t);
    for (int j = 0; j < cfg->height; j++) {
        const uint64_t grain = synth_hash(cfg->seed + ((uint64_t)t << 20) + (uint64_t)j);
        const uint64_t pattern = synth_hash(cfg->seed + (1u << 30) + (uint64_t)j);
        for (int i = 0; i < cfg->width; i++) {
            float v = gain * (120.0f + contrast * (s->sum[j * cfg->width + i] - 120.0f));
            v += (float)cfg->pattern * noise_at(s, pattern, i) + (float)cfg->noise * noise_at(s, grain, i);
            data[j * stride + i] = (uint8_t)(v < 0.0f ? 0.0f : v > 255.0f ? 255.0f : v + 0.5f);
        }
    }
}

#define FRAME .width = 640, .height = 360, .seed = 1, .shake = 6.0, .roll = 0.004

const SynthHardCase synth_hard_cases[] = {
    {"plain", {FRAME}},
    {"blur 10 px", {FRAME, .jerk_from = 3, .jerks = 1, .jerk_every = 6, .jerk_px = 10.0}},
    {"blur 20 px", {FRAME, .jerk_from = 3, .jerks = 1, .jerk_every = 6, .jerk_px = 20.0}},
    {"blur 40 px", {FRAME, .jerk_from = 3, .jerks = 1, .jerk_every = 6, .jerk_px = 40.0}},
    {"blur 60 px", {FRAME, .jerk_from = 3, .jerks = 1, .jerk_every = 6, .jerk_px = 60.0}},
    {"blur of 2 frames", {FRAME, .jerk_from = 3, .jerks = 2, .jerk_every = 8, .jerk_px = 30.0}},
    {"blur of 5 frames", {FRAME, .jerk_from = 3, .jerks = 5, .jerk_every = 12, .jerk_px = 20.0}},
    {"low texture", {FRAME, .contrast = 0.1}},
    {"thermal", {FRAME, .levels = 16.0, .pattern = 0.8}},
    {"tiles", {FRAME, .scene = SYNTH_HARD_TILES}},
    {"stars", {FRAME, .scene = SYNTH_HARD_STARS}},
    {"stage", {FRAME, .scene = SYNTH_HARD_STAGE}},
    {"rain", {FRAME, .cover = SYNTH_HARD_RAIN, .count = 400}},
    {"snow", {FRAME, .cover = SYNTH_HARD_SNOW, .count = 400}},
    {"specks", {FRAME, .cover = SYNTH_HARD_SPECKS, .count = 250}},
    {"labels", {FRAME, .cover = SYNTH_HARD_LABELS, .count = 24}},
    {"water 45 %", {FRAME, .cover = SYNTH_HARD_WATER, .covered = 0.45}},
    {"water 55 %", {FRAME, .cover = SYNTH_HARD_WATER, .covered = 0.55}},
    {"water 65 %", {FRAME, .cover = SYNTH_HARD_WATER, .covered = 0.65}},
    {"head 40 %", {FRAME, .cover = SYNTH_HARD_HEAD, .covered = 0.40}},
    {"head 50 %", {FRAME, .cover = SYNTH_HARD_HEAD, .covered = 0.50}},
    {"head 60 %", {FRAME, .cover = SYNTH_HARD_HEAD, .covered = 0.60}},
    {"fast zoom", {FRAME, .zoom = 0.04}},
    {"exposure step", {FRAME, .step_at = 4, .step_gain = 1.5, .jerk_from = 4, .jerks = 1, .jerk_px = 20.0}},
};
const int synth_hard_case_count = sizeof synth_hard_cases / sizeof *synth_hard_cases;

const SynthHardCase *synth_hard_case_named(const char *name)
{
    for (int i = 0; i < synth_hard_case_count; i++)
        if (strcmp(synth_hard_cases[i].name, name) == 0)
            return &synth_hard_cases[i];
    abort();
}

SynthHardConfig synth_hard_case_at(const SynthHardCase *c, int width)
{
    SynthHardConfig cfg = c->cfg;
    const double scale = (double)width / cfg.width;
    cfg.height = (int)lrint(cfg.height * scale), cfg.width = width;
    cfg.shake *= scale, cfg.jerk_px *= scale;
    return cfg;
}
