/* SPDX-License-Identifier: MIT */
/*
 * Which frames each window covers and which it gives out (paper, section 4.1, Fig. 2). Pure counting: no geometry.
 *
 * Windows of N frames start every N-K frames. A window gives out its first N-K frames; the K after them belong to the
 * next window too. Where the path ends (end of stream, scene cut) a last, shorter window gives out all that is left.
 * Frame t is therefore decided when frame t + N - 1 has come, or when the path has ended: never later.
 */
#ifndef L1L2_PLAN_H
#define L1L2_PLAN_H

#include <stdbool.h>
#include <stdint.h>

typedef struct L1L2Plan {
    int window;   /* N */
    int overlap;  /* K, [3, N) */
    int64_t next; /* where the next window starts, frames since the path's start: all before it are given out */
} L1L2Plan;

typedef struct L1L2PlanStep {
    int64_t first; /* of the window, frames since the path's start */
    int count;     /* frames that it covers: N, or fewer at the path's end */
    int give;      /* frames that it gives out, from its first */
    int shared;    /* of these, frames that the window before it covered too: K, or 0 for the path's first window */
} L1L2PlanStep;

L1L2Plan l1l2_plan_start(int window, int overlap);

/* The next window that can be solved once `length` frames of the path have come; `ended`: no more will. False: none. */
bool l1l2_plan_next(L1L2Plan *plan, int64_t length, bool ended, L1L2PlanStep *step);

#endif
