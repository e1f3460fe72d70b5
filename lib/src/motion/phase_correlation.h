/* SPDX-License-Identifier: MIT */
/*
 * Phase correlation: Kuglin & Hines, "The phase correlation image alignment method", 1975. The shifts between two
 * pictures whose cross-power spectrum, with every frequency made equally strong, has the highest peaks.
 *
 * It needs no first guess, finds large motions, and is not disturbed by a change of brightness or by blur. It knows
 * shifts only, to about a sample of its grid, so it serves as a start for direct alignment. Where two things move, each
 * has a peak.
 */
#ifndef L1L2_MOTION_PHASE_CORRELATION_H
#define L1L2_MOTION_PHASE_CORRELATION_H

typedef struct L1L2PhaseCorrelator L1L2PhaseCorrelator;

/* A peak. A thing at (u, v) in picture a is at (u + x, v + y) in picture b. */
typedef struct L1L2Shift {
    double x, y;     /* parts of the picture's width and height */
    double strength; /* of the peak: 1 for a picture and its circular shift, near 0 for unrelated ones */
} L1L2Shift;

/* NULL: no memory. */
L1L2PhaseCorrelator *l1l2_motion_phase_new(void);
void l1l2_motion_phase_free(L1L2PhaseCorrelator *c);

/* Up to `capacity` peaks, the highest first; returns how many. Both pictures are width x height samples, row by row.
 * Allocates nothing. */
int l1l2_motion_phase_correlate(L1L2PhaseCorrelator *c, const float *a, const float *b, int width, int height,
                                L1L2Shift *shift, int capacity);

#endif
