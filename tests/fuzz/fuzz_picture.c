/* SPDX-License-Identifier: MIT */
#include "fuzz_picture.h"

static void add_plane(FuzzPicture *picture, FuzzInput *in, size_t row, int rows)
{
    const int i = picture->planes++;
    const size_t step = row + 2 * (size_t)fuzz_below(in, 20);
    picture->row[i] = row;
    picture->rows[i] = rows;
    picture->size[i] = step * (size_t)(rows - 1) + row;
    picture->block[i] = malloc(picture->size[i]);
    FUZZ_CHECK(picture->block[i], "out of memory");
    memset(picture->block[i], FUZZ_PADDING, picture->size[i]);
    picture->stride[i] = (ptrdiff_t)step;
    picture->data[i] = picture->block[i];
    if (fuzz_chance(in, 8)) { /* bottom up */
        picture->data[i] += step * (size_t)(rows - 1);
        picture->stride[i] = -picture->stride[i];
    }
}

FuzzPicture *fuzz_picture_new(FuzzInput *in, const L1L2FormatInfo *format, int width, int height)
{
    FuzzPicture *picture = calloc(1, sizeof *picture);
    FUZZ_CHECK(picture, "out of memory");
    for (int i = 0; i < format->planes; i++) {
        const size_t row = (size_t)l1l2_image_plane_size(width, format->plane[i].log2_sub_x) *
                           (size_t)format->plane[i].components * (size_t)l1l2_image_format_bytes(format);
        /* Rows of two-byte components need an even stride. */
        add_plane(picture, in, row, l1l2_image_plane_size(height, format->plane[i].log2_sub_y));
    }
    return picture;
}

void fuzz_picture_free(FuzzPicture *picture)
{
    for (int i = 0; picture && i < picture->planes; i++)
        free(picture->block[i]);
    free(picture);
}

/* Blocks of 4 by 4 samples with random levels. */
static uint8_t scene_level(const FuzzCamera *camera, int x, int y)
{
    uint32_t hash = (uint32_t)(x + camera->x) / 4 * 73856093u ^ (uint32_t)(y + camera->y) / 4 * 19349663u;
    hash = (hash ^ camera->scene * 83492791u) * 2246822519u;
    return (uint8_t)(hash >> 24);
}

static void fill_scene(FuzzPicture *picture, int plane, const FuzzCamera *camera)
{
    for (int y = 0; y < picture->rows[plane]; y++) {
        uint8_t *row = picture->data[plane] + y * picture->stride[plane];
        for (size_t x = 0; x < picture->row[plane]; x++)
            row[x] = scene_level(camera, (int)x, y);
    }
}

static void fill_flat(FuzzPicture *picture, int plane, uint8_t level)
{
    for (int y = 0; y < picture->rows[plane]; y++)
        memset(picture->data[plane] + y * picture->stride[plane], level, picture->row[plane]);
}

static void fill_noise(FuzzPicture *picture, int plane, uint32_t seed)
{
    for (int y = 0; y < picture->rows[plane]; y++)
        for (size_t x = 0; x < picture->row[plane]; x++) {
            seed = seed * 1664525u + 1013904223u;
            picture->data[plane][y * picture->stride[plane] + (ptrdiff_t)x] = (uint8_t)(seed >> 24);
        }
}

void fuzz_picture_fill(FuzzPicture *picture, FuzzInput *in, FuzzCamera *camera)
{
    const int kind = fuzz_below(in, 16);
    const uint8_t value = (uint8_t)fuzz_byte(in);
    if (kind == 13)
        camera->scene++;
    camera->x += value % 7 - 3 + 1000 * (kind == 12);
    camera->y += value / 7 % 7 - 3;
    for (int i = 0; i < picture->planes; i++) {
        if (kind < 14)
            fill_scene(picture, i, camera);
        else if (kind == 14)
            fill_flat(picture, i, value);
        else
            fill_noise(picture, i, value);
    }
}

static void check_padding(const FuzzPicture *picture, int plane, int y)
{
    const size_t step = (size_t)llabs(picture->stride[plane]);
    const uint8_t *row = picture->block[plane] + (size_t)y * step;
    if (y + 1 == picture->rows[plane]) /* the block ends here */
        return;
    for (size_t x = picture->row[plane]; x < step; x++)
        FUZZ_CHECK(row[x] == FUZZ_PADDING, "byte %zu after row %d of plane %d was written", x, y, plane);
}

uint64_t fuzz_picture_hash(const FuzzPicture *picture, uint64_t hash)
{
    for (int i = 0; i < picture->planes; i++)
        for (int y = 0; y < picture->rows[i]; y++) {
            hash = fuzz_hash(hash, picture->data[i] + y * picture->stride[i], picture->row[i]);
            check_padding(picture, i, y);
        }
    return hash;
}
