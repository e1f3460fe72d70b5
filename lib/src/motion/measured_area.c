/* SPDX-License-Identifier: MIT */
#include "motion/measured_area.h"

#include <math.h>
#include <string.h>

/* Rows or columns [first, end) of a picture. */
typedef struct Span {
    int first, end;
} Span;

bool l1l2_motion_area_is_whole(const L1L2MeasuredArea *area)
{
    const double *r = area->region;
    return r[0] <= 0.0 && r[1] <= 0.0 && r[2] >= 1.0 && r[3] >= 1.0 && !area->mask;
}

/* The pixels along one side that lie wholly in [from, from + length], in parts of the side. */
static Span pixels_within(double from, double length, int pixels)
{
    const double rounding = 1e-6; /* 0.2 of 320 pixels begins at pixel 64 */
    const Span span = {(int)ceil(from * pixels - rounding), (int)floor((from + length) * pixels + rounding)};
    return (Span){span.first > 0 ? span.first : 0, span.end < pixels ? span.end : pixels};
}

/* The mask's pixels that pixel i of a picture's side touches. */
static Span mask_pixels(int i, int pixels, int mask_pixels)
{
    const int64_t size = mask_pixels;
    return (Span){(int)(i * size / pixels), (int)(((i + 1) * size + pixels - 1) / pixels)};
}

/* Excludes the pixels of a row that touch an excluded pixel of a row of the mask. */
static void exclude_by_mask(const L1L2MeasuredArea *area, int mask_row, uint8_t *excluded, int width)
{
    const uint8_t *mask = area->mask + mask_row * area->mask_stride;
    for (int x = 0; x < width; x++) {
        const Span columns = mask_pixels(x, width, area->mask_width);
        excluded[x] |= memchr(mask + columns.first, 0, (size_t)(columns.end - columns.first)) != NULL;
    }
}

double l1l2_motion_area_mark(const L1L2MeasuredArea *area, uint8_t *excluded, int width, int height)
{
    const Span columns = pixels_within(area->region[0], area->region[2], width);
    const Span rows = pixels_within(area->region[1], area->region[3], height);
    int64_t measured = 0;
    memset(excluded, 1, (size_t)width * (size_t)height);
    for (int y = rows.first; y < rows.end && columns.first < columns.end; y++) {
        uint8_t *row = excluded + (ptrdiff_t)y * width;
        memset(row + columns.first, 0, (size_t)(columns.end - columns.first));
        const Span by = mask_pixels(y, height, area->mask_height);
        for (int j = by.first; area->mask && j < by.end; j++)
            exclude_by_mask(area, j, row, width);
        for (int x = columns.first; x < columns.end; x++)
            measured += !row[x];
    }
    return (double)measured / ((double)width * height);
}
