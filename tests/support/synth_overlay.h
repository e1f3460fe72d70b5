/* SPDX-License-Identifier: MIT */
/* Overlays, which are drawn over the finished picture and never move: a logo, a timecode, black bars. */
#ifndef SYNTH_OVERLAY_H
#define SYNTH_OVERLAY_H

#include "synth.h"
#include "synth_span.h"

/* Draws the overlays of frame t over the span, in code values of `depth` bits. */
void synth_overlay_draw(const SynthConfig *cfg, int t, int depth, const SynthSpan *span, uint16_t *code);

#endif
