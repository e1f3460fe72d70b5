/* SPDX-License-Identifier: MIT */
/*
 * Symmetric positive definite systems of a fixed bandwidth: L D L' in place, O(n band^2), no fill.
 *
 * Stored by columns of the lower band: entry k of column i, at i * band + k, is the system's (i + k, i). What reaches
 * beyond the last row is not read. For the loops to be unrolled `band` must be a constant where these are called: all
 * is inlined.
 */
#ifndef L1L2_PATH_BANDED_LDL_H
#define L1L2_PATH_BANDED_LDL_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define L1L2_PATH_INLINE static inline __attribute__((always_inline))
#else
#define L1L2_PATH_INLINE static inline
#endif

/* L, whose diagonal is 1, below the diagonal, D on it. original: the diagonal as it was. Where rounding has eaten a
 * pivot (lambda 0 and no active crop row: the path may be anywhere) its component is not moved. False where the numbers
 * give out. */
L1L2_PATH_INLINE bool l1l2_path_ldl_factorize(double *system, const double *original, int size, const int band)
{
    for (int i = 0; i < size; i++) {
        double *column = system + (size_t)i * (size_t)band;
        const double d = column[0] > 1e-14 * original[i] ? column[0] : 1e100;
        if (!isfinite(column[0]))
            return false;
        column[0] = d;
        const int reach = size - i < band ? size - i : band;
        for (int k = 1; k < reach; k++) {
            const double l = column[k] / d;
            double *target = system + (size_t)(i + k) * (size_t)band;
            for (int m = k; m < reach; m++)
                target[m - k] -= l * column[m];
        }
        for (int k = 1; k < reach; k++)
            column[k] /= d;
    }
    return true;
}

/* x: the right-hand side, then the solution. */
L1L2_PATH_INLINE void l1l2_path_ldl_solve(const double *factors, double *x, int size, const int band)
{
    for (int i = 0; i < size; i++) {
        const int reach = size - i < band ? size - i : band;
        for (int k = 1; k < reach; k++)
            x[i + k] -= factors[(size_t)i * (size_t)band + (size_t)k] * x[i];
    }
    for (int i = size - 1; i >= 0; i--) {
        const int reach = size - i < band ? size - i : band;
        double sum = x[i] / factors[(size_t)i * (size_t)band];
        for (int k = 1; k < reach; k++)
            sum -= factors[(size_t)i * (size_t)band + (size_t)k] * x[i + k];
        x[i] = sum;
    }
}

#endif
