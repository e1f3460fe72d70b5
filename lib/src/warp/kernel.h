/* SPDX-License-Identifier: MIT */
/*
 * The warp's kernels: for each phase, the fraction of a position, the weights of the taps along one axis.
 *
 * Weights are integers that sum to exactly L1L2_WARP_ONE in every phase, so flat pictures stay flat. In phase 0 the
 * weight of the sample itself is 1, so a move by whole samples copies.
 */
#ifndef L1L2_WARP_KERNEL_H
#define L1L2_WARP_KERNEL_H

#include <stdint.h>

#include <l1l2stab/l1l2stab.h>

#include "warp/coords.h"

enum {
    L1L2_WARP_WEIGHT_BITS = 14,
    L1L2_WARP_ONE = 1 << L1L2_WARP_WEIGHT_BITS,
    L1L2_WARP_MAX_TAPS = 6
};

typedef struct L1L2WarpKernel {
    int taps;   /* along each axis: 2, 4 or 6. Tap k is the sample floor(position) - (taps / 2 - 1) + k */
    int stride; /* entries from phase to phase: a power of two >= taps; entries beyond the taps are 0 */
    _Alignas(16) int16_t weights[L1L2_WARP_PHASES * 8];
} L1L2WarpKernel;

/* The stride of a kernel with this number of taps. */
static inline int l1l2_warp_kernel_stride(int taps)
{
    return taps <= 2 ? 2 : taps <= 4 ? 4 : 8;
}

/* The rounded product of two numbers with 15 fractional bits: what pmulhrsw gives for words. */
static inline int l1l2_warp_product(int a, int b)
{
    return (a * b + (1 << 14)) >> 15;
}

void l1l2_warp_kernel_init(L1L2WarpKernel *kernel, L1L2StabInterpolation interpolation);

#endif
