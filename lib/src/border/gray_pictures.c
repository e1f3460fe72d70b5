/* SPDX-License-Identifier: MIT */
#include "border/gray_pictures.h"

#include "common/mem.h"

static int scaled(int size, int longer)
{
    const int side = longer < L1L2_BORDER_GRAY_SIDE ? longer : L1L2_BORDER_GRAY_SIDE;
    const int result = (int)((2 * (int64_t)size * side + longer) / (2 * longer));
    return result < 1 ? 1 : result;
}

bool l1l2_border_grays_init(L1L2BorderGrays *grays, const L1L2FormatInfo *format, int width, int height, int count)
{
    const int longer = width > height ? width : height;
    *grays = (L1L2BorderGrays){.format = format, .frame_width = width, .frame_height = height,
                               .width = scaled(width, longer), .height = scaled(height, longer), .count = count};
    const size_t size = (size_t)grays->width * (size_t)grays->height;
    grays->picture = l1l2_mem_new((size_t)count, sizeof *grays->picture);
    grays->memory = l1l2_mem_new((size_t)count, size);
    grays->scaler = l1l2_image_scale_new(format, width, height, grays->width, grays->height);
    if (!grays->picture || !grays->memory || !grays->scaler)
        return false;
    for (int i = 0; i < count; i++)
        grays->picture[i].level = grays->memory + (size_t)i * size;
    l1l2_border_grays_reset(grays);
    return true;
}

void l1l2_border_grays_clear(L1L2BorderGrays *grays)
{
    l1l2_image_scale_free(grays->scaler);
    l1l2_mem_free(grays->memory);
    l1l2_mem_free(grays->picture);
    *grays = (L1L2BorderGrays){0};
}

void l1l2_border_grays_reset(L1L2BorderGrays *grays)
{
    grays->range = (L1L2LevelRange){.count = 0};
    for (int i = 0; i < grays->count; i++)
        grays->picture[i].t = -1;
}

const L1L2BorderGray *l1l2_border_gray_of(L1L2BorderGrays *grays, int64_t t, const uint8_t *data, ptrdiff_t stride)
{
    L1L2BorderGray *picture = &grays->picture[t % grays->count];
    if (picture->t == t)
        return picture;
    picture->t = t;
    picture->levels = l1l2_image_levels_push(&grays->range, grays->format, data, stride, grays->frame_width,
                                             grays->frame_height);
    l1l2_image_scale_set_levels(grays->scaler, picture->levels);
    l1l2_image_scale_run(grays->scaler, data, stride, picture->level, grays->width);
    return picture;
}
