/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 3: the optimum of a window, certified.
 *
 * The interior point of path_ipm.h finds it; its point and duals start OSQP (path_qp.h, qp.h), whose residual test is
 * an independent check in another formulation. Where one of the two does not arrive the other decides; the report says
 * which. Where neither does, the predictor's feasible point is given, with its bound, and `converged` is false.
 */
#ifndef L1L2_PATH_SOLVER_H
#define L1L2_PATH_SOLVER_H

#include <l1l2stab/l1l2stab.h>

#include "path/problem.h"

typedef struct L1L2PathSolver L1L2PathSolver;

typedef struct L1L2PathSolverReport {
    bool converged;              /* q is the optimum */
    L1L2StabSolver decided_by;   /* CHECKED where the two agree */
    int predictor_iterations, osqp_iterations;
    double bound;                /* predictor: the objective is at most this far above its optimum */
    double osqp_primal_residual, osqp_dual_residual; /* infinity norms, in the program's scaling */
    double excess;               /* the largest violation of a crop row, diagonals; <= 0 where all hold */
} L1L2PathSolverReport;

/* For windows of up to `capacity` frames with `dim` components. NULL when out of memory. */
L1L2PathSolver *l1l2_path_solver_create(int capacity, int dim);
void l1l2_path_solver_free(L1L2PathSolver *solver);

/* Solve p into q (n rows), which is always finite. choice: CHECKED, PREDICTOR or OSQP. */
L1L2PathSolverReport l1l2_path_solver_solve(L1L2PathSolver *solver, L1L2StabSolver choice, const L1L2PathProblem *p,
                                        double (*q)[L1L2_DIM]);

#endif
