/* SPDX-License-Identifier: MIT */
/* The pixel formats, one row each. Adding one? A row here, its number in the public header, its name in the caps. */
#include "format.h"

#define FULL(components) {components, 0, 0}
#define HALF_WIDE(components) {components, 1, 0}
#define HALF(components) {components, 1, 1}

static const L1L2FormatInfo formats[] = {
    {L1L2STAB_FORMAT_GRAY8, "GRAY8", 1, L1L2_LUMA_PLANE, {FULL(1)}},
    {L1L2STAB_FORMAT_I420, "I420", 3, L1L2_LUMA_PLANE, {FULL(1), HALF(1), HALF(1)}},
    {L1L2STAB_FORMAT_YV12, "YV12", 3, L1L2_LUMA_PLANE, {FULL(1), HALF(1), HALF(1)}},
    {L1L2STAB_FORMAT_NV12, "NV12", 2, L1L2_LUMA_PLANE, {FULL(1), HALF(2)}},
    {L1L2STAB_FORMAT_NV21, "NV21", 2, L1L2_LUMA_PLANE, {FULL(1), HALF(2)}},
    {L1L2STAB_FORMAT_Y42B, "Y42B", 3, L1L2_LUMA_PLANE, {FULL(1), HALF_WIDE(1), HALF_WIDE(1)}},
    {L1L2STAB_FORMAT_Y444, "Y444", 3, L1L2_LUMA_PLANE, {FULL(1), FULL(1), FULL(1)}},
    {L1L2STAB_FORMAT_BGRX, "BGRx", 1, L1L2_LUMA_BGR, {FULL(4)}},
    {L1L2STAB_FORMAT_RGBX, "RGBx", 1, L1L2_LUMA_RGB, {FULL(4)}},
    {L1L2STAB_FORMAT_BGRA, "BGRA", 1, L1L2_LUMA_BGR, {FULL(4)}},
    {L1L2STAB_FORMAT_RGBA, "RGBA", 1, L1L2_LUMA_RGB, {FULL(4)}},
    {L1L2STAB_FORMAT_BGR, "BGR", 1, L1L2_LUMA_BGR, {FULL(3)}},
    {L1L2STAB_FORMAT_RGB, "RGB", 1, L1L2_LUMA_RGB, {FULL(3)}},
};

const L1L2FormatInfo *l1l2_format_info(L1L2StabFormat format)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (formats[i].format == format)
            return &formats[i];
    return NULL;
}
