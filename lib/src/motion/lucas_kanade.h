/* SPDX-License-Identifier: MIT */
/*
 * Pyramidal Lucas-Kanade (Bouguet, "Pyramidal implementation of the Lucas Kanade feature tracker", 2000): where a point
 * of one picture is in another. A leaf.
 *
 * Points are pixels of the largest level, (0, 0) the centre of its first. Pictures are sampled between pixels with 5
 * fractional bits, sums are exact: every implementation gives the same.
 */
#ifndef L1L2_MOTION_LUCAS_KANADE_H
#define L1L2_MOTION_LUCAS_KANADE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Pixels: a window's side; what can be read around a level, on its left and right and above and below.
 * Measured on ten real clips (difference of frame t-1, moved by the fit, to frame t): windows of 9, 11 and 15 px are
 * equally good, 15 costs twice as much as 11, and 9 loses more points. */
enum { L1L2_LK_WINDOW = 11, L1L2_LK_BORDER_X = 16, L1L2_LK_BORDER_Y = L1L2_LK_WINDOW };

/* A level is half the size of the one before. */
typedef struct L1L2LkLevel {
    const uint8_t *grey;    /* of pixel (0, 0) */
    const int16_t *slope;   /* its slopes, across and down, by turns: Scharr's, 32 for a grey level a pixel */
    ptrdiff_t stride, slope_stride; /* bytes; int16_t */
    int width, height;
} L1L2LkLevel;

typedef struct L1L2LkPoint {
    float x, y;
} L1L2LkPoint;

/* Looks for `from`, a point of picture `a`, in picture `b`, at first near *to, and puts there where it is. False: it is
 * out of the picture, or nothing is there to follow; *to may have changed all the same. */
bool l1l2_lk_follow(const L1L2LkLevel *a, const L1L2LkLevel *b, int levels, L1L2LkPoint from,
                      L1L2LkPoint *to);

#ifdef __cplusplus
}
#endif

#endif
