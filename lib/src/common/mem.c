/* SPDX-License-Identifier: MIT */
#include "common/mem.h"

#include <stdint.h>
#include <stdlib.h>

/* The one exception to "no global state": tests set it before anything runs. */
static L1L2MemHook hook = {calloc, free};

void l1l2_mem_set_hook(const L1L2MemHook *replacement)
{
    hook = replacement ? *replacement : (L1L2MemHook){calloc, free};
}

void *l1l2_mem_new(size_t count, size_t size)
{
    if (count == 0 || size == 0 || count > SIZE_MAX / size)
        return NULL;
    return hook.alloc(count, size);
}

void l1l2_mem_free(void *p)
{
    hook.release(p);
}
