/* SPDX-License-Identifier: MIT */
/*
 * The intrinsics of SSE2 and AVX2. On x86-64 they are the compiler's. On ARM, SIMDe gives those of 128 bits by NEON,
 * and avx2_halves.h those of 256 bits by two of 128: the same source is compiled for both.
 */
#ifndef L1L2_COMMON_INTRINSICS_H
#define L1L2_COMMON_INTRINSICS_H

#ifdef __x86_64__
#include <immintrin.h>
#elif defined(L1L2_HAVE_SIMD)
#define SIMDE_ENABLE_NATIVE_ALIASES
#include "common/avx2_halves.h"
#endif

/* Whether AVX2's can be used in this file. */
#if defined(__AVX2__) || (defined(L1L2_HAVE_SIMD) && !defined(__x86_64__))
#define L1L2_AVX2 1
#else
#define L1L2_AVX2 0
#endif

#endif
