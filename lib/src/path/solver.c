/* SPDX-License-Identifier: MIT */
#include "path/solver.h"

#include <math.h>
#include <string.h>

#include "common/mem.h"
#include "path/interior_point.h"
#include "path/problem_as_qp.h"

/*
 * Parameters
 *
 * name                  value   unit            effect, and what chose the value
 * --------------------  ------  --------------  ---------------------------------------------------------------------
 * check.max_iterations  50      iterations      The check of a point that the predictor found. OSQP accepts it at its
 *                                               first test on 481 of the 496 problems of tests/reference; where it has
 *                                               not after 50 iterations it takes hundreds (test_solver).
 * check.rho             0.1     -               ADMM's step: small trusts the start. With 2, OSQP accepts 92 % of these
 *                                               problems at its first test instead of 96 %.
 * check.tolerance       1e-5    scaled units    5e-7 diagonals in the rows of differences, 1e-5 of the weights in the
 *                                               duals. With 1e-6, 82 % are accepted at the first test.
 * solve.max_iterations  4000    iterations      OSQP alone, where the caller asked for it. More does not help: it ends
 *                                               0.001 to 5 px off (docs/path.md).
 * solve.rho             2       -               Near the best fixed value for OSQP alone.
 * solve.tolerance       1e-6    scaled units    As above.
 * rescue_work           240000  components x    OSQP where the predictor did not converge: 400 iterations at N = 150,
 *                               iterations      some 95 ms of one core (bench_path). No camera path in tests/reference
 *                                               needs it, only motions that no camera makes.
 * rescue_work_a_frame   6000    the same, for   Some 2 ms: windows that slide by one frame need a solve for each frame,
 *                               each frame      and keep up with the video only if it costs less than a frame lasts.
 * rescue_least          25      iterations      With fewer OSQP is not run: its setup alone costs as much.
 * several_frames        8       frames          AUTO: OSQP's check costs about as much as the predictor. Spread over
 *                                               8 frames it is below 1 ms a frame at N = 150 (bench_path).
 */
static const L1L2PathQpSettings check_settings = {.max_iterations = 50, .rho = 0.1, .tolerance = 1e-5};
static const L1L2PathQpSettings solve_settings = {.max_iterations = 4000, .rho = 2.0, .tolerance = 1e-6};
static const int rescue_work = 240000, rescue_work_a_frame = 6000, rescue_least = 25;
static const int several_frames = 8;

struct L1L2PathSolver {
    L1L2PathInteriorPoint *predictor;
    L1L2PathQp *qp;
    double *z, *y; /* OSQP's start, then its solution */
};

L1L2PathSolver *l1l2_path_solver_create(int capacity, int dim)
{
    L1L2PathSolver *s = l1l2_mem_new(1, sizeof *s);
    if (!s)
        return NULL;
    s->predictor = l1l2_path_interior_point_create(capacity, dim);
    s->qp = l1l2_path_problem_as_qp_create(capacity, dim);
    if (s->qp) {
        s->z = l1l2_mem_new((size_t)s->qp->max_cols, sizeof *s->z);
        s->y = l1l2_mem_new((size_t)s->qp->max_rows, sizeof *s->y);
    }
    if (s->predictor && s->qp && s->z && s->y)
        return s;
    l1l2_path_solver_free(s);
    return NULL;
}

void l1l2_path_solver_free(L1L2PathSolver *s)
{
    if (!s)
        return;
    l1l2_path_interior_point_free(s->predictor);
    l1l2_path_qp_free(s->qp);
    l1l2_mem_free(s->z);
    l1l2_mem_free(s->y);
    l1l2_mem_free(s);
}

int l1l2_path_solver_rescue_iterations(const L1L2PathProblem *p, int emitted)
{
    const int work = emitted < rescue_work / rescue_work_a_frame ? emitted * rescue_work_a_frame : rescue_work;
    const int iterations = work / (p->dim * p->count);
    if (iterations < rescue_least)
        return 0;
    return iterations < solve_settings.max_iterations ? iterations : solve_settings.max_iterations;
}

