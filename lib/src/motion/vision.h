/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 1, on pictures: the downscaled gray picture of each frame with its pyramid, Shi-Tomasi corners
 * (Shi & Tomasi, "Good features to track", CVPR 1994), and points tracked by lucas_kanade.h. This interface has plain C
 * types only; vision_opencv.cpp implements it.
 *
 * Points are pixels of the downscaled picture, with the origin at the center of the top left pixel. l1l2_vision_size()
 * gives that picture's size.
 */
#ifndef L1L2_MOTION_VISION_H
#define L1L2_MOTION_VISION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/format.h"
#include "image/thumbnail.h"
#include "motion/parameters.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct L1L2Vision L1L2Vision;

typedef struct L1L2VisionConfig {
    const L1L2FormatInfo *format;
    int width, height;    /* of the frames, pixels */
    int analysis_size;    /* longer side of the downscaled picture, pixels; frames are never enlarged */
    const L1L2MotionParameters *parameters;
    const L1L2StabLogger *log;
} L1L2VisionConfig;

typedef struct L1L2Pixel {
    float x, y;
} L1L2Pixel;

typedef struct L1L2GrayPicture {
    const uint8_t *data;
    ptrdiff_t stride; /* bytes */
    int width, height;
} L1L2GrayPicture;

/* Cells of the picture, row by row: 1 where no corner is selected. */
typedef struct L1L2Mask {
    const uint8_t *blocked; /* NULL: none is */
    int width, height;      /* cells */
} L1L2Mask;

/* On error *out is NULL. cfg->parameters and cfg->log must outlive the object. Pyramids are allocated here. */
L1L2StabResult l1l2_vision_create(L1L2Vision **out, const L1L2VisionConfig *cfg);
void l1l2_vision_free(L1L2Vision *v);

/* Forgets both pictures. */
void l1l2_vision_reset(L1L2Vision *v);

/* The size of the downscaled picture, pixels. */
void l1l2_vision_size(const L1L2Vision *v, int *width, int *height);

/* The current picture becomes the previous one. The frame's first plane, downscaled by area averaging, becomes the
 * current one, and its pyramid is built. */
L1L2StabResult l1l2_vision_advance(L1L2Vision *v, const uint8_t *data, ptrdiff_t stride);

/* A level of a downscaled picture's pyramid: 0 is the picture, each further one has half its size, rounded up; of
 * levels that a small picture lacks, the last one. previous: of the picture before the current one, in the current
 * one's brightness where that changed much. Valid until the next l1l2_vision_advance(). */
L1L2GrayPicture l1l2_vision_picture(const L1L2Vision *v, bool previous, int level);

/* The current picture as a thumbnail, downscaled by area averaging. */
L1L2StabResult l1l2_vision_thumbnail(L1L2Vision *v, L1L2Thumbnail *thumbnail);

/* Finds up to `capacity` new corners of the PREVIOUS picture, the strongest first, at least min_distance pixels from
 * each other and from the `count` points of `taken`, none in the mask (NULL: no mask) nor at the edge of black bars.
 * *found is their number. */
L1L2StabResult l1l2_vision_corners(L1L2Vision *v, const L1L2Pixel *taken, int count, const L1L2Mask *mask,
                                   double min_distance, L1L2Pixel *corners, int capacity, int *found);

/* Tracks `count` points of the previous picture into the current one and back. ok[i]: found both ways, within the
 * picture, and back within max_return pixels of where it started. */
L1L2StabResult l1l2_vision_track(L1L2Vision *v, const L1L2Pixel *from, L1L2Pixel *to, bool *ok, int count,
                                 double max_return);

#ifdef __cplusplus
}
#endif

#endif
