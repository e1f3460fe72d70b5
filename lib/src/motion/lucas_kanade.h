/* SPDX-License-Identifier: MIT */
/*
 * Pyramidal Lucas-Kanade: finds where a point of one picture is in another.
 *
 * Source: Bouguet, "Pyramidal implementation of the Lucas Kanade feature tracker", 2000. At each level of a pyramid,
 * from the smallest, the window around the point is moved until the least-squares step is small.
 *
 * Points are in pixels of the largest level, with (0, 0) at the center of its first pixel. Windows are sampled between
 * pixels and summed in integers (lucas_kanade_patch.h), so every instruction set gives the same result.
 */
#ifndef L1L2_MOTION_LUCAS_KANADE_H
#define L1L2_MOTION_LUCAS_KANADE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Side of a window, and the pixels that must be readable around a level on its left and right, above and below. All in
 * pixels. The side of 11 was chosen on ten real clips by the difference of frame t to frame t-1 moved by the fitted
 * motion: 9, 11 and 15 are equally good, 15 costs twice as much as 11, and 9 loses more points. */
enum { L1L2_LK_WINDOW = 11, L1L2_LK_BORDER_X = 16, L1L2_LK_BORDER_Y = L1L2_LK_WINDOW };

/* One level of a picture's pyramid. Each level has half the size of the one before. */
typedef struct L1L2LkLevel {
    const uint8_t *grey;            /* address of pixel (0, 0) */
    const int16_t *slope;           /* for each pixel two slopes by Scharr's filter, across and down; 32 per gray level
                                     * and pixel */
    ptrdiff_t stride, slope_stride; /* of grey in bytes; of slope in int16_t */
    int width, height;              /* pixels, without the borders */
} L1L2LkLevel;

typedef struct L1L2LkPoint {
    float x, y;
} L1L2LkPoint;

/* Where a window lies: its first pixel, and the weights of that pixel, the one on its right, and the two below. */
typedef struct L1L2LkPlace {
    int x, y;
    int16_t weight[4]; /* 14 fractional bits, sum 1 */
} L1L2LkPlace;

enum { L1L2_LK_LANES = 16 }; /* words in a row of a patch: the window's, then zeros */

/* A sampled window: gray levels with 5 fractional bits, and slopes. */
typedef struct L1L2LkPatch {
    int16_t grey[L1L2_LK_WINDOW][L1L2_LK_LANES];
    int16_t across[L1L2_LK_WINDOW][L1L2_LK_LANES], down[L1L2_LK_WINDOW][L1L2_LK_LANES];
} L1L2LkPatch;

/* Sums over the window. take(): across^2, across * down, down^2. compare(), with d the difference of the picture's
 * window to the patch: d * across, d * down, 0. */
typedef struct L1L2LkSums {
    int64_t of[3];
} L1L2LkSums;

/* The inner loops for one instruction set. All give the same sums and patches. */
typedef struct L1L2LkFunctions {
    L1L2LkSums (*take)(const L1L2LkLevel *level, const L1L2LkPlace *place, L1L2LkPatch *patch);
    L1L2LkSums (*compare)(const L1L2LkLevel *level, const L1L2LkPlace *place, const L1L2LkPatch *patch);
} L1L2LkFunctions;

/* cpu: the instruction sets to use, flags of common/cpu.h. */
void l1l2_lk_functions_init(L1L2LkFunctions *functions, unsigned cpu);

/* Called by the function above, on processors that have the instruction set. */
void l1l2_lk_functions_init_sse2(L1L2LkFunctions *functions);

/* Looks for `from`, a point of picture a, in picture b, starting near *to, and writes where it is to *to. `levels` are
 * used of both. False: the point left the picture, or its window has too little texture to be followed; *to may have
 * changed. */
bool l1l2_lk_follow(const L1L2LkFunctions *functions, const L1L2LkLevel *a, const L1L2LkLevel *b, int levels,
                    L1L2LkPoint from, L1L2LkPoint *to);

#ifdef __cplusplus
}
#endif

#endif
