/* SPDX-License-Identifier: MIT */
/*
 * The solver behind qp.h: OSQP (Stellato et al., Math. Prog. Comp. 2020), version 0.6. The only file that uses it.
 *
 * Determinism. Everything that could make two runs differ, or that touches the process, is off: no clock (rho is fixed;
 * the bundled OSQP is built without PROFILING), no signal handler, no printing, no time limit. Polishing is off too: it
 * works only where the active set is nearly trivial, and it was seen to make results worse.
 *
 * Memory. OSQP 0.6 dereferences the result of most of its allocations unchecked (qdldl_interface.c, cs.c, kkt.c), and
 * osqp_cleanup() after a failed osqp_setup() frees members of structures that were allocated but not yet filled in. A
 * NULL from malloc() therefore crashes it, or corrupts the heap. The bundled OSQP is built with the allocator below
 * (osqp_memory.h), which removes both faults without a change to OSQP's source:
 *
 *   - every block is on a list that belongs to one call of l1l2_path_qp_solve();
 *   - where memory is short, the allocator leaves OSQP by longjmp(), so that OSQP never sees NULL. OSQP is plain C, and
 *     holds no lock and no file: there is nothing else to unwind;
 *   - at the end of the call all blocks on the list are freed. That needs no osqp_cleanup(), and cannot leak.
 *
 * OSQP's allocator functions take no context, so the list's owner is found by a thread-local pointer, which is set
 * during the call alone.
 *
 * An OSQP of the system has its own allocator. After a failed setup, clean_up() sets the members that osqp_setup() left
 * unset, so that osqp_cleanup() is safe. Nothing can be done from outside about OSQP's unchecked allocations.
 */
#include <osqp.h>

#include <setjmp.h>
#include <stdint.h>
#include <string.h>

#include "common/mem.h"
#include "path/qp.h"

_Static_assert(sizeof(c_float) == sizeof(double), "OSQP must be built for double precision");

typedef struct Task {
    const L1L2PathQp *qp;
    const L1L2PathQpSettings *settings;
    double *z, *y;
    L1L2PathQpReport *report;
    c_int *index; /* (cols + 1) of the diagonal, (cols + 1) of A's column starts, then A's rows */
} Task;

static L1L2StabResult set_up_and_solve(const Task *task);

#ifdef OSQP_CUSTOM_MEMORY

typedef struct Block {
    struct Block *before, *after;
    size_t size;
    max_align_t data[];
} Block;

typedef struct Memory {
    Block *newest;
    jmp_buf exhausted;
} Memory;

static _Thread_local Memory *memory; /* of the call that runs on this thread */

static Block *block_of(void *data)
{
    return (Block *)((char *)data - offsetof(Block, data));
}

void *l1l2_path_osqp_malloc(size_t size)
{
    Block *block = size <= SIZE_MAX - sizeof *block ? l1l2_mem_new(1, sizeof *block + size) : NULL;
    if (!block)
        longjmp(memory->exhausted, 1);
    block->size = size;
    block->after = memory->newest;
    if (block->after)
        block->after->before = block;
    memory->newest = block;
    return block->data;
}

void *l1l2_path_osqp_calloc(size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / size)
        longjmp(memory->exhausted, 1);
    return l1l2_path_osqp_malloc(count * size); /* l1l2_mem_new() zeroes */
}

void l1l2_path_osqp_free(void *data)
{
    if (!data)
        return;
    Block *block = block_of(data);
    if (block->after)
        block->after->before = block->before;
    if (block->before)
        block->before->after = block->after;
    else
        memory->newest = block->after;
    l1l2_mem_free(block);
}

void *l1l2_path_osqp_realloc(void *data, size_t size)
{
    void *moved = l1l2_path_osqp_malloc(size);
    if (data) {
        const size_t old_size = block_of(data)->size;
        memcpy(moved, data, old_size < size ? old_size : size);
        l1l2_path_osqp_free(data);
    }
    return moved;
}

/* A function of its own for setjmp(): local variables that change after it would have no defined value. */
static L1L2StabResult solve_unless_exhausted(const Task *task)
{
    if (setjmp(memory->exhausted) != 0)
        return L1L2STAB_ERR_NOMEM;
    return set_up_and_solve(task);
}

static L1L2StabResult solve_in_memory(const Task *task)
{
    Memory own = {.newest = NULL};
    memory = &own;
    const L1L2StabResult result = solve_unless_exhausted(task);
    while (own.newest)
        l1l2_path_osqp_free(own.newest->data);
    memory = NULL;
    return result;
}

