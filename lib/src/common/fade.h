/* SPDX-License-Identifier: MIT */
/* A gradual change between off and on, over a number of steps, smooth at both ends. */
#ifndef L1L2_COMMON_FADE_H
#define L1L2_COMMON_FADE_H

#include <stdbool.h>

typedef struct L1L2Fade {
    bool on;   /* the target */
    int steps; /* so far, counted from off: 0 is off, `length` is on */
    int length;
} L1L2Fade;

/* Takes one step towards the target; at_once: all steps. Returns the weight of `on`, [0, 1], exact at both ends. */
double l1l2_fade_next(L1L2Fade *fade, bool at_once);

#endif
