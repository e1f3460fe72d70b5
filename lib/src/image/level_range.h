/* SPDX-License-Identifier: MIT */
/*
 * The range of levels that deep pictures (more than 8 bits a component) use.
 *
 * A thermal camera's raw counts may span a few hundred of 65,536 levels. If the full range were reduced to 8 bits, such
 * a picture would be flat. This module finds the range of levels that the last pictures used, so that the picture that
 * is tracked can be stretched to it.
 *
 * A picture's own range reaches from the 1st to the 99th percentile of a sparse sample of its pixels, so a few dead
 * pixels or a line of text do not matter. A quarter of that is added at both ends, so levels beyond the percentiles
 * keep their contrast, and the darkest part of a scene does not become as black as a letterbox bar. The range of a
 * picture is the union of its own and of those of the 29 pictures before it, and its ends are rounded outwards to
 * steps. So it changes seldom, and it depends on 30 pictures only.
 *
 * The full range is kept for components of 8 bits, for pictures that use an eighth of the range or more, and for empty
 * pictures, whose percentiles are less than 32 steps of the format apart.
 */
#ifndef L1L2_IMAGE_LEVEL_RANGE_H
#define L1L2_IMAGE_LEVEL_RANGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/format.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Levels as the 16-bit numbers in memory: those of a 10-bit component at the top of its two bytes reach up to 65,536.
 * [low, high) becomes [0, 256). Full range: low 0, high 2^(depth + shift). */
typedef struct L1L2Levels {
    int32_t low, high;
} L1L2Levels;

enum { L1L2_LEVEL_FRAMES = 30 };

/* Clear it to zero before use; that also forgets all pictures. */
typedef struct L1L2LevelRange {
    L1L2Levels own[L1L2_LEVEL_FRAMES]; /* of each picture: from the 1st to the 99th percentile */
    int count, next;
} L1L2LevelRange;

/* The full range of a format. */
L1L2Levels l1l2_image_levels_full(const L1L2FormatInfo *format);

/* True if both are the same range. */
bool l1l2_image_levels_equal(L1L2Levels a, L1L2Levels b);

/* Takes the first plane of the next picture, width x height pixels, and returns the range to stretch it to. The stride
 * is in bytes. */
L1L2Levels l1l2_image_levels_push(L1L2LevelRange *range, const L1L2FormatInfo *format, const uint8_t *data,
                                  ptrdiff_t stride, int width, int height);

#ifdef __cplusplus
}
#endif

#endif
