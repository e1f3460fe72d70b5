/* SPDX-License-Identifier: MIT */
/*
 * A Gaussian pyramid of a gray picture, in floating point: Burt & Adelson, "The Laplacian pyramid as a compact image
 * code", 1983. Direct alignment works on it.
 *
 * Level 0 is the picture, halved until its longer side is at most L1L2_FLOAT_PYRAMID_SIDE samples, and blurred
 * slightly. Each further level is the mean of 2 x 2 samples of the one before it, so a level's samples are `step`
 * picture pixels apart and the first one's center lies `step / 2` pixels from the picture's left and top edge. An odd
 * last column or row is left out.
 */
#ifndef L1L2_IMAGE_FLOAT_PYRAMID_H
#define L1L2_IMAGE_FLOAT_PYRAMID_H

#include <stddef.h>
#include <stdint.h>

/* Samples. At 320 samples a motion is found to a few hundredths of a pixel of a 640-wide picture; see
 * motion/direct_alignment.h for what the size costs. */
enum { L1L2_FLOAT_PYRAMID_SIDE = 400, L1L2_FLOAT_PYRAMID_MAX_LEVELS = 6, L1L2_FLOAT_PYRAMID_MIN_SIDE = 16 };

typedef struct L1L2FloatLevel {
    float *sample;     /* row by row, without padding; gray levels */
    int width, height; /* samples */
    int step;          /* distance of samples, pixels of the picture */
} L1L2FloatLevel;

typedef struct L1L2FloatPyramid {
    int width, height; /* of the picture, pixels */
    int levels;
    L1L2FloatLevel level[L1L2_FLOAT_PYRAMID_MAX_LEVELS]; /* the largest one first */
    uint16_t *halved;  /* working memory */
    float *row;
} L1L2FloatPyramid;

/* For pictures of width x height pixels, both at least L1L2_FLOAT_PYRAMID_MIN_SIDE. NULL: no memory. */
L1L2FloatPyramid *l1l2_image_float_pyramid_new(int width, int height);
void l1l2_image_float_pyramid_free(L1L2FloatPyramid *p);

/* The pyramid of a picture. stride: bytes, of any sign. Allocates nothing. */
void l1l2_image_float_pyramid_build(L1L2FloatPyramid *p, const uint8_t *gray, ptrdiff_t stride);

#endif
