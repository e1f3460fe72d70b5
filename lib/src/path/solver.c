/* SPDX-License-Identifier: MIT */
#include "path/solver.h"

#include <math.h>
#include <string.h>

#include "common/mem.h"
#include "path/interior_point.h"
#include "path/problem_as_qp.h"

/* To check a trusted point: OSQP accepts it at its first check, or nearly so; where it has not after this many
 * iterations it will take hundreds, and the predictor's certificate stands without it. In the problem's units the
 * tolerance is 5e-7 diagonals and 1e-5 of the weights. Measured over the windows of tests/reference: accepted at the
 * first check 96 %; with rho = 2 it were 92 %, with a tolerance of 1e-6 as well 82 %. */
static const L1L2PathQpSettings check_settings = {.max_iterations = 50, .rho = 0.1, .tolerance = 1e-5};
/* To find the optimum alone. */
static const L1L2PathQpSettings solve_settings = {.max_iterations = 4000, .rho = 2.0, .tolerance = 1e-6};

struct L1L2PathSolver {
    L1L2PathInteriorPoint *ipm;
    L1L2PathQp *qp;
    double *z, *y;
};

L1L2PathSolver *l1l2_path_solver_create(int capacity, int dim)
{
    L1L2PathSolver *s = l1l2_mem_new(1, sizeof *s);
    if (!s)
        return NULL;
    s->ipm = l1l2_path_interior_point_create(capacity, dim);
    s->qp = l1l2_path_problem_as_qp_create(capacity, dim);
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
    l1l2_path_interior_point_free(s->ipm);
    l1l2_path_qp_free(s->qp);
    l1l2_mem_free(s->z);
    l1l2_mem_free(s->y);
    l1l2_mem_free(s);
}

/* OSQP from the point in z and y, where it leaves its own. True where it arrived. */
static bool run_osqp(L1L2PathSolver *s, const L1L2PathQpSettings *settings, L1L2PathSolverReport *report)
{
    L1L2PathQpReport qp;
    if (l1l2_path_qp_solve(s->qp, settings, s->z, s->y, &qp) != L1L2STAB_OK)
        return false;
    report->osqp_iterations = qp.iterations;
    report->osqp_primal_residual = qp.primal_residual;
    report->osqp_dual_residual = qp.dual_residual;
    return qp.converged;
}

static bool take_osqp(const L1L2PathSolver *s, const L1L2PathProblem *p, double (*q)[L1L2_DIM])
{
    for (int i = 0; i < p->dim * p->count; i++)
        if (!isfinite(s->z[i]))
            return false;
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            q[t][j] = s->z[l1l2_path_qp_col_q(p, t, j)];
    return true;
}

static void start_from_camera(L1L2PathSolver *s, const L1L2PathProblem *p)
{
    memset(s->z, 0, (size_t)s->qp->cols * sizeof *s->z);
    memset(s->y, 0, (size_t)s->qp->rows * sizeof *s->y);
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            s->z[l1l2_path_qp_col_q(p, t, j)] = p->camera[t][j];
}

L1L2PathSolverReport l1l2_path_solver_solve(L1L2PathSolver *s, L1L2StabSolver choice, const L1L2PathProblem *p,
                                        double (*q)[L1L2_DIM])
{
    L1L2PathSolverReport report = {.decided_by = L1L2STAB_SOLVER_PREDICTOR, .bound = HUGE_VAL};
    L1L2PathPoint point;
    memcpy(q, p->camera, (size_t)p->count * sizeof *q);
    if (choice != L1L2STAB_SOLVER_OSQP) {
        const L1L2PathInteriorPointReport ipm = l1l2_path_interior_point_solve(s->ipm, p, &point);
        memcpy(q, point.q, (size_t)p->count * sizeof *q);
        report.converged = ipm.converged;
        report.predictor_iterations = ipm.iterations;
        report.bound = ipm.bound;
    }
    if (choice != L1L2STAB_SOLVER_PREDICTOR || !report.converged) {
        l1l2_path_problem_as_qp_fill(p, s->qp);
        if (choice == L1L2STAB_SOLVER_OSQP)
            start_from_camera(s, p);
        else
            l1l2_path_problem_as_qp_point(p, &point, s->z, s->y);
        const bool arrived = run_osqp(s, report.converged ? &check_settings : &solve_settings, &report);
        if (report.converged) {
            if (arrived)
                report.decided_by = L1L2STAB_SOLVER_CHECKED;
        } else if ((arrived || choice == L1L2STAB_SOLVER_OSQP) && take_osqp(s, p, q)) {
            report.decided_by = L1L2STAB_SOLVER_OSQP;
            report.converged = arrived;
        }
    }
    report.excess = l1l2_path_excess(p, (const double(*)[L1L2_DIM])q);
    return report;
}
