/* SPDX-License-Identifier: MIT */
/* A switch that is thrown softly: over a number of steps, smooth at both ends. */
#ifndef L1L2_COMMON_FADE_H
#define L1L2_COMMON_FADE_H

#include <stdbool.h>

typedef struct L1L2Fade {
    bool on;   /* where it is going */
    int steps; /* from off; `length` of them make it on */
    int length;
} L1L2Fade;

/* Takes a step; at_once: all that are left. The weight of `on`, [0, 1], exact at both ends. */
double l1l2_fade_next(L1L2Fade *fade, bool at_once);

#endif
