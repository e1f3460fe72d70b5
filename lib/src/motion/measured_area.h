/* SPDX-License-Identifier: MIT */
/*
 * The part of the frame that is measured, as the caller chose it: a rectangle, and a mask that is scaled to the frame.
 * What either of them leaves out is excluded.
 */
#ifndef L1L2_MOTION_MEASURED_AREA_H
#define L1L2_MOTION_MEASURED_AREA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct L1L2MeasuredArea {
    double region[4];      /* x, y, width, height in parts of the frame's sides */
    const uint8_t *mask;   /* 0: not measured there. NULL: the whole region is measured. The caller's */
    ptrdiff_t mask_stride; /* bytes */
    int mask_width, mask_height;
} L1L2MeasuredArea;

/* The least part of the frame that has to be left. The smallest region has 1.6 %, less what is lost where its sides cut
 * through pixels. */
static const double l1l2_motion_area_least = 0.01;

/* True if the area is the whole frame and there is no mask. */
bool l1l2_motion_area_is_whole(const L1L2MeasuredArea *area);

/* Marks, row by row, the pixels of a small picture of the frame: 0 if all of the pixel is measured, else 1. Returns the
 * part of the pixels that are measured, [0, 1]. */
double l1l2_motion_area_mark(const L1L2MeasuredArea *area, uint8_t *excluded, int width, int height);

#endif
