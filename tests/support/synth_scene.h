/* SPDX-License-Identifier: MIT */
/*
 * The scene of the synthetic clips: periodic tiles for luma, for the two chroma components, and for the mask of the
 * nearer layers. They are band-limited, so that bilinear lookup is close to exact.
 */
#ifndef SYNTH_SCENE_H
#define SYNTH_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "synth.h"
#include "synth_span.h"

/* A square periodic picture that covers SYNTH_SCENE_PX with 2^log2_size texels a side. */
typedef struct SynthTile {
    int log2_size;
    uint16_t *texel; /* gray level x 128 */
} SynthTile;

typedef struct SynthScene {
    SynthTile luma;      /* half a pixel a texel */
    SynthTile chroma[2]; /* two pixels a texel: U, V */
    SynthTile mask;      /* two pixels a texel: level 255 where a nearer layer is, 0 where it is not; may be empty */
} SynthScene;

void synth_scene_init(SynthScene *scene, uint64_t seed, bool with_mask);
void synth_scene_clear(SynthScene *scene);

/* n samples of a tile, gray levels x SYNTH_DEEP, from scene position (x, y) px on, in steps of (dx, dy) px. */
void synth_tile_lookup(const SynthTile *tile, double x, double y, double dx, double dy, int n, uint16_t *deep);

/* A uniformly distributed 64-bit number for each key (splitmix64's finalizer). */
uint64_t synth_hash(uint64_t key);

/* A uniformly distributed number in [0, 1) for each key. */
double synth_fraction(uint64_t key);

/* calloc that aborts when out of memory. */
void *synth_alloc(size_t count, size_t size);

#endif
