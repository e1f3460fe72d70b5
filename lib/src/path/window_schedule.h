/* SPDX-License-Identifier: MIT */
/*
 * The window schedule: which frames each window covers and which it emits (paper, section 4.1, Fig. 2). It only counts;
 * it knows no geometry.
 *
 * Windows of N frames start every N-K frames. A window emits its first N-K frames. The K frames after them belong to
 * the next window too. Where the path ends (end of stream, scene cut), a last, shorter window emits all that is left.
 * So frame t is decided when frame t + N - 1 has arrived or when the path has ended, and never later.
 *
 * An early window is for frames that must leave sooner, because a live source is late. It covers the frames that have
 * arrived, and emits as many of them as were asked for. The next window starts after these, as always. Nothing is
 * blended around an early window: the weights of eq. (8) belong to overlaps of K frames.
 */
#ifndef L1L2_PATH_WINDOW_SCHEDULE_H
#define L1L2_PATH_WINDOW_SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct L1L2PathSchedule {
    int window;   /* N */
    int overlap;  /* K, [3, N) */
    int64_t next; /* where the next window starts, frames since the path's start: all before it are emitted */
    bool early;   /* the last window was an early one */
} L1L2PathSchedule;

typedef struct L1L2PathWindow {
    int64_t first; /* of the window, frames since the path's start */
    int count;     /* frames that it covers: N, or fewer at the path's end */
    int emit;      /* frames that it emits, from its first */
    int shared;    /* of these, frames that can be blended with the window before it: K, or 0 for a path's first window
                    * and around an early one */
    bool early;
} L1L2PathWindow;

L1L2PathSchedule l1l2_path_schedule_start(int window, int overlap);

/* The next window that can be solved when `length` frames of the path have arrived. ended: no more will arrive. False
 * where there is none. */
bool l1l2_path_schedule_next(L1L2PathSchedule *schedule, int64_t length, bool ended, L1L2PathWindow *step);

/* An early window that emits `emit` frames, or all that are left of the `length` that have arrived. Call it when
 * l1l2_path_schedule_next() has no window. False where there is nothing to emit. */
bool l1l2_path_schedule_early(L1L2PathSchedule *schedule, int64_t length, int64_t emit, L1L2PathWindow *step);

#endif
