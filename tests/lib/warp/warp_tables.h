/* SPDX-License-Identifier: MIT */
/* The two tables of inner loops that tests of the warp compare: of this processor, and plain C. */
#ifndef WARP_TABLES_H
#define WARP_TABLES_H

#include "common/cpu.h"
#include "warp/functions.h"

static inline L1L2WarpFunctions functions_for(unsigned cpu)
{
    L1L2WarpFunctions functions;
    l1l2_warp_functions_init(&functions, cpu);
    return functions;
}

static inline L1L2WarpFunctions plain_functions(void)
{
    return functions_for(L1L2_CPU_PLAIN);
}

static inline L1L2WarpFunctions fast_functions(void)
{
    return functions_for(l1l2_cpu_features());
}

#endif
