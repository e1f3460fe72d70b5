/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 3: the optimum of a window, certified.
 *
 * The interior point of path_ipm.h finds it; its point and duals start OSQP (path_qp.h, qp.h), whose residual test is
 * an independent check in another formulation. Where one of the two does not arrive the other decides; the report says
 * which. Where neither does, the better feasible point is given and `converged` is false.
 */
#ifndef L1L2_PATH_SOLVER_H
#define L1L2_PATH_SOLVER_H

#include <l1l2stab/l1l2stab.h>

#include "path_problem.h"

typedef enum L1L2SolverChoice {
    L1L2_SOLVER_BOTH,      /* the predictor, checked by OSQP */
    L1L2_SOLVER_PREDICTOR, /* the predictor; OSQP only where it does not arrive */
    L1L2_SOLVER_OSQP       /* OSQP alone, from P = C */
} L1L2SolverChoice;

typedef struct L1L2PathSolver L1L2PathSolver;

typedef struct L1L2SolverReport {
    bool converged;
    L1L2SolverChoice decided_by; /* BOTH where the two agree */
    int predictor_iterations, osqp_iterations;
    double bound;                /* predictor: the objective is at most this far above its optimum */
    double osqp_primal_residual, osqp_dual_residual; /* infinity norms, in the program's scaling */
    double excess;               /* the largest violation of a crop row, diagonals; <= 0 where all hold */
} L1L2SolverReport;

/* For windows of up to `capacity` frames. NULL when out of memory. */
L1L2PathSolver *l1l2_path_solver_create(int capacity, L1L2SolverChoice choice);
void l1l2_path_solver_free(L1L2PathSolver *solver);

/* Solve p into q (n rows), which is always finite. */
L1L2SolverReport l1l2_path_solver_solve(L1L2PathSolver *solver, const L1L2PathProblem *p, double (*q)[L1L2_DIM]);

#endif
