/* SPDX-License-Identifier: MIT */
/* The pixel formats, one row each. A new format needs a row here, its number in the public header and its name in the
 * element's caps; if it is packed 4:2:2, also its layout in warp/packed422.c. */
#include "image/format.h"

#include <stdbool.h>

/* The gray picture: luma, the green plane of planar RGB, or BT.601's mix of the colors. */
#define FIRST {1.0}
#define SECOND {0.0, 1.0}
#define THIRD {0.0, 0.0, 1.0}
#define BGR {0.114, 0.587, 0.299}
#define RGB {0.299, 0.587, 0.114}
#define XBGR {0.0, 0.114, 0.587, 0.299}
#define XRGB {0.0, 0.299, 0.587, 0.114}

#define FULL(components) {components, 0, 0}
#define HALF_WIDE(components) {components, 1, 0}
#define HALF(components) {components, 1, 1}
#define QUARTER_WIDE(components) {components, 2, 0}

/* Number, name, depth, shift, gray, planes. */
#define ROW(id, name, depth, shift, gray, planes, ...)                                                                \
    {L1L2STAB_FORMAT_##id, name, depth, shift, gray, planes, {__VA_ARGS__}}

static const L1L2FormatInfo formats[] = {
    ROW(GRAY8, "GRAY8", 8, 0, FIRST, 1, FULL(1)),
    ROW(I420, "I420", 8, 0, FIRST, 3, FULL(1), HALF(1), HALF(1)),
    ROW(YV12, "YV12", 8, 0, FIRST, 3, FULL(1), HALF(1), HALF(1)),
    ROW(NV12, "NV12", 8, 0, FIRST, 2, FULL(1), HALF(2)),
    ROW(NV21, "NV21", 8, 0, FIRST, 2, FULL(1), HALF(2)),
    ROW(Y42B, "Y42B", 8, 0, FIRST, 3, FULL(1), HALF_WIDE(1), HALF_WIDE(1)),
    ROW(Y444, "Y444", 8, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(BGRX, "BGRx", 8, 0, BGR, 1, FULL(4)),
    ROW(RGBX, "RGBx", 8, 0, RGB, 1, FULL(4)),
    ROW(BGRA, "BGRA", 8, 0, BGR, 1, FULL(4)),
    ROW(RGBA, "RGBA", 8, 0, RGB, 1, FULL(4)),
    ROW(BGR, "BGR", 8, 0, BGR, 1, FULL(3)),
    ROW(RGB, "RGB", 8, 0, RGB, 1, FULL(3)),
    ROW(A420, "A420", 8, 0, FIRST, 4, FULL(1), HALF(1), HALF(1), FULL(1)),
    ROW(AV12, "AV12", 8, 0, FIRST, 3, FULL(1), HALF(2), FULL(1)),
    ROW(NV16, "NV16", 8, 0, FIRST, 2, FULL(1), HALF_WIDE(2)),
    ROW(NV61, "NV61", 8, 0, FIRST, 2, FULL(1), HALF_WIDE(2)),
    ROW(NV24, "NV24", 8, 0, FIRST, 2, FULL(1), FULL(2)),
    ROW(Y41B, "Y41B", 8, 0, FIRST, 3, FULL(1), QUARTER_WIDE(1), QUARTER_WIDE(1)),
    ROW(XRGB, "xRGB", 8, 0, XRGB, 1, FULL(4)),
    ROW(XBGR, "xBGR", 8, 0, XBGR, 1, FULL(4)),
    ROW(ARGB, "ARGB", 8, 0, XRGB, 1, FULL(4)),
    ROW(ABGR, "ABGR", 8, 0, XBGR, 1, FULL(4)),
    ROW(AYUV, "AYUV", 8, 0, SECOND, 1, FULL(4)),
    ROW(VUYA, "VUYA", 8, 0, THIRD, 1, FULL(4)),
    ROW(GBR, "GBR", 8, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(GBRA, "GBRA", 8, 0, FIRST, 4, FULL(1), FULL(1), FULL(1), FULL(1)),
    ROW(YUY2, "YUY2", 8, 0, FIRST, 1, HALF_WIDE(4)),
    ROW(UYVY, "UYVY", 8, 0, SECOND, 1, HALF_WIDE(4)),
    ROW(YVYU, "YVYU", 8, 0, FIRST, 1, HALF_WIDE(4)),
    ROW(VYUY, "VYUY", 8, 0, SECOND, 1, HALF_WIDE(4)),
    ROW(GRAY16_LE, "GRAY16_LE", 16, 0, FIRST, 1, FULL(1)),
    ROW(I420_10LE, "I420_10LE", 10, 0, FIRST, 3, FULL(1), HALF(1), HALF(1)),
    ROW(I420_12LE, "I420_12LE", 12, 0, FIRST, 3, FULL(1), HALF(1), HALF(1)),
    ROW(I422_10LE, "I422_10LE", 10, 0, FIRST, 3, FULL(1), HALF_WIDE(1), HALF_WIDE(1)),
    ROW(I422_12LE, "I422_12LE", 12, 0, FIRST, 3, FULL(1), HALF_WIDE(1), HALF_WIDE(1)),
    ROW(Y444_10LE, "Y444_10LE", 10, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(Y444_12LE, "Y444_12LE", 12, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(Y444_16LE, "Y444_16LE", 16, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(A420_10LE, "A420_10LE", 10, 0, FIRST, 4, FULL(1), HALF(1), HALF(1), FULL(1)),
    ROW(A422_10LE, "A422_10LE", 10, 0, FIRST, 4, FULL(1), HALF_WIDE(1), HALF_WIDE(1), FULL(1)),
    ROW(A444_10LE, "A444_10LE", 10, 0, FIRST, 4, FULL(1), FULL(1), FULL(1), FULL(1)),
    ROW(GBR_10LE, "GBR_10LE", 10, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(GBR_12LE, "GBR_12LE", 12, 0, FIRST, 3, FULL(1), FULL(1), FULL(1)),
    ROW(GBRA_10LE, "GBRA_10LE", 10, 0, FIRST, 4, FULL(1), FULL(1), FULL(1), FULL(1)),
    ROW(GBRA_12LE, "GBRA_12LE", 12, 0, FIRST, 4, FULL(1), FULL(1), FULL(1), FULL(1)),
    ROW(P010_10LE, "P010_10LE", 10, 6, FIRST, 2, FULL(1), HALF(2)),
    ROW(P012_LE, "P012_LE", 12, 4, FIRST, 2, FULL(1), HALF(2)),
    ROW(P016_LE, "P016_LE", 16, 0, FIRST, 2, FULL(1), HALF(2)),
    ROW(ARGB64_LE, "ARGB64_LE", 16, 0, XRGB, 1, FULL(4)),
    ROW(RGBA64_LE, "RGBA64_LE", 16, 0, RGB, 1, FULL(4)),
    ROW(BGRA64_LE, "BGRA64_LE", 16, 0, BGR, 1, FULL(4)),
    ROW(ABGR64_LE, "ABGR64_LE", 16, 0, XBGR, 1, FULL(4)),
    ROW(AYUV64, "AYUV64", 16, 0, SECOND, 1, FULL(4)),
};

/* Components of two bytes are read and written as the processor's own 16-bit numbers. */
static bool is_readable(const L1L2FormatInfo *info)
{
    const uint16_t one = 1;
    return info->depth <= 8 || *(const uint8_t *)&one == 1;
}

const L1L2FormatInfo *l1l2_image_format_info(L1L2StabFormat format)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (formats[i].format == format && is_readable(&formats[i]))
            return &formats[i];
    return NULL;
}
