/* SPDX-License-Identifier: MIT */
/* Runs a synthetic clip through the whole library, and compares the measured motion and the output with the truth. */
#ifndef SYNTH_TRIAL_H
#define SYNTH_TRIAL_H

#include "synth.h"

typedef struct SynthTrial {
    int frames;
    L1L2StabInfo *info;  /* of each frame */
    double *error;       /* of each F_t, px: rms over the frame's corners; 0 for a path's first frame */
    double *bias;        /* accumulated error of the path since the shot began, px: rms over the corners */
    double *contrast;    /* of each frame, as by synth_contrast() */
    double rms, worst;   /* of `error`, over the frames whose motion was measured */
    double drift;        /* `bias` at the end */
    double quality;      /* the lowest of those frames */
    int lost;            /* frames whose motion was not measured */
    int starts;          /* paths that start after the first frame */
    double jitter_in, jitter_out; /* rms acceleration of the true camera and of the true pose of the crop windows, px:
                                   * over the frame's corners, within shots, where there is enough contrast to see what
                                   * the picture does */
    double stage_ms[L1L2STAB_STAGE_COUNT]; /* a frame */
} SynthTrial;

/* The first `frames` frames, in gray of 8 bits or another format, with the library's defaults. Aborts when out of
 * memory. */
SynthTrial synth_trial_new(const SynthConfig *cfg, int frames);
SynthTrial synth_trial_in(const SynthConfig *cfg, int frames, L1L2StabFormat format);

/* The same with another config: `set` changes it. What it points to need only live during the call. */
typedef void (*SynthTrialSetting)(L1L2StabConfig *config);
SynthTrial synth_trial_with(const SynthConfig *cfg, int frames, L1L2StabFormat format, SynthTrialSetting set);

void synth_trial_free(SynthTrial *trial);

/* The distance between a frame's corners as moved by A and as moved by B: rms, px. */
double synth_trial_distance(const SynthConfig *cfg, const double A[9], const double B[9]);

#endif
