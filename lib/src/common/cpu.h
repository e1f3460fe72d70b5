/* SPDX-License-Identifier: MIT */
/*
 * Which instruction sets the inner loops may use.
 *
 * Every module with code for an instruction set has one table of function pointers. Its init function takes these
 * flags, fills the table with plain C, and lets each available instruction set replace what it does faster. A table is
 * filled once, when the object that uses it is created. All entries give the same bytes: tests fill one table with
 * L1L2_CPU_PLAIN and compare.
 *
 * Code for instruction sets is in a folder beside the plain C (x86/), in files that are compiled with the flags of
 * their instruction set (lib/meson.build). It is written in the intrinsics of x86, which common/intrinsics.h also
 * gives by NEON.
 */
#ifndef L1L2_COMMON_CPU_H
#define L1L2_COMMON_CPU_H

#ifdef __cplusplus
extern "C" {
#endif

enum {
    L1L2_CPU_PLAIN = 0,
    L1L2_CPU_SSE2 = 1 << 0, /* every x86-64 processor has it */
    L1L2_CPU_AVX2 = 1 << 1,
    L1L2_CPU_NEON = 1 << 2  /* every 64-bit ARM processor has it */
};

/* The instruction sets that both this build and this processor have: a sum of the flags above. */
unsigned l1l2_cpu_features(void);

#ifdef __cplusplus
}
#endif

#endif
