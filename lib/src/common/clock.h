/* SPDX-License-Identifier: MIT */
/* A clock that measures the time of each stage. No result depends on it. */
#ifndef L1L2_COMMON_CLOCK_H
#define L1L2_COMMON_CLOCK_H

#include <stdint.h>
#include <time.h>

static inline int64_t l1l2_clock_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

#endif
