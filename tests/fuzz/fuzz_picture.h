/* SPDX-License-Identifier: MIT */
/* Pictures in blocks of memory that end with the last sample, so that AddressSanitizer sees each access beyond it. */
#ifndef FUZZ_PICTURE_H
#define FUZZ_PICTURE_H

#include "fuzz_input.h"
#include "image/format.h"

typedef struct FuzzPicture {
    uint8_t *block[L1L2_MAX_PLANES];
    uint8_t *data[L1L2_MAX_PLANES]; /* the first row */
    ptrdiff_t stride[L1L2_MAX_PLANES];
    size_t size[L1L2_MAX_PLANES], row[L1L2_MAX_PLANES]; /* bytes of the block, and of a row's samples */
    int rows[L1L2_MAX_PLANES], planes;
} FuzzPicture;

/* What the bytes between two rows hold. */
#define FUZZ_PADDING 0xa5

/* Chooses the strides, also negative ones. */
FuzzPicture *fuzz_picture_new(FuzzInput *in, const L1L2FormatInfo *format, int width, int height);
void fuzz_picture_free(FuzzPicture *picture);

/* What has to be remembered from frame to frame. */
typedef struct FuzzCamera {
    int x, y;
    uint32_t scene;
} FuzzCamera;

/* Chooses the contents: mostly a scene that moves a little, else a cut, a flat picture or noise. */
void fuzz_picture_fill(FuzzPicture *picture, FuzzInput *in, FuzzCamera *camera);

/* Adds the samples to a hash, and fails if a byte between two rows is not as it was. */
uint64_t fuzz_picture_hash(const FuzzPicture *picture, uint64_t hash);

/* FNV-1a */
static inline uint64_t fuzz_hash(uint64_t hash, const void *data, size_t size)
{
    const uint8_t *bytes = data;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

#endif
