/* SPDX-License-Identifier: MIT */
/*
 * The interface to the solver of quadratic programs: plain data in and out, and no type of the solver.
 *
 *   minimize 1/2 z' P z + q' z   subject to   l <= A z <= u,      P diagonal and >= 0
 */
#ifndef L1L2_PATH_QP_H
#define L1L2_PATH_QP_H

#include <l1l2stab/l1l2stab.h>

#define L1L2_PATH_QP_INFINITY 1e30 /* no bound */

/* A in compressed sparse columns. */
typedef struct L1L2PathQp {
    int cols, rows, entries; /* in use */
    double *p;               /* cols: P's diagonal */
    double *q;               /* cols */
    int *start;              /* cols + 1 */
    int *row;                /* entries, ascending within a column */
    double *value;           /* entries */
    double *lower, *upper;   /* rows; +-L1L2_PATH_QP_INFINITY where there is no bound */
    int max_cols, max_rows, max_entries;
} L1L2PathQp;

typedef struct L1L2PathQpSettings {
    int max_iterations;
    double rho;       /* step size of ADMM: a small one stays near the start */
    double tolerance; /* of both residuals, absolute */
} L1L2PathQpSettings;

typedef struct L1L2PathQpReport {
    int converged;   /* 1: residuals within the solver's tolerance */
    int iterations;
    double primal_residual, dual_residual; /* infinity norms, in the problem's own scaling */
} L1L2PathQpReport;

L1L2PathQp *l1l2_path_qp_create(int max_cols, int max_rows, int max_entries);
void l1l2_path_qp_free(L1L2PathQp *qp);

/* Solves. z (cols) and the duals y (rows) hold the start on entry and the solution on return.
 * ERR_NOMEM or ERR_BACKEND where the solver could not run; OK with converged = 0 where it ran and did not converge.
 * Deterministic: no clock, no randomness; no output, no signal handler. */
L1L2StabResult l1l2_path_qp_solve(const L1L2PathQp *qp, const L1L2PathQpSettings *settings, double *z, double *y,
                             L1L2PathQpReport *report);

#endif
