/* SPDX-License-Identifier: MIT */
/* The pixel formats, one row each. Adding one? A row here, its number in the public header, its name in the caps. */
#include "format.h"

/* Grey: luma, the green plane of planar RGB, or BT.601's mix. */
#define FIRST {1.0}
#define BGR {0.114, 0.587, 0.299}
#define RGB {0.299, 0.587, 0.114}

#define FULL(components) {components, 0, 0}
#define HALF_WIDE(components) {components, 1, 0}
#define HALF(components) {components, 1, 1}

/* Format, name, depth, shift, grey, planes. */
static const L1L2FormatInfo formats[] = {
    {L1L2STAB_FORMAT_GRAY8, "GRAY8", 8, 0, FIRST, 1, {FULL(1)}},
    {L1L2STAB_FORMAT_I420, "I420", 8, 0, FIRST, 3, {FULL(1), HALF(1), HALF(1)}},
    {L1L2STAB_FORMAT_YV12, "YV12", 8, 0, FIRST, 3, {FULL(1), HALF(1), HALF(1)}},
    {L1L2STAB_FORMAT_NV12, "NV12", 8, 0, FIRST, 2, {FULL(1), HALF(2)}},
    {L1L2STAB_FORMAT_NV21, "NV21", 8, 0, FIRST, 2, {FULL(1), HALF(2)}},
    {L1L2STAB_FORMAT_Y42B, "Y42B", 8, 0, FIRST, 3, {FULL(1), HALF_WIDE(1), HALF_WIDE(1)}},
    {L1L2STAB_FORMAT_Y444, "Y444", 8, 0, FIRST, 3, {FULL(1), FULL(1), FULL(1)}},
    {L1L2STAB_FORMAT_BGRX, "BGRx", 8, 0, BGR, 1, {FULL(4)}},
    {L1L2STAB_FORMAT_RGBX, "RGBx", 8, 0, RGB, 1, {FULL(4)}},
    {L1L2STAB_FORMAT_BGRA, "BGRA", 8, 0, BGR, 1, {FULL(4)}},
    {L1L2STAB_FORMAT_RGBA, "RGBA", 8, 0, RGB, 1, {FULL(4)}},
    {L1L2STAB_FORMAT_BGR, "BGR", 8, 0, BGR, 1, {FULL(3)}},
    {L1L2STAB_FORMAT_RGB, "RGB", 8, 0, RGB, 1, {FULL(3)}},
};

const L1L2FormatInfo *l1l2_format_info(L1L2StabFormat format)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (formats[i].format == format)
            return &formats[i];
    return NULL;
}
