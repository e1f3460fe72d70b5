/* SPDX-License-Identifier: MIT */
/*
 * Cholesky factorization A = L L' of a dense symmetric positive definite matrix, and the solution of A x = b by it
 * (Golub and Van Loan, "Matrix Computations", section 4.2). No allocation. For small systems: O(size^3).
 *
 * A matrix is stored by rows: element (i, j) is at i * stride + j. Only the lower triangle, j <= i, is read or written.
 */
#ifndef L1L2_COMMON_CHOLESKY_H
#define L1L2_COMMON_CHOLESKY_H

#include <stdbool.h>

/* Replaces the lower triangle of A by L. size: rows of the system, 0 <= size <= stride. stride: elements from one row
 * to the next. Returns false if A is not positive definite to rounding, or has an element that is not finite; A is then
 * partly overwritten and must not be used. */
bool l1l2_cholesky_factorize(double *A, int size, int stride);

/* Replaces b by the solution x of L L' x = b. L: as l1l2_cholesky_factorize() left it when it returned true. x is
 * finite unless b is not, or the quotient overflows. */
void l1l2_cholesky_solve(const double *L, int size, int stride, double *b);

#endif
