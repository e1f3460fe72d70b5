/* SPDX-License-Identifier: MIT */
/*
 * The seam to the imaging library: the grey, downscaled picture of each frame, its pyramid, Shi-Tomasi corners
 * (Shi & Tomasi, CVPR 1994), and points followed by flow.h. Plain C types only; the other side is vision_opencv.cpp.
 *
 * Points are pixels of the downscaled picture as the imaging library counts them: origin at the top left pixel's
 * centre. l1l2_vision_size() tells that picture's size, so that the caller can convert.
 */
#ifndef L1L2_MOTION_VISION_H
#define L1L2_MOTION_VISION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/format.h"
#include "image/thumbnail.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct L1L2Vision L1L2Vision;

typedef struct L1L2VisionConfig {
    const L1L2FormatInfo *format;
    int width, height;    /* of the frames, pixels */
    int analysis_size;    /* longer side of the downscaled picture, pixels; frames are never enlarged */
    const L1L2StabLogger *log;
} L1L2VisionConfig;

typedef struct L1L2Pixel {
    float x, y;
} L1L2Pixel;

/* Cells of the picture, row by row, in which no corner is looked for. */
#define L1L2_MASK_W 32
#define L1L2_MASK_H 18
#define L1L2_MASK_CELLS (L1L2_MASK_W * L1L2_MASK_H)
typedef struct L1L2Mask {
    bool blocked[L1L2_MASK_CELLS];
} L1L2Mask;

/* On error *out is NULL. cfg->log must outlive the object. */
L1L2StabResult l1l2_vision_create(L1L2Vision **out, const L1L2VisionConfig *cfg);
void l1l2_vision_free(L1L2Vision *v);

/* Forget both pictures. */
void l1l2_vision_reset(L1L2Vision *v);

/* Size of the downscaled picture. */
void l1l2_vision_size(const L1L2Vision *v, int *width, int *height);

/* The current picture becomes the previous one; the frame's first plane, downscaled by area averaging, becomes the
 * current one, with its pyramid. Each pyramid is built once. */
L1L2StabResult l1l2_vision_advance(L1L2Vision *v, const uint8_t *data, ptrdiff_t stride);

/* The current picture as a thumbnail, downscaled by area averaging. */
L1L2StabResult l1l2_vision_thumbnail(L1L2Vision *v, L1L2Thumbnail *thumbnail);

/* Up to `capacity` new corners of the PREVIOUS picture, strongest first, at least min_distance pixels from each other
 * and from the `count` points of `taken`, none in the mask (NULL: anywhere) nor where black bars begin. *found says how
 * many. */
L1L2StabResult l1l2_vision_corners(L1L2Vision *v, const L1L2Pixel *taken, int count, const L1L2Mask *mask,
                                   double min_distance, L1L2Pixel *corners, int capacity, int *found);

/* Follow `count` points of the previous picture into the current one and back.
 * ok[i]: found both ways, within the picture, and back within max_return pixels of where it started. */
L1L2StabResult l1l2_vision_track(L1L2Vision *v, const L1L2Pixel *from, L1L2Pixel *to, bool *ok, int count,
                                 double max_return);

#ifdef __cplusplus
}
#endif

#endif