static void clean_up(OSQPWorkspace *work)
{
    (void)work; /* solve_in_memory() frees it */
}

#else

static L1L2StabResult solve_in_memory(const Task *task)
{
    return set_up_and_solve(task);
}

/* osqp_setup() fills work->data member by member and stops at the first that fails; what follows is not set. It sets P
 * and q together, then A, then l and u. Its other structures are zeroed, or complete before their first check. */
static void clean_up(OSQPWorkspace *work)
{
    if (work && work->data) {
        if (!work->data->P || !work->data->q)
            work->data->A = NULL;
        if (!work->data->A)
            work->data->l = work->data->u = NULL;
    }
    osqp_cleanup(work);
}

#endif

static OSQPSettings settings_of(const L1L2PathQpSettings *wanted)
{
    OSQPSettings settings;
    osqp_set_default_settings(&settings);
    settings.scaling = 0; /* problem_as_qp.c scales by hand */
    settings.adaptive_rho = 0;
    settings.rho = wanted->rho;
    settings.sigma = 1e-6; /* OSQP's default, as is alpha */
    settings.alpha = 1.6;
    settings.eps_abs = wanted->tolerance;
    settings.eps_rel = 0.0;
    settings.eps_prim_inf = settings.eps_dual_inf = 1e-12; /* B = identity is feasible, and nothing is unbounded */
    settings.max_iter = wanted->max_iterations;
    settings.check_termination = 1; /* costs less than an iteration, and a good start is accepted at once */
    settings.polish = 0;
    settings.verbose = 0;
    settings.warm_start = 1;
    return settings;
}

static L1L2StabResult solve(OSQPWorkspace *work, const Task *task)
{
    if (osqp_warm_start(work, task->z, task->y) != 0 || osqp_solve(work) != 0)
        return L1L2STAB_ERR_BACKEND;
    memcpy(task->z, work->solution->x, (size_t)task->qp->cols * sizeof *task->z);
    memcpy(task->y, work->solution->y, (size_t)task->qp->rows * sizeof *task->y);
    task->report->converged = work->info->status_val == OSQP_SOLVED;
    task->report->iterations = (int)work->info->iter;
    task->report->primal_residual = work->info->pri_res;
    task->report->dual_residual = work->info->dua_res;
    return L1L2STAB_OK;
}

static L1L2StabResult set_up_and_solve(const Task *task)
{
    const L1L2PathQp *qp = task->qp;
    c_int *diagonal = task->index, *start = diagonal + qp->cols + 1, *row = start + qp->cols + 1;
    for (int i = 0; i <= qp->cols; i++)
        diagonal[i] = i, start[i] = qp->start[i];
    for (int i = 0; i < qp->entries; i++)
        row[i] = qp->row[i];
    csc P = {.nzmax = qp->cols, .m = qp->cols, .n = qp->cols, .p = diagonal, .i = diagonal, .x = qp->p, .nz = -1};
    csc A = {.nzmax = qp->entries, .m = qp->rows, .n = qp->cols, .p = start, .i = row, .x = qp->value, .nz = -1};
    const OSQPData data = {
        .n = qp->cols, .m = qp->rows, .P = &P, .A = &A, .q = qp->q, .l = qp->lower, .u = qp->upper};
    const OSQPSettings settings = settings_of(task->settings);
    OSQPWorkspace *work = NULL;
    L1L2StabResult result;
    switch (osqp_setup(&work, &data, &settings)) {
    case 0:
        result = solve(work, task);
        break;
    case OSQP_MEM_ALLOC_ERROR:
    case OSQP_WORKSPACE_NOT_INIT_ERROR:
        result = L1L2STAB_ERR_NOMEM;
        break;
    default:
        result = L1L2STAB_ERR_BACKEND;
    }
    clean_up(work);
    return result;
}

L1L2StabResult l1l2_path_qp_solve(const L1L2PathQp *qp, const L1L2PathQpSettings *settings, double *z, double *y,
                                  L1L2PathQpReport *report)
{
    Task task = {.qp = qp, .settings = settings, .z = z, .y = y, .report = report};
    *report = (L1L2PathQpReport){0};
    task.index = l1l2_mem_new(2 * ((size_t)qp->cols + 1) + (size_t)qp->entries, sizeof *task.index);
    if (!task.index)
        return L1L2STAB_ERR_NOMEM;
    const L1L2StabResult result = solve_in_memory(&task);
    l1l2_mem_free(task.index);
    return result;
}
