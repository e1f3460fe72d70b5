/* SPDX-License-Identifier: MIT */
/*
 * Small gray pictures of the frames around the one that is rendered, to compare them with each other. Each is made when
 * it is first asked for, and kept as long as its frame may be a neighbor.
 *
 * Positions: a picture covers its frame exactly. Pixel (i, j) is centered at ((i + 1/2) / width - 1/2) of the frame's
 * width to the right of its center, and in the same way downwards.
 */
#ifndef L1L2_BORDER_GRAY_PICTURES_H
#define L1L2_BORDER_GRAY_PICTURES_H

#include "image/area_scale.h"

/* The longer side of a picture, pixels. Mean PSNR of what is filled, twelve real clips (tests/bench/bench_border): 320:
 * 31.7 dB, 480: 32.1, 640: 32.2, for 1.8 times the pixels. */
enum { L1L2_BORDER_GRAY_SIDE = 480 };

typedef struct L1L2BorderGray {
    int64_t t;          /* frame number; -1: none */
    L1L2Levels levels;  /* of the source that 0 .. 255 stand for. Pictures of other levels cannot be compared */
    uint8_t *level;     /* [height * width], row by row */
} L1L2BorderGray;

typedef struct L1L2BorderGrays {
    const L1L2FormatInfo *format;
    int frame_width, frame_height;
    int width, height;  /* of the pictures */
    int count;          /* of pictures that are kept: frame t is at t modulo count */
    L1L2BorderGray *picture;
    uint8_t *memory;
    L1L2AreaScaler *scaler;
    L1L2LevelRange range;
} L1L2BorderGrays;

/* For frames of a size, of which those within `count` consecutive numbers are asked for at any time. False when out of
 * memory. */
bool l1l2_border_grays_init(L1L2BorderGrays *grays, const L1L2FormatInfo *format, int width, int height, int count);

/* Frees the memory; a zeroed object is allowed. */
void l1l2_border_grays_clear(L1L2BorderGrays *grays);

/* Forgets all pictures. */
void l1l2_border_grays_reset(L1L2BorderGrays *grays);

/* The picture of frame t, whose first plane is at `data`. */
const L1L2BorderGray *l1l2_border_gray_of(L1L2BorderGrays *grays, int64_t t, const uint8_t *data, ptrdiff_t stride);

#endif
