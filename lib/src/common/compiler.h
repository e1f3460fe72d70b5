/* SPDX-License-Identifier: MIT */
/* Compiler extensions for speed. Without them the code does the same. */
#ifndef L1L2_COMMON_COMPILER_H
#define L1L2_COMMON_COMPILER_H

#include <stdint.h>

/*
 * A static function that is inlined wherever it is called. Inner loops are written once with their number of taps and
 * components as parameters; inlined into functions that pass constants, each becomes a loop that the compiler unrolls.
 */
#if defined(__GNUC__)
#define L1L2_INLINE static inline __attribute__((always_inline))
#else
#define L1L2_INLINE static inline
#endif

/* Prefetches the cache line at an address. The address need not be valid: nothing is read. `write` is 0 or 1. */
#if defined(__GNUC__)
#define L1L2_PREFETCH(address, write) __builtin_prefetch((const void *)(address), (write))
#else
#define L1L2_PREFETCH(address, write) ((void)(address))
#endif

#endif
