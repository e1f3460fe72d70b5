/* SPDX-License-Identifier: MIT */
/*
 * The solver behind qp.h: OSQP (Stellato et al., Math. Prog. Comp. 2020). The only file that knows it.
 *
 * Everything that could make two runs differ, or touch the process, is pinned: no clock (OSQP is built without
 * PROFILING, and rho is fixed), no signal handler, no printing, no time limit, no polishing (it works only where the
 * active set is nearly trivial, and was seen to make results worse).
 */
#include <osqp.h>

#include "common/mem.h"
#include "path/qp.h"

static void settle(OSQPSettings *settings, const L1L2PathQpSettings *wanted)
{
    osqp_set_default_settings(settings);
    settings->scaling = 0;      /* path_qp.c scales by hand */
    settings->adaptive_rho = 0;
    settings->rho = wanted->rho;
    settings->sigma = 1e-6;
    settings->alpha = 1.6;
    settings->eps_abs = wanted->tolerance;
    settings->eps_rel = 0.0;
    settings->eps_prim_inf = settings->eps_dual_inf = 1e-12; /* B = identity is feasible, and nothing is unbounded */
    settings->max_iter = wanted->max_iterations;
    settings->check_termination = 1; /* costs less than an iteration, and a good start is accepted at once */
    settings->polish = 0;
    settings->verbose = 0;
    settings->warm_start = 1;
}

static L1L2StabResult run(OSQPWorkspace *work, const L1L2PathQp *qp, double *z, double *y, L1L2PathQpReport *report)
{
    if (osqp_warm_start(work, z, y) != 0 || osqp_solve(work) != 0)
        return L1L2STAB_ERR_BACKEND;
    for (int i = 0; i < qp->cols; i++)
        z[i] = work->solution->x[i];
    for (int i = 0; i < qp->rows; i++)
        y[i] = work->solution->y[i];
    report->converged = work->info->status_val == OSQP_SOLVED;
    report->iterations = (int)work->info->iter;
    report->primal_residual = work->info->pri_res;
    report->dual_residual = work->info->dua_res;
    return L1L2STAB_OK;
}

L1L2StabResult l1l2_path_qp_solve(const L1L2PathQp *qp, const L1L2PathQpSettings *settings, double *z, double *y,
                             L1L2PathQpReport *report)
{
    *report = (L1L2PathQpReport){0};
    L1L2StabResult result = L1L2STAB_ERR_NOMEM;
    OSQPWorkspace *work = NULL;
    int *diagonal = l1l2_mem_new((size_t)qp->cols + 1, sizeof *diagonal);
    if (!diagonal)
        return result;
    for (int i = 0; i <= qp->cols; i++)
        diagonal[i] = i;
    csc P = {.nzmax = qp->cols, .m = qp->cols, .n = qp->cols, .p = diagonal, .i = diagonal, .x = qp->p, .nz = -1};
    csc A = {.nzmax = qp->entries, .m = qp->rows, .n = qp->cols, .p = qp->start, .i = qp->row, .x = qp->value,
             .nz = -1};
    OSQPData data = {.n = qp->cols, .m = qp->rows, .P = &P, .A = &A, .q = qp->q, .l = qp->lower, .u = qp->upper};
    OSQPSettings osqp;
    settle(&osqp, settings);
    switch (osqp_setup(&work, &data, &osqp)) {
    case 0:
        result = run(work, qp, z, y, report);
        break;
    case OSQP_MEM_ALLOC_ERROR:
    case OSQP_WORKSPACE_NOT_INIT_ERROR:
        break;
    default:
        result = L1L2STAB_ERR_BACKEND;
    }
    osqp_cleanup(work); /* also after a failed set-up, which leaves its parts behind */
    l1l2_mem_free(diagonal);
    return result;
}
