/* SPDX-License-Identifier: MIT */
#include "common/cpu.h"

unsigned l1l2_cpu_features(void)
{
    unsigned features = L1L2_CPU_PLAIN;
#if defined(L1L2_HAVE_SIMD) && defined(__aarch64__)
    features |= L1L2_CPU_NEON;
#elif defined(L1L2_HAVE_SIMD)
    if (__builtin_cpu_supports("sse2"))
        features |= L1L2_CPU_SSE2;
    if (__builtin_cpu_supports("avx2"))
        features |= L1L2_CPU_AVX2;
#endif
    return features;
}
