/* SPDX-License-Identifier: MIT */
/* How a format lays a picture out in memory. */
#ifndef SYNTH_PICTURE_H
#define SYNTH_PICTURE_H

#include "synth.h"
#include "synth_span.h"

typedef struct SynthLayout {
    int planes;
    int packed, red;         /* bytes a pixel of a packed format and where its red is; planar: 0 */
    int first[3], second[3]; /* components of each plane; second -1: not interleaved */
    int sub_x, sub_y;        /* log2, of the chroma */
    int depth, shift;        /* bits of a component; empty bits below it. More than 8: two bytes, the low one first */
} SynthLayout;

/* A plane's place among the frame's pixels: sample i lies at pixel i * step + offset. */
typedef struct SynthAxis {
    double step, offset;
} SynthAxis;

/* Aborts on an unknown format. */
SynthLayout synth_layout_of(L1L2StabFormat format);

/* The axes of a plane. */
SynthAxis synth_axis_x(const SynthLayout *layout, int plane, L1L2StabChromaSite site);
SynthAxis synth_axis_y(const SynthLayout *layout, int plane, L1L2StabChromaSite site);

/* Writes the span's samples into a row of a planar format, as component number `which` of the plane. */
void synth_store(const SynthLayout *layout, int plane, int which, const SynthSpan *span, const uint16_t *code,
                 uint8_t *row);

/* Writes Y, U and V of one span of 8 bits into a packed RGB format, by full-range BT.601: the gray of R, G, B is the
 * luma. */
void synth_store_packed(const SynthLayout *layout, const SynthSpan *span, uint16_t code[3][SYNTH_SPAN], uint8_t *row);

#endif
