/* SPDX-License-Identifier: MIT */
/* For the implementations of warp_u8.h: one body, compiled for every number of taps and components. */
#ifndef L1L2_WARP_U8_IMPL_H
#define L1L2_WARP_U8_IMPL_H

#include "warp_u8.h"

#define DEFINE_RUN(taps, components)                                                                                  \
    static void run_##taps##_##components(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel, const int32_t *x,   \
                                          const int32_t *y, int count, uint8_t *dst)                                  \
    {                                                                                                                 \
        run(src, kernel, x, y, count, dst, taps, components);                                                         \
    }
#define DEFINE_RUNS_OF(taps) DEFINE_RUN(taps, 1) DEFINE_RUN(taps, 2) DEFINE_RUN(taps, 3) DEFINE_RUN(taps, 4)
#define RUNS_OF(taps) {run_##taps##_1, run_##taps##_2, run_##taps##_3, run_##taps##_4}

/* From run(src, kernel, x, y, count, dst, taps, components) the function that looks its twelve versions up. */
#define DEFINE_RUNS(name)                                                                                             \
    DEFINE_RUNS_OF(2)                                                                                                 \
    DEFINE_RUNS_OF(4)                                                                                                 \
    DEFINE_RUNS_OF(6)                                                                                                 \
    L1L2WarpRun *name(int taps, int components)                                                                       \
    {                                                                                                                 \
        static L1L2WarpRun *const runs[3][4] = {RUNS_OF(2), RUNS_OF(4), RUNS_OF(6)};                                  \
        return runs[taps / 2 - 1][components - 1];                                                                    \
    }

#endif
