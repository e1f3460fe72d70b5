/* SPDX-License-Identifier: MIT */
/* The library's allocations with one that fails on purpose, and the number of blocks that are not freed yet. */
#ifndef MEMORY_FIXTURE_H
#define MEMORY_FIXTURE_H

#include <stdlib.h>

#include "common/mem.h"

static int memory_countdown = -1; /* allocations before the one that fails; < 0: none fails */
static int memory_alive;          /* blocks that are not freed */

static inline void *memory_fixture_alloc(size_t count, size_t size)
{
    if (memory_countdown >= 0 && memory_countdown-- == 0)
        return NULL;
    void *p = calloc(count, size);
    memory_alive += p != NULL;
    return p;
}

static inline void memory_fixture_free(void *p)
{
    memory_alive -= p != NULL;
    free(p);
}

/* From now on blocks are counted, and allocations fail as memory_countdown says. */
static inline void memory_fixture_begin(void)
{
    memory_countdown = -1;
    memory_alive = 0;
    l1l2_mem_set_hook(&(L1L2MemHook){memory_fixture_alloc, memory_fixture_free});
}

static inline void memory_fixture_end(void)
{
    l1l2_mem_set_hook(NULL);
}

#endif
