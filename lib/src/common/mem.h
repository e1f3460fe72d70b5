/* SPDX-License-Identifier: MIT */
/* Checked, zeroed allocation. All of the library's own heap memory comes from here, so that a test can make
 * the k-th allocation fail. */
#ifndef L1L2_COMMON_MEM_H
#define L1L2_COMMON_MEM_H

#include <stddef.h>

/* count objects of size bytes, zeroed; NULL when out of memory or when the product overflows. */
void *l1l2_mem_new(size_t count, size_t size);
void l1l2_mem_free(void *p);

/* Tests: NULL restores calloc and free. */
typedef struct L1L2MemHook {
    void *(*alloc)(size_t count, size_t size);
    void (*release)(void *p);
} L1L2MemHook;
void l1l2_mem_set_hook(const L1L2MemHook *hook);

#endif