/* Runs OSQP from the point in z and y, and leaves its own there. True where it converged. */
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

/* Copies OSQP's path to q. False, and q as it was, where it is not finite. */
static bool take_osqp_path(const L1L2PathSolver *s, const L1L2PathProblem *p, double (*q)[L1L2_DIM])
{
    for (int i = 0; i < p->dim * p->count; i++)
        if (!isfinite(s->z[i]))
            return false;
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            q[t][j] = s->z[l1l2_path_qp_col_q(p, t, j)];
    return true;
}

/* OSQP alone starts at P = C with duals of 0. */
static void solve_by_osqp_alone(L1L2PathSolver *s, const L1L2PathProblem *p, double (*q)[L1L2_DIM],
                                L1L2PathSolverReport *report)
{
    l1l2_path_problem_as_qp_fill(p, s->qp);
    memset(s->z, 0, (size_t)s->qp->cols * sizeof *s->z);
    memset(s->y, 0, (size_t)s->qp->rows * sizeof *s->y);
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            s->z[l1l2_path_qp_col_q(p, t, j)] = p->camera[t][j];
    const bool converged = run_osqp(s, &solve_settings, report);
    if (take_osqp_path(s, p, q)) {
        report->decided_by = L1L2STAB_SOLVER_OSQP;
        report->converged = converged;
    }
}

/* OSQP's check of a point that the predictor found. */
static void check(L1L2PathSolver *s, const L1L2PathProblem *p, const L1L2PathPoint *point,
                  L1L2PathSolverReport *report)
{
    l1l2_path_problem_as_qp_fill(p, s->qp);
    l1l2_path_problem_as_qp_point(p, point, s->z, s->y);
    if (run_osqp(s, &check_settings, report))
        report->decided_by = L1L2STAB_SOLVER_CHECKED;
}

/* OSQP goes on from where the predictor stopped. */
static void rescue(L1L2PathSolver *s, const L1L2PathProblem *p, int emitted, const L1L2PathPoint *point,
                   double (*q)[L1L2_DIM], L1L2PathSolverReport *report)
{
    L1L2PathQpSettings settings = solve_settings;
    settings.max_iterations = l1l2_path_solver_rescue_iterations(p, emitted);
    if (settings.max_iterations == 0)
        return;
    l1l2_path_problem_as_qp_fill(p, s->qp);
    l1l2_path_problem_as_qp_point(p, point, s->z, s->y);
    if (run_osqp(s, &settings, report) && take_osqp_path(s, p, q)) {
        report->decided_by = L1L2STAB_SOLVER_OSQP;
        report->converged = true;
    }
}

L1L2PathSolverReport l1l2_path_solver_solve(L1L2PathSolver *s, L1L2StabSolver choice, int emitted,
                                            const L1L2PathProblem *p, double (*q)[L1L2_DIM])
{
    L1L2PathSolverReport report = {.decided_by = L1L2STAB_SOLVER_PREDICTOR, .bound = HUGE_VAL};
    if (choice == L1L2STAB_SOLVER_AUTO)
        choice = emitted >= several_frames ? L1L2STAB_SOLVER_CHECKED : L1L2STAB_SOLVER_PREDICTOR;
    memcpy(q, p->camera, (size_t)p->count * sizeof *q);
    if (choice == L1L2STAB_SOLVER_OSQP) {
        solve_by_osqp_alone(s, p, q, &report);
    } else {
        L1L2PathPoint point;
        const L1L2PathInteriorPointReport found = l1l2_path_interior_point_solve(s->predictor, p, &point);
        memcpy(q, point.q, (size_t)p->count * sizeof *q);
        report.converged = found.converged;
        report.predictor_iterations = found.iterations;
        report.bound = found.bound;
        if (!found.converged)
            rescue(s, p, emitted, &point, q, &report);
        else if (choice == L1L2STAB_SOLVER_CHECKED)
            check(s, p, &point, &report);
    }
    report.excess = l1l2_path_excess(p, (const double(*)[L1L2_DIM])q);
    return report;
}
