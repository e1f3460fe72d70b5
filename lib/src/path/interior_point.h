/* SPDX-License-Identifier: MIT */
/*
 * The predictor: a primal-dual interior point made for the window problem of path_problem.h.
 *
 * Mehrotra's predictor-corrector (SIAM J. Optim. 1992). Every inequality comes in a pair around one linear form v of q:
 * e - v and e + v of a term's component (v = D^k q), hi - v and v - lo of a crop row (v = G q). The slacks e and the
 * duals are eliminated by hand: a pair adds one weight to v's outer product, 4 d1 d2 / (d1 + d2) for a term and
 * d1 + d2 for a crop row, with d = y/s of its two sides. What is left is one positive definite system in q, banded in
 * frame order: a third difference reaches three frames, of 2, 4 or 6 components each (path_band.h; all loops over
 * components are compiled for each number). So an iteration is O(n), and no memory is allocated after create.
 *
 * q = c (all B_t = identity) is strictly feasible; every iterate stays so. What converges is the stationarity in q and
 * the gap, the sum of all s y; together they bound how far the objective is above its optimum: a certificate.
 */
#ifndef L1L2_PATH_INTERIOR_POINT_H
#define L1L2_PATH_INTERIOR_POINT_H

#include "path/problem.h"

typedef struct L1L2PathInteriorPoint L1L2PathInteriorPoint;

typedef struct L1L2PathInteriorPointReport {
    bool converged; /* bound <= 1e-9 + 1e-7 of the objective */
    int iterations;
    double bound;   /* the objective is at most this far above its optimum */
} L1L2PathInteriorPointReport;

/* For windows of up to `capacity` frames with `dim` components. NULL when out of memory. */
L1L2PathInteriorPoint *l1l2_path_interior_point_create(int capacity, int dim);
void l1l2_path_interior_point_free(L1L2PathInteriorPoint *ipm);

/* Solve into *point, whose arrays belong to ipm and last until the next call. The point is finite and strictly within
 * the crop rows also where it did not converge. Deterministic. */
L1L2PathInteriorPointReport l1l2_path_interior_point_solve(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p,
                                                           L1L2PathPoint *point);

#endif
