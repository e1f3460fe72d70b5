/* SPDX-License-Identifier: MIT */
/*
 * LDL' factorization of symmetric positive definite band matrices (Golub & Van Loan, "Matrix Computations", section
 * 4.3), in place. The only LDL' of the library.
 *
 * `band` is the number of stored diagonals: the main one and those below it. Eliminating column i changes the entries
 * (j, k) with i < k <= j < i + band alone, because only rows i to i + band - 1 have an entry in column i. These lie in
 * the band. So L has the band of the matrix, there is no fill and no need to permute, and the time is O(size band^2).
 *
 * Storage: by columns of the lower band. Entry k of column i, at i * band + k, is the matrix's (i + k, i). Entries
 * beyond the last row are not read. The functions are inlined, so that the loops unroll where `band` is a constant.
 */
#ifndef L1L2_PATH_BANDED_LDL_H
#define L1L2_PATH_BANDED_LDL_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/compiler.h"

/* Leaves D on the diagonal and L, whose own diagonal is 1, below it. original: the diagonal before. Where rounding
 * leaves no digit of a pivot (with lambda = 0 and no active constraint the path may be anywhere), the pivot is replaced
 * by a huge one, so that this component does not move. False where a number is not finite. */
L1L2_INLINE bool l1l2_path_ldl_factorize(double *system, const double *original, int size, const int band)
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

/* Solves with the factors. x: the right-hand side, then the solution. */
L1L2_INLINE void l1l2_path_ldl_solve(const double *factors, double *x, int size, const int band)
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
