/* SPDX-License-Identifier: MIT */
/* A run of samples of one row of a plane. The stages of the renderer pass it from one to the next. */
#ifndef SYNTH_SPAN_H
#define SYNTH_SPAN_H

enum {
    SYNTH_SPAN = 256, /* samples, at most */
    SYNTH_DEEP = 64   /* samples in the renderer are gray levels x 64, 14 bits */
};

typedef struct SynthSpan {
    int component; /* 0 luma, 1 and 2 chroma */
    int i, j;      /* column and row of the first sample in its plane */
    int count;
    double x, y;   /* of the first sample in the frame, px from its center */
    double step;   /* px from sample to sample */
} SynthSpan;

#endif
