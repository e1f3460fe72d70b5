/* SPDX-License-Identifier: MIT */
#include "common/cholesky.h"

#include <math.h>

bool l1l2_cholesky_factorize(double *A, int size, int stride)
{
    for (int i = 0; i < size; i++) {
        double *row = A + i * stride;
        for (int j = 0; j <= i; j++) {
            const double *above = A + j * stride;
            double sum = row[j];
            for (int k = 0; k < j; k++)
                sum -= row[k] * above[k];
            /* A NaN anywhere in the row reaches the pivot and fails the comparison. */
            if (i == j && !(sum > 0.0 && isfinite(sum)))
                return false;
            row[j] = i == j ? sqrt(sum) : sum / above[j];
        }
    }
    return true;
}

void l1l2_cholesky_solve(const double *L, int size, int stride, double *b)
{
    for (int i = 0; i < size; i++) {
        for (int k = 0; k < i; k++)
            b[i] -= L[i * stride + k] * b[k];
        b[i] /= L[i * stride + i];
    }
    for (int i = size - 1; i >= 0; i--) {
        for (int k = i + 1; k < size; k++)
            b[i] -= L[k * stride + i] * b[k];
        b[i] /= L[i * stride + i];
    }
}
