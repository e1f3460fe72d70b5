/* SPDX-License-Identifier: MIT */
#include "synth_picture.h"

#include <stdlib.h>

#include "synth_scene.h"

SynthLayout synth_layout_of(L1L2StabFormat format)
{
    switch (format) {
    case L1L2STAB_FORMAT_GRAY8: return (SynthLayout){1, 0, 0, {0}, {-1}, 0, 0, 8, 0};
    case L1L2STAB_FORMAT_I420: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 1, 8, 0};
    case L1L2STAB_FORMAT_YV12: return (SynthLayout){3, 0, 0, {0, 2, 1}, {-1, -1, -1}, 1, 1, 8, 0};
    case L1L2STAB_FORMAT_NV12: return (SynthLayout){2, 0, 0, {0, 1}, {-1, 2}, 1, 1, 8, 0};
    case L1L2STAB_FORMAT_NV21: return (SynthLayout){2, 0, 0, {0, 2}, {-1, 1}, 1, 1, 8, 0};
    case L1L2STAB_FORMAT_Y42B: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 0, 8, 0};
    case L1L2STAB_FORMAT_Y444: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 0, 0, 8, 0};
    case L1L2STAB_FORMAT_NV16: return (SynthLayout){2, 0, 0, {0, 1}, {-1, 2}, 1, 0, 8, 0};
    case L1L2STAB_FORMAT_NV61: return (SynthLayout){2, 0, 0, {0, 2}, {-1, 1}, 1, 0, 8, 0};
    case L1L2STAB_FORMAT_NV24: return (SynthLayout){2, 0, 0, {0, 1}, {-1, 2}, 0, 0, 8, 0};
    case L1L2STAB_FORMAT_GRAY16_LE: return (SynthLayout){1, 0, 0, {0}, {-1}, 0, 0, 16, 0};
    case L1L2STAB_FORMAT_I420_10LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 1, 10, 0};
    case L1L2STAB_FORMAT_I420_12LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 1, 12, 0};
    case L1L2STAB_FORMAT_I422_10LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 0, 10, 0};
    case L1L2STAB_FORMAT_I422_12LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 0, 12, 0};
    case L1L2STAB_FORMAT_Y444_10LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 0, 0, 10, 0};
    case L1L2STAB_FORMAT_Y444_12LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 0, 0, 12, 0};
    case L1L2STAB_FORMAT_Y444_16LE: return (SynthLayout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 0, 0, 16, 0};
    case L1L2STAB_FORMAT_P010_10LE: return (SynthLayout){2, 0, 0, {0, 1}, {-1, 2}, 1, 1, 10, 6};
    case L1L2STAB_FORMAT_P012_LE: return (SynthLayout){2, 0, 0, {0, 1}, {-1, 2}, 1, 1, 12, 4};
    case L1L2STAB_FORMAT_P016_LE: return (SynthLayout){2, 0, 0, {0, 1}, {-1, 2}, 1, 1, 16, 0};
    case L1L2STAB_FORMAT_BGRX:
    case L1L2STAB_FORMAT_BGRA: return (SynthLayout){1, 4, 2, {0}, {-1}, 0, 0, 8, 0};
    case L1L2STAB_FORMAT_RGBX:
    case L1L2STAB_FORMAT_RGBA: return (SynthLayout){1, 4, 0, {0}, {-1}, 0, 0, 8, 0};
    case L1L2STAB_FORMAT_BGR: return (SynthLayout){1, 3, 2, {0}, {-1}, 0, 0, 8, 0};
    case L1L2STAB_FORMAT_RGB: return (SynthLayout){1, 3, 0, {0}, {-1}, 0, 0, 8, 0};
    default: break; /* the others are not drawn */
    }
    abort();
}

static SynthAxis axis(int log2_sub, bool centered)
{
    if (!log2_sub)
        return (SynthAxis){1.0, 0.5};
    return (SynthAxis){2.0, centered ? 1.0 : 0.5};
}

SynthAxis synth_axis_x(const SynthLayout *layout, int plane, L1L2StabChromaSite site)
{
    return axis(plane ? layout->sub_x : 0, site == L1L2STAB_CHROMA_SITE_CENTER);
}

SynthAxis synth_axis_y(const SynthLayout *layout, int plane, L1L2StabChromaSite site)
{
    return axis(plane ? layout->sub_y : 0, site != L1L2STAB_CHROMA_SITE_TOP_LEFT);
}

void synth_store(const SynthLayout *layout, int plane, int which, const SynthSpan *span, const uint16_t *code,
                 uint8_t *row)
{
    const int components = layout->second[plane] < 0 ? 1 : 2, at = components * span->i + which;
    if (layout->depth == 8) {
        for (int i = 0; i < span->count; i++)
            row[at + components * i] = (uint8_t)code[i];
        return;
    }
    for (int i = 0; i < span->count; i++) {
        const unsigned word = (unsigned)code[i] << layout->shift;
        row[2 * (at + components * i)] = (uint8_t)(word & 255u);
        row[2 * (at + components * i) + 1] = (uint8_t)(word >> 8);
    }
}

static uint8_t rounded(int thousandths)
{
    return (uint8_t)(thousandths < 0 ? 0 : thousandths > 255999 ? 255 : thousandths / 1000);
}

void synth_store_packed(const SynthLayout *layout, const SynthSpan *span, uint16_t code[3][SYNTH_SPAN], uint8_t *row)
{
    uint8_t *p = row + (ptrdiff_t)layout->packed * span->i;
    for (int i = 0; i < span->count; i++, p += layout->packed) {
        const int y = code[0][i] * 1000 + 500, u = code[1][i] - 128, v = code[2][i] - 128;
        p[layout->red] = rounded(y + 1402 * v);
        p[1] = rounded(y - 344 * u - 714 * v);
        p[2 - layout->red] = rounded(y + 1772 * u);
        if (layout->packed == 4)
            p[3] = 255;
    }
}

SynthPicture synth_picture_new(L1L2StabFormat format, int width, int height)
{
    const SynthLayout layout = synth_layout_of(format);
    SynthPicture p = {.format = format, .width = width, .height = height, .planes = layout.planes};
    for (int i = 0; i < p.planes; i++) {
        const int sx = i ? layout.sub_x : 0, sy = i ? layout.sub_y : 0;
        const int bytes = layout.packed ? layout.packed : (layout.second[i] < 0 ? 1 : 2) * (layout.depth > 8 ? 2 : 1);
        p.stride[i] = (ptrdiff_t)bytes * ((width + sx) >> sx);
        p.rows[i] = (height + sy) >> sy;
        p.size += (size_t)p.stride[i] * (size_t)p.rows[i];
    }
    uint8_t *at = synth_alloc(p.size, 1);
    for (int i = 0; i < p.planes; i++) {
        p.data[i] = at;
        at += p.stride[i] * p.rows[i];
    }
    return p;
}

void synth_picture_free(SynthPicture *p)
{
    free(p->data[0]);
    *p = (SynthPicture){0};
}
