/* SPDX-License-Identifier: MIT */
/* What a pixel format looks like in memory: planes, subsampling, components. A leaf. */
#ifndef L1L2_FORMAT_H
#define L1L2_FORMAT_H

#include <l1l2stab/l1l2stab.h>

/* How the first plane becomes the grey picture that is tracked. */
typedef enum L1L2Luma {
    L1L2_LUMA_PLANE, /* it is the luma plane */
    L1L2_LUMA_BGR,   /* components 0, 1, 2 are blue, green, red */
    L1L2_LUMA_RGB    /* components 0, 1, 2 are red, green, blue */
} L1L2Luma;

typedef struct L1L2FormatInfo {
    L1L2StabFormat format;
    const char *name;      /* GStreamer's */
    int planes;            /* 1..3 */
    L1L2Luma luma;
    struct {
        int components;    /* interleaved samples of one byte: 1..4 */
        int log2_sub_x;    /* 0 or 1: horizontal subsampling */
        int log2_sub_y;    /* 0 or 1 */
    } plane[3];
} L1L2FormatInfo;

/* NULL for a format that is not offered. */
const L1L2FormatInfo *l1l2_format_info(L1L2StabFormat format);

/* Samples of a plane in a frame of `size` pixels: rounded up. */
static inline int l1l2_plane_size(int size, int log2_sub)
{
    return (size + (1 << log2_sub) - 1) >> log2_sub;
}

#endif
