/* SPDX-License-Identifier: MIT */
/*
 * The predictor: a primal-dual interior point method made for the window problem of problem.h.
 *
 * Source: S. Mehrotra, "On the implementation of a primal-dual interior point method", SIAM J. Optim. 2(4), 1992. The
 * derivation is in interior_point.c.
 *
 * All slacks and duals are eliminated by hand. What is left in each iteration is one positive definite system in q. It
 * is banded in frame order, because a third difference reaches three frames (banded_ldl.h). So an iteration takes time
 * in proportion to the frames. No memory is allocated after create.
 *
 * q = c (all B_t = identity) is strictly feasible, and so is every iterate. The method ends with a certificate: a bound
 * on how far the objective is above its optimum.
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

/* Solves into *point, whose arrays belong to ipm and last until the next call. Takes at most 60 iterations. The point
 * is finite, and strictly within the constraints, also where it did not converge. Deterministic. */
L1L2PathInteriorPointReport l1l2_path_interior_point_solve(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p,
                                                           L1L2PathPoint *point);

#endif
