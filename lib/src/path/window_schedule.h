/* SPDX-License-Identifier: MIT */
/*
 * Which frames each window covers and which it gives out (paper, section 4.1, Fig. 2). Pure counting: no geometry.
 *
 * Windows of N frames start every N-K frames. A window gives out its first N-K frames; the K after them belong to the
 * next window too. Where the path ends (end of stream, scene cut) a last, shorter window gives out all that is left.
 * Frame t is therefore decided when frame t + N - 1 has come, or when the path has ended: never later.
 *
 * An early window is for frames that must leave sooner (a live source that is late): it covers the frames that have
 * come and gives out those alone. The next window starts behind them as always. It shares nothing that could be
 * blended: not with the window before it, whose weights were meant for more frames, nor with the one after it.
 */
#ifndef L1L2_PATH_WINDOW_SCHEDULE_H
#define L1L2_PATH_WINDOW_SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct L1L2PathSchedule {
    int window;   /* N */
    int overlap;  /* K, [3, N) */
    int64_t next; /* where the next window starts, frames since the path's start: all before it are given out */
    bool early;   /* the last window was */
} L1L2PathSchedule;

typedef struct L1L2PathWindow {
    int64_t first; /* of the window, frames since the path's start */
    int count;     /* frames that it covers: N, or fewer at the path's end */
    int emit;      /* frames that it gives out, from its first */
    int shared;    /* of these, frames that can be blended with the window before it: K, or 0 for a path's first window
                    * and around an early one */
    bool early;
} L1L2PathWindow;

L1L2PathSchedule l1l2_path_schedule_start(int window, int overlap);

/* The next window that can be solved once `length` frames of the path have come; `ended`: no more will. False: none. */
bool l1l2_path_schedule_next(L1L2PathSchedule *schedule, int64_t length, bool ended, L1L2PathWindow *step);

/* An early window that gives out `give` frames, or all that are left of the `length` that have come. To be called when
 * l1l2_path_schedule_next() has no window. False where there is nothing to give. */
bool l1l2_path_schedule_early(L1L2PathSchedule *schedule, int64_t length, int64_t give, L1L2PathWindow *step);

#endif
