/* SPDX-License-Identifier: MIT */
/*
 * The allocator that OSQP, QDLDL and AMD are built with (OSQP_CUSTOM_MEMORY in osqp_configure.h).
 *
 * OSQP 0.6 does not check most of its allocations, and cleaning up after a failed setup frees pointers that were never
 * set. So these functions never return NULL for want of memory: they leave OSQP by longjmp(), and their owner, the
 * only caller of OSQP, frees every block. lib/src/path/qp_osqp.c has the functions and explains them.
 */
#ifndef L1L2_OSQP_MEMORY_H
#define L1L2_OSQP_MEMORY_H

#include <stddef.h>

void *l1l2_path_osqp_malloc(size_t size);
void *l1l2_path_osqp_calloc(size_t count, size_t size);
void *l1l2_path_osqp_realloc(void *data, size_t size);
void l1l2_path_osqp_free(void *data);

#define c_malloc l1l2_path_osqp_malloc
#define c_calloc l1l2_path_osqp_calloc
#define c_realloc l1l2_path_osqp_realloc
#define c_free l1l2_path_osqp_free

#endif
