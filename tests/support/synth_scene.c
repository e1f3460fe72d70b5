/* SPDX-License-Identifier: MIT */
/*
 * The scene is noise with equal power in every octave, as in natural pictures. It is made from coarse to fine: each
 * level is the cubic B-spline of the level before it, sampled twice as finely (two-scale relation), plus new noise.
 * Shapes with soft edges are drawn over it, so that there are corners. Positions in a lookup are 32-bit fixed-point
 * numbers: where they overflow, the tile repeats.
 */
#include "synth_scene.h"

#include <math.h>
#include <stdlib.h>

enum {
    LUMA_LOG2 = 11,
    CHROMA_LOG2 = 9,
    MASK_LOG2 = 9,
    COARSEST_LOG2 = 2,
    SHAPES = 500
};

uint64_t synth_hash(uint64_t key)
{
    key += 0x9e3779b97f4a7c15u;
    key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
    key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
    return key ^ (key >> 31);
}

double synth_fraction(uint64_t key)
{
    return (double)(synth_hash(key) >> 11) * 0x1p-53;
}

void *synth_alloc(size_t count, size_t size)
{
    void *p = calloc(count, size);
    if (!p)
        abort();
    return p;
}

/* Uniform in [-1, 1). */
static float uniform(uint64_t key)
{
    return (float)(int32_t)(synth_hash(key) >> 32) * (1.0f / 2147483648.0f);
}

/* fine (2n x 2n) = the B-spline of coarse (n x n), sampled twice as finely. rows is scratch for n x 2n. */
static void refine(const float *coarse, int n, float *rows, float *fine)
{
    const int mask = n - 1;
    for (int y = 0; y < n; y++) {
        const float *c = coarse + (size_t)y * n;
        float *r = rows + (size_t)y * 2 * n;
        for (int x = 0; x < n; x++) {
            const float here = c[x], after = c[(x + 1) & mask];
            r[2 * x] = (c[(x - 1) & mask] + 6.0f * here + after) * 0.125f;
            r[2 * x + 1] = (here + after) * 0.5f;
        }
    }
    for (int y = 0; y < n; y++) {
        const float *before = rows + (size_t)((y - 1) & mask) * 2 * n;
        const float *here = rows + (size_t)y * 2 * n;
        const float *after = rows + (size_t)((y + 1) & mask) * 2 * n;
        float *even = fine + (size_t)(2 * y) * 2 * n;
        float *odd = even + 2 * n;
        for (int x = 0; x < 2 * n; x++) {
            even[x] = (before[x] + 6.0f * here[x] + after[x]) * 0.125f;
            odd[x] = (here[x] + after[x]) * 0.5f;
        }
    }
}

/* The noise, 2^log2_size texels a side; its finest octave has a lattice of `finest` texels (a power of two). */
static float *make_noise(int log2_size, int finest, uint64_t seed)
{
    const size_t count = (size_t)1 << (2 * log2_size);
    float *now = synth_alloc(count, sizeof *now);
    float *next = synth_alloc(count, sizeof *next);
    float *rows = synth_alloc(count / 2, sizeof *rows);
    for (int level = COARSEST_LOG2;; level++) {
        const int n = 1 << level;
        if (((1 << log2_size) >> level) >= finest)
            for (int i = 0; i < n * n; i++)
                now[i] += uniform(synth_hash(seed + (uint64_t)level) + (uint64_t)i);
        if (level == log2_size)
            break;
        refine(now, n, rows, next);
        float *swap = now;
        now = next;
        next = swap;
    }
    free(next);
    free(rows);
    return now;
}

/* A disc or a turned rectangle, its level raised or lowered; the edge is three texels (1.5 px) wide. */
static void draw_shape(float *tile, int log2_size, uint64_t key)
{
    const int n = 1 << log2_size;
    const float cx = (uniform(key) + 1.0f) * 0.5f * (float)n, cy = (uniform(key + 1) + 1.0f) * 0.5f * (float)n;
    const float u = (uniform(key + 2) + 1.0f) * 0.5f;
    const float half_w = 8.0f + 90.0f * u * u, half_h = half_w * (0.7f + 0.3f * uniform(key + 3));
    const float angle = 3.14159265f * uniform(key + 4), c = cosf(angle), s = sinf(angle);
    const bool disc = uniform(key + 6) > 0.4f;
    const float level = uniform(key + 5) > 0.0f ? 1.2f : -1.2f;
    const int reach = (int)(disc ? half_h : sqrtf(half_w * half_w + half_h * half_h)) + 3;
    for (int j = -reach; j <= reach; j++) {
        for (int i = -reach; i <= reach; i++) {
            const float x = c * (float)i + s * (float)j, y = c * (float)j - s * (float)i;
            const float to_side = half_w - fabsf(x), to_end = half_h - fabsf(y);
            const float inside = disc ? half_h - sqrtf(x * x + y * y) : to_side < to_end ? to_side : to_end;
            if (inside <= -1.5f)
                continue;
            const float k = inside < 1.5f ? inside / 3.0f + 0.5f : 1.0f;
            const int row = ((int)cy + j) & (n - 1), column = ((int)cx + i) & (n - 1);
            tile[(size_t)row * n + column] += level * k * k * (3.0f - 2.0f * k);
        }
    }
}

