/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 3: the optimum of a window, certified, within a bounded amount of work.
 *
 * Two solvers work on the same problem (problem.h). The interior point (interior_point.h), called the predictor, finds
 * the optimum and a bound on its own error. Its point and duals then start OSQP (problem_as_qp.h, qp.h), whose residual
 * test is an independent check in another formulation. Where only one of the two converges, that one decides; the
 * report says which. Where neither does, the result is the predictor's point: it is feasible, its bound is reported,
 * and `converged` is false.
 *
 * The work of a solve is bounded by counts of iterations, never by a clock: the same window gives the same result on a
 * slow machine and on a fast one. The table in solver.c has the counts.
 */
#ifndef L1L2_PATH_SOLVER_H
#define L1L2_PATH_SOLVER_H

#include <l1l2stab/l1l2stab.h>

#include "path/problem.h"

typedef struct L1L2PathSolver L1L2PathSolver;

typedef struct L1L2PathSolverReport {
    bool converged;              /* q is the optimum */
    L1L2StabSolver decided_by;   /* PREDICTOR, OSQP, or CHECKED where the two agree */
    int predictor_iterations, osqp_iterations;
    double bound;                /* the predictor's: the objective is at most this far above its optimum */
    double osqp_primal_residual, osqp_dual_residual; /* infinity norms, in the program's scaling */
    double excess;               /* the largest violation of a constraint at q, diagonals; <= 0 where all hold */
} L1L2PathSolverReport;

/* For windows of up to `capacity` frames with `dim` components. NULL when out of memory. */
L1L2PathSolver *l1l2_path_solver_create(int capacity, int dim);
void l1l2_path_solver_free(L1L2PathSolver *solver);

/* Solves p into q (p->count rows), which is finite whatever happens.
 *
 * emitted: how many frames the window emits, at least 1. The time of a solve is spread over them, so it decides how
 * much work OSQP may do.
 * choice: CHECKED, PREDICTOR, OSQP, or AUTO, which is CHECKED for windows that emit several frames and else PREDICTOR.
 * OSQP alone has a bound of its own, far above what a live pipeline can wait for. */
L1L2PathSolverReport l1l2_path_solver_solve(L1L2PathSolver *solver, L1L2StabSolver choice, int emitted,
                                            const L1L2PathProblem *p, double (*q)[L1L2_DIM]);

/* How many iterations OSQP may take to find the optimum of p where the predictor did not; 0: it is not asked. */
int l1l2_path_solver_rescue_iterations(const L1L2PathProblem *p, int emitted);

#endif
