/* SPDX-License-Identifier: MIT */
/* A gradual change from off to on or back, in a number of steps. It begins and ends smoothly. */
#ifndef L1L2_COMMON_FADE_H
#define L1L2_COMMON_FADE_H

#include <stdbool.h>

typedef struct L1L2Fade {
    bool on;   /* the target */
    int steps; /* so far, counted from off: 0 is off, `length` is on */
    int length;
} L1L2Fade;

/* Takes one step towards the target, or all steps if at_once. Returns the weight of `on`: exactly 0 when the change to
 * off is complete, exactly 1 when the change to on is, and between them otherwise. */
double l1l2_fade_next(L1L2Fade *fade, bool at_once);

#endif
