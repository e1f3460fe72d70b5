/* SPDX-License-Identifier: MIT */
/*
 * Synthetic clips whose camera motion is known exactly: a textured, periodic scene seen by a camera that pans and
 * shakes. Deterministic: the same config gives the same pixels and the same truth. Any frame t >= 0 can be asked for,
 * in any order.
 *
 * Conventions are the public header's: pixels, origin at the frame's centre, x right, y down, 3x3 row-major.
 * The scene's unit is the pixel too (a larger frame sees more of it), and it repeats every SYNTH_SCENE_PX.
 */
#ifndef SYNTH_H
#define SYNTH_H

#include <l1l2stab/l1l2stab.h>

#define SYNTH_SCENE_PX 1024

typedef struct SynthConfig {
    int width, height;    /* pixels */
    double fps;           /* frames a second: the hand shakes in Hz */
    double pan_x, pan_y;  /* the camera's steady motion, px/frame */
    double shake;         /* rms of the shake of each axis, px */
    double roll;          /* rms of the shake of the roll, rad */
    double zoom;          /* rms of the shake of the zoom, as a ratio: 0.02 is about +-2 % */
    double noise;         /* sigma of the luma noise, grey levels */
    double foreground;    /* part of the frame that an object with a motion of its own covers, [0, 0.6] */
    L1L2StabChromaSite chroma_site;
    uint64_t seed;        /* of the scene, the shake and the noise */
    double turn;          /* the camera's steady roll, rad/frame */
    double vibration;     /* amplitude of a vibration of each axis, px */
    double vibration_roll; /* ditto of the roll, rad */
    double vibration_hz;
    double readout;       /* rolling shutter: from the first row's time to the last row's, s; 0: all rows at once */
} SynthConfig;

typedef struct Synth Synth;

/* 640x360, 30 frames/s, no pan, 4 px of shake, 0.005 rad of roll, no zoom, noise or foreground, seed 1. */
SynthConfig synth_defaults(void);

/* Never NULL: aborts when out of memory. */
Synth *synth_new(const SynthConfig *cfg);
void synth_free(Synth *s);

/* M_t: frame t to the scene; with a rolling shutter, its middle row. */
void synth_camera(const Synth *s, int t, double M[9]);

/* The camera at any time, in frames; it may be negative. */
void synth_camera_at(const Synth *s, double frames, double M[9]);

/* When the row of frame t that lies y px below its centre was taken, in frames: t + readout fps y / height. Chroma rows
 * too are taken when their own y says. */
double synth_row_time(const Synth *s, int t, double y);

/* F_t = M_{t-1}^-1 M_t: frame t to frame t-1; the identity for t = 0. */
void synth_motion(const Synth *s, int t, double F[9]);

/* Frame t, noise and foreground included, at the config's size. data, stride: as in L1L2StabFrame. */
void synth_render(const Synth *s, int t, L1L2StabFormat format, uint8_t *const data[4], const ptrdiff_t stride[4]);
void synth_render_gray(const Synth *s, int t, uint8_t *data, ptrdiff_t stride);

/* What a camera at M would see, without noise and foreground, at any size: what a perfect warp would give. */
void synth_render_view(const Synth *s, const double M[9], int width, int height, L1L2StabFormat format,
                       uint8_t *const data[4], const ptrdiff_t stride[4]);

/* A picture's memory, planes one after the other and rows without padding. */
typedef struct SynthPicture {
    L1L2StabFormat format;
    int width, height;  /* pixels */
    int planes;
    int rows[4];        /* of each plane */
    uint8_t *data[4];   /* data[0] is the start of all */
    ptrdiff_t stride[4];
    size_t size;        /* bytes in all */
} SynthPicture;

/* Zeroed. Aborts on an unknown format or when out of memory. */
SynthPicture synth_picture_new(L1L2StabFormat format, int width, int height);
void synth_picture_free(SynthPicture *p);

#endif
