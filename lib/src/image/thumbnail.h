/* SPDX-License-Identifier: MIT */
/*
 * Thumbnails: 32x18 gray levels of a frame, and a measure of how similar two of them are.
 *
 * Two thumbnails are compared by their normalized cross-correlation, at the small shift where it is largest. It ignores
 * brightness and contrast, so neither a flash nor a change of exposure makes two pictures differ. A picture without
 * detail (a covered lens, a black frame) is neither like nor unlike any other.
 */
#ifndef L1L2_IMAGE_THUMBNAIL_H
#define L1L2_IMAGE_THUMBNAIL_H

#include <stdbool.h>
#include <stdint.h>

#define L1L2_THUMBNAIL_W 32
#define L1L2_THUMBNAIL_H 18

typedef struct L1L2Thumbnail {
    uint8_t level[L1L2_THUMBNAIL_H * L1L2_THUMBNAIL_W]; /* row by row */
} L1L2Thumbnail;

/* True if the picture has detail: its standard deviation is more than noise and compression artifacts make. */
bool l1l2_image_thumbnail_has_detail(const L1L2Thumbnail *thumbnail);

/* The best correlation over shifts of up to an eighth of the picture, [-1, 1]; 0 if either has no detail. */
double l1l2_image_thumbnail_correlation(const L1L2Thumbnail *a, const L1L2Thumbnail *b);

/* True if both have detail and show different things: neither the whole pictures nor enough of their blocks match. */
bool l1l2_image_thumbnails_differ(const L1L2Thumbnail *a, const L1L2Thumbnail *b);

#endif
