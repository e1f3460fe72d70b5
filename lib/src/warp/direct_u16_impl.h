/* SPDX-License-Identifier: MIT */
/* For the implementations of direct_u16.h: the macro that compiles one body for every number of taps and components,
 * narrow and wide. */
#ifndef L1L2_WARP_DIRECT_U16_IMPL_H
#define L1L2_WARP_DIRECT_U16_IMPL_H

#include <stdbool.h>

#include "warp/functions.h"

/* What differs between the compiled runs. It is a constant in each of them, so loops over it unroll. */
typedef struct Shape {
    int taps, components;
    bool wide;
} Shape;

#define DEFINE_RUN(taps, components, wide)                                                                            \
    static void run_##taps##_##components##_##wide(const L1L2WarpPlane *src, const L1L2WarpKernel *kernel,            \
                                                   const int32_t *x, const int32_t *y, int count, uint8_t *dst)       \
    {                                                                                                                 \
        run(src, kernel, x, y, count, dst, (Shape){taps, components, wide});                                          \
    }
#define DEFINE_RUNS_OF(taps, wide) DEFINE_RUN(taps, 1, wide) DEFINE_RUN(taps, 2, wide) DEFINE_RUN(taps, 4, wide)
#define RUNS_OF(taps, wide) {run_##taps##_1_##wide, run_##taps##_2_##wide, run_##taps##_4_##wide}

/* Compiles run(src, kernel, x, y, count, dst, shape) for each shape, and defines a constant with these eighteen.
 * `storage`: static, or nothing. */
#define DEFINE_RUNS(storage, name)                                                                                    \
    DEFINE_RUNS_OF(2, 0)                                                                                              \
    DEFINE_RUNS_OF(4, 0)                                                                                              \
    DEFINE_RUNS_OF(6, 0)                                                                                              \
    DEFINE_RUNS_OF(2, 1)                                                                                              \
    DEFINE_RUNS_OF(4, 1)                                                                                              \
    DEFINE_RUNS_OF(6, 1)                                                                                              \
    storage const L1L2WarpDirectU16Runs name = {                                                                      \
        {{RUNS_OF(2, 0), RUNS_OF(4, 0), RUNS_OF(6, 0)}, {RUNS_OF(2, 1), RUNS_OF(4, 1), RUNS_OF(6, 1)}}};

#endif
