/* SPDX-License-Identifier: MIT */
#include "path/qp.h"

#include "common/mem.h"

L1L2PathQp *l1l2_path_qp_create(int max_cols, int max_rows, int max_entries)
{
    L1L2PathQp *qp = l1l2_mem_new(1, sizeof *qp);
    if (!qp)
        return NULL;
    const size_t cols = (size_t)max_cols, rows = (size_t)max_rows, entries = (size_t)max_entries;
    *qp = (L1L2PathQp){.max_cols = max_cols, .max_rows = max_rows, .max_entries = max_entries};
    qp->p = l1l2_mem_new(cols, sizeof *qp->p);
    qp->q = l1l2_mem_new(cols, sizeof *qp->q);
    qp->start = l1l2_mem_new(cols + 1, sizeof *qp->start);
    qp->row = l1l2_mem_new(entries, sizeof *qp->row);
    qp->value = l1l2_mem_new(entries, sizeof *qp->value);
    qp->lower = l1l2_mem_new(rows, sizeof *qp->lower);
    qp->upper = l1l2_mem_new(rows, sizeof *qp->upper);
    if (qp->p && qp->q && qp->start && qp->row && qp->value && qp->lower && qp->upper)
        return qp;
    l1l2_path_qp_free(qp);
    return NULL;
}

void l1l2_path_qp_free(L1L2PathQp *qp)
{
    if (!qp)
        return;
    l1l2_mem_free(qp->p);
    l1l2_mem_free(qp->q);
    l1l2_mem_free(qp->start);
    l1l2_mem_free(qp->row);
    l1l2_mem_free(qp->value);
    l1l2_mem_free(qp->lower);
    l1l2_mem_free(qp->upper);
    l1l2_mem_free(qp);
}