/* Gray levels center +- reach, softly clipped. */
static SynthTile quantize(const float *tile, int log2_size, float gain, float center, float reach)
{
    const size_t count = (size_t)1 << (2 * log2_size);
    SynthTile out = {log2_size, synth_alloc(count, sizeof *out.texel)};
    for (size_t i = 0; i < count; i++) {
        const float v = tile[i] * gain;
        out.texel[i] = (uint16_t)((center + reach * v / sqrtf(1.0f + v * v)) * 128.0f + 0.5f);
    }
    return out;
}

/* Some blobs, 100 px and more across, on a quarter of the area; their edges are two texels wide. */
static SynthTile make_mask(uint64_t seed)
{
    const size_t count = (size_t)1 << (2 * MASK_LOG2);
    float *tile = make_noise(MASK_LOG2, 64, seed);
    float low = -8.0f, high = 8.0f; /* the level that a quarter exceeds, by bisection */
    for (int i = 0; i < 20; i++) {
        const float middle = 0.5f * (low + high);
        size_t above = 0;
        for (size_t k = 0; k < count; k++)
            above += tile[k] > middle;
        if (above > count / 4)
            low = middle;
        else
            high = middle;
    }
    SynthTile out = {MASK_LOG2, synth_alloc(count, sizeof *out.texel)};
    for (size_t k = 0; k < count; k++) {
        const float steepness = 16.0f; /* the noise rises by some 1/30 a texel */
        out.texel[k] = (uint16_t)(255.0f * 128.0f * fminf(fmaxf((tile[k] - low) * steepness + 0.5f, 0.0f), 1.0f));
    }
    free(tile);
    return out;
}

void synth_scene_init(SynthScene *scene, uint64_t seed, bool with_mask)
{
    const uint64_t key = synth_hash(seed);
    *scene = (SynthScene){0};
    float *tile = make_noise(LUMA_LOG2, 4, key);
    for (int i = 0; i < SHAPES; i++)
        draw_shape(tile, LUMA_LOG2, synth_hash(key + 100u + (uint64_t)i));
    scene->luma = quantize(tile, LUMA_LOG2, 0.55f, 125.0f, 100.0f);
    free(tile);
    for (int c = 0; c < 2; c++) {
        tile = make_noise(CHROMA_LOG2, 8, key + 50u + (uint64_t)c);
        scene->chroma[c] = quantize(tile, CHROMA_LOG2, 0.8f, 128.0f, 36.0f);
        free(tile);
    }
    if (with_mask)
        scene->mask = make_mask(key + 60u);
}

void synth_scene_clear(SynthScene *scene)
{
    free(scene->luma.texel);
    free(scene->chroma[0].texel);
    free(scene->chroma[1].texel);
    free(scene->mask.texel);
}

void synth_tile_lookup(const SynthTile *tile, double x, double y, double dx, double dy, int n, uint16_t *deep)
{
    const int bits = tile->log2_size, shift = 32 - bits;
    const uint32_t mask = (1u << bits) - 1u;
    const double turn = 0x1p32 / SYNTH_SCENE_PX; /* the tile's width is 2^32 */
    const double center = (double)(1u << (shift - 1)); /* texel centers are at half-integers too */
    uint32_t u = (uint32_t)(int64_t)floor(fmod(x, SYNTH_SCENE_PX) * turn - center);
    uint32_t v = (uint32_t)(int64_t)floor(fmod(y, SYNTH_SCENE_PX) * turn - center);
    const uint32_t du = (uint32_t)(int64_t)floor(dx * turn + 0.5), dv = (uint32_t)(int64_t)floor(dy * turn + 0.5);
    for (int i = 0; i < n; i++, u += du, v += dv) {
        const uint32_t x0 = u >> shift, x1 = (x0 + 1u) & mask, fx = (u >> (shift - 11)) & 2047u;
        const uint32_t y0 = v >> shift, y1 = (y0 + 1u) & mask, fy = (v >> (shift - 11)) & 2047u;
        const uint16_t *r0 = tile->texel + ((size_t)y0 << bits), *r1 = tile->texel + ((size_t)y1 << bits);
        const uint32_t top = (r0[x0] * (2048u - fx) + r0[x1] * fx) >> 7;
        const uint32_t bottom = (r1[x0] * (2048u - fx) + r1[x1] * fx) >> 7;
        deep[i] = (uint16_t)((top * (2048u - fy) + bottom * fy) >> 16);
    }
}
