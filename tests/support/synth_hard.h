/* SPDX-License-Identifier: MIT */
/*
 * Synthetic clips in which corners fail: sudden jerks that blur single frames, low contrast, thermal cameras, repeated
 * texture, rain and snow, dense overlays, two motions, fast zoom, steps of the exposure, a dark stage. Gray, 8 bits.
 *
 * The camera and its conventions are synth.h's. If the camera moves by more than a pixel during a frame's exposure, the
 * frame is the mean of at least 16 instants. Its true motion is that of the middle of its exposure. Deterministic: the
 * same config gives the same pixels and the same truth, whatever the order of the frames.
 */
#ifndef SYNTH_HARD_H
#define SYNTH_HARD_H

#include <stddef.h>
#include <stdint.h>

#include "synth.h"

/* What the camera films. */
typedef enum SynthHardScene {
    SYNTH_HARD_PLAIN = 0, /* the scene of synth.h */
    SYNTH_HARD_TILES,     /* a floor of equal tiles, 24 px a side, with faint stains */
    SYNTH_HARD_STARS,     /* a dark sky with a few hundred stars */
    SYNTH_HARD_STAGE      /* the scene in the dark, lit by three spots that move by themselves */
} SynthHardScene;

/* What covers a part of the scene. */
typedef enum SynthHardCover {
    SYNTH_HARD_OPEN = 0,
    SYNTH_HARD_WATER,  /* at the bottom: another scene, which drifts in addition to the camera's motion */
    SYNTH_HARD_HEAD,   /* an ellipse in the middle, which stays in its place in the frame and sways a little */
    SYNTH_HARD_RAIN,   /* bright streaks, 40 px a frame */
    SYNTH_HARD_SNOW,   /* bright dots, 9 px a frame */
    SYNTH_HARD_SPECKS, /* dirt on the lens: dark dots that never move */
    SYNTH_HARD_LABELS  /* text on the picture that never moves */
} SynthHardCover;

typedef struct SynthHardConfig {
    int width, height;      /* pixels */
    uint64_t seed;
    SynthHardScene scene;
    SynthHardCover cover;
    double covered;         /* WATER and HEAD: part of the frame, [0, 1] */
    int count;              /* RAIN, SNOW, SPECKS, LABELS: how many */
    double shake, roll;     /* as in SynthConfig */
    double zoom;            /* the camera's steady zoom: ln of the scale a frame */
    int jerk_from, jerks;   /* frames [jerk_from, jerk_from + jerks) are blurred by a jerk of the camera, each in a
                             * direction of its own; jerk_every > 0: this recurs after so many frames */
    int jerk_every;
    double jerk_px;         /* length of the blur, px */
    double contrast;        /* of the scene: 1 is a standard deviation of about 45 gray levels; 0 counts as 1 */
    double levels;          /* thermal camera: the scene is reduced to so many gray levels; 0: it is not */
    double pattern;         /* sigma of a noise that is the same in every frame, gray levels */
    double noise;           /* sigma of the noise of each frame, gray levels */
    int step_at;            /* from this frame on the gain is `step_gain`; 0: never */
    double step_gain;
} SynthHardConfig;

typedef struct SynthHard SynthHard;

/* Never NULL: aborts when out of memory. */
SynthHard *synth_hard_new(const SynthHardConfig *cfg);
void synth_hard_free(SynthHard *s);

/* Another clip of the same size and seed: the scene, which takes the most time, is not drawn again. */
void synth_hard_change(SynthHard *s, const SynthHardConfig *cfg);

/* M_t: frame t to the scene, at the middle of its exposure. */
void synth_hard_camera(const SynthHard *s, int t, double M[9]);

/* The motion from frame t to frame t - back: M_{t-back}^-1 M_t. */
void synth_hard_motion(const SynthHard *s, int t, int back, double F[9]);

/* How far the picture's center moves over the exposure of frame t, px. */
void synth_hard_blur(const SynthHard *s, int t, double *x, double *y);

/* Frame t; stride in bytes. */
void synth_hard_render(const SynthHard *s, int t, uint8_t *data, ptrdiff_t stride);

/* Named configurations, one of each kind, of 640x360 pixels and without noise. */
typedef struct SynthHardCase {
    const char *name;
    SynthHardConfig cfg;
} SynthHardCase;

extern const SynthHardCase synth_hard_cases[];
extern const int synth_hard_case_count;

/* Aborts where there is none. */
const SynthHardCase *synth_hard_case_named(const char *name);

/* A case's config at another width, with the same proportions. All lengths in pixels are scaled with it. */
SynthHardConfig synth_hard_case_at(const SynthHardCase *c, int width);

#endif
