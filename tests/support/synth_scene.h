/* SPDX-License-Identifier: MIT */
/*
 * The scene of the synthetic clips: three periodic tiles (luma and two of chroma), band-limited so that bilinear
 * lookup is close to exact.
 */
#ifndef SYNTH_SCENE_H
#define SYNTH_SCENE_H

#include <stddef.h>
#include <stdint.h>

/* A square periodic picture of 2^log2_size texels a side that covers SYNTH_SCENE_PX. */
typedef struct SynthTile {
    int log2_size;
    uint16_t *texel; /* grey level x 128 */
} SynthTile;

typedef struct SynthScene {
    SynthTile luma;      /* half a pixel a texel */
    SynthTile chroma[2]; /* two pixels a texel: U, V */
} SynthScene;

void synth_scene_init(SynthScene *scene, uint64_t seed);
void synth_scene_clear(SynthScene *scene);

/* An equally distributed 64 bit number for each key (splitmix64's finalizer). */
uint64_t synth_hash(uint64_t key);

/* One of [0, 1) for each key. */
double synth_fraction(uint64_t key);

/* calloc that aborts when out of memory. */
void *synth_alloc(size_t count, size_t size);

#endif
