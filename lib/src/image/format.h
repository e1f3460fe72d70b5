/* SPDX-License-Identifier: MIT */
/* How a pixel format lies in memory: its planes, their subsampling, their components. */
#ifndef L1L2_IMAGE_FORMAT_H
#define L1L2_IMAGE_FORMAT_H

#include <l1l2stab/l1l2stab.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { L1L2_MAX_PLANES = 4 };

typedef struct L1L2FormatInfo {
    L1L2StabFormat format;
    const char *name;       /* as GStreamer calls it */
    int depth;              /* bits of a component: 8 in one byte; 9..16 in two bytes, the low byte first */
    int shift;              /* unused low bits, all zero: 16 - depth if a component is at the top of its two bytes */
    double gray[4];         /* weights of a pixel's components in the gray picture that is tracked, sum 1 */
    int planes;             /* 1..4 */
    struct {
        int components;     /* interleaved: 1..4. Packed 4:2:2 has 4: the luma of two pixels and their chroma */
        int log2_sub_x;     /* log2 of the horizontal subsampling: 0..2 */
        int log2_sub_y;     /* log2 of the vertical subsampling: 0, 1 */
    } plane[L1L2_MAX_PLANES];
} L1L2FormatInfo;

/* NULL for a format that this library does not support on this processor. */
const L1L2FormatInfo *l1l2_image_format_info(L1L2StabFormat format);

/* Bytes of a component. */
static inline int l1l2_image_format_bytes(const L1L2FormatInfo *format)
{
    return format->depth > 8 ? 2 : 1;
}

/* Components of a pixel in the first plane. In packed 4:2:2 a pixel has its luma and one of the chroma components. */
static inline int l1l2_image_format_pixel_components(const L1L2FormatInfo *format)
{
    return format->plane[0].components >> format->plane[0].log2_sub_x;
}

/* Samples of a plane along an axis of `size` pixels: rounded up. */
static inline int l1l2_image_plane_size(int size, int log2_sub)
{
    return (size + (1 << log2_sub) - 1) >> log2_sub;
}

#ifdef __cplusplus
}
#endif

#endif
