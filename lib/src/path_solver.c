/* SPDX-License-Identifier: MIT */
#include "path_solver.h"

#include <math.h>
#include <string.h>

#include "mem.h"
#include "path_ipm.h"
#include "path_qp.h"

/* OSQP accepts a trusted point at its first check, or nearly so; where it has not after this many iterations it will
 * take hundreds, and the predictor's certificate stands without it. */
static const int check_iterations = 50;
static const int solve_iterations = 4000;

struct L1L2PathSolver {
    L1L2SolverChoice choice;
    L1L2PathIpm *ipm;
    L1L2Qp *qp;
    double *z, *y;
};

L1L2PathSolver *l1l2_path_solver_create(int capacity, L1L2SolverChoice choice)
{
    L1L2PathSolver *s = l1l2_mem_new(1, sizeof *s);
    if (!s)
        return NULL;
    s->choice = choice;
    s->ipm = l1l2_path_ipm_create(capacity);
    s->qp = l1l2_path_qp_create(capacity);
    if (s->qp) {
        s->z = l1l2_mem_new((size_t)s->qp->max_cols, sizeof *s->z);
        s->y = l1l2_mem_new((size_t)s->qp->max_rows, sizeof *s->y);
    }
    if (s->ipm && s->qp && s->z && s->y)
        return s;
    l1l2_path_solver_free(s);
    return NULL;
}

void l1l2_path_solver_free(L1L2PathSolver *s)
{
    if (!s)
        return;
    l1l2_path_ipm_free(s->ipm);
    l1l2_qp_free(s->qp);
    l1l2_mem_free(s->z);
    l1l2_mem_free(s->y);
    l1l2_mem_free(s);
}

/* OSQP from the point in z and y. True where it arrived; then q holds its solution if `take`. */
static bool run_osqp(L1L2PathSolver *s, const L1L2PathProblem *p, int iterations, bool take, double (*q)[L1L2_DIM],
                     L1L2SolverReport *report)
{
    L1L2QpReport qp;
    if (l1l2_qp_solve(s->qp, iterations, s->z, s->y, &qp) != L1L2STAB_OK)
        return false;
    report->osqp_iterations = qp.iterations;
    report->osqp_primal_residual = qp.primal_residual;
    report->osqp_dual_residual = qp.dual_residual;
    bool finite = true;
    for (int i = 0; i < L1L2_DIM * p->count; i++)
        finite = finite && isfinite(s->z[i]);
    if (take && finite) {
        for (int i = 0; i < L1L2_DIM * p->count; i++)
            q[i / L1L2_DIM][i % L1L2_DIM] = s->z[i];
        report->decided_by = L1L2_SOLVER_OSQP;
    }
    return finite && qp.converged;
}

static void start_from_camera(L1L2PathSolver *s, const L1L2PathProblem *p)
{
    memset(s->z, 0, (size_t)s->qp->cols * sizeof *s->z);
    memset(s->y, 0, (size_t)s->qp->rows * sizeof *s->y);
    for (int i = 0; i < L1L2_DIM * p->count; i++)
        s->z[i] = p->camera[i / L1L2_DIM][i % L1L2_DIM];
}

L1L2SolverReport l1l2_path_solver_solve(L1L2PathSolver *s, const L1L2PathProblem *p, double (*q)[L1L2_DIM])
{
    L1L2SolverReport report = {.decided_by = L1L2_SOLVER_PREDICTOR, .bound = HUGE_VAL};
    L1L2PathPoint point;
    memcpy(q, p->camera, (size_t)p->count * sizeof *q);
    if (s->choice != L1L2_SOLVER_OSQP) {
        const L1L2PathIpmReport ipm = l1l2_path_ipm_solve(s->ipm, p, &point);
        memcpy(q, point.q, (size_t)p->count * sizeof *q);
        report.converged = ipm.converged;
        report.predictor_iterations = ipm.iterations;
        report.bound = ipm.bound;
    }
    if (s->choice != L1L2_SOLVER_PREDICTOR || !report.converged) {
        const bool trusted = report.converged;
        l1l2_path_qp_fill(p, s->qp);
        if (s->choice == L1L2_SOLVER_OSQP)
            start_from_camera(s, p);
        else
            l1l2_path_qp_point(p, &point, s->z, s->y);
        const bool agreed = run_osqp(s, p, trusted ? check_iterations : solve_iterations, !trusted, q, &report);
        if (trusted && agreed)
            report.decided_by = L1L2_SOLVER_BOTH;
        report.converged = trusted || agreed;
    }
    report.excess = l1l2_path_excess(p, (const double(*)[L1L2_DIM])q);
    return report;
}
