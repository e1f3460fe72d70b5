/* SPDX-License-Identifier: MIT */
#include "path/problem_as_qp.h"

#include <assert.h>

/*
 * Parameters: equilibration by hand. With OSQP's default settings, its own scaling among them, hard windows end 6 to 10
 * px off.
 *
 * name        value        effect, and what chose the value
 * ----------  -----------  ------------------------------------------------------------------------------------------
 * term_scale  20, 50, 200  Multiplies the rows of |D^k q| and their slacks. Differences of higher order are smaller
 *                          numbers; scaled, all rows have residuals of like size. With these values OSQP accepts
 *                          the predictor's point at its first test on 481 of 496 problems (test_solver).
 * crop_scale  3            The same for the rows of the constraints.
 */
static const double term_scale[L1L2_PATH_ORDERS] = {20.0, 50.0, 200.0};
static const double crop_scale = 3.0;

int l1l2_path_qp_col_q(const L1L2PathProblem *p, int frame, int component)
{
    return p->dim * frame + component;
}

int l1l2_path_qp_col_slack(const L1L2PathProblem *p, int order, int term, int component)
{
    return p->dim * p->count + l1l2_path_term_index(p, order, term, component);
}

int l1l2_path_qp_row_term(const L1L2PathProblem *p, int order, int term, int component, int side)
{
    return 2 * l1l2_path_term_index(p, order, term, component) + side;
}

int l1l2_path_qp_row_constraint(const L1L2PathProblem *p, int frame, int row)
{
    return 2 * l1l2_path_term_components(p) + p->rows * frame + row;
}

int l1l2_path_qp_cols(const L1L2PathProblem *p)
{
    return p->dim * p->count + l1l2_path_term_components(p);
}

int l1l2_path_qp_rows(const L1L2PathProblem *p)
{
    return l1l2_path_qp_row_constraint(p, p->count, 0);
}

L1L2PathQp *l1l2_path_problem_as_qp_create(int capacity, int dim)
{
    const L1L2PathProblem largest = {
        .dim = dim, .rows = l1l2_path_constraint_count(dim), .count = capacity, .history = L1L2_PATH_HISTORY};
    /* A component of q is in 2 (2 + 3 + 4) rows of differences and in its frame's constraints; a slack is in 2 rows. */
    return l1l2_path_qp_create(l1l2_path_qp_cols(&largest), l1l2_path_qp_rows(&largest),
                          dim * capacity * (18 + largest.rows) + 2 * l1l2_path_term_components(&largest));
}

static void put(L1L2PathQp *qp, int row, double value)
{
    qp->row[qp->entries] = row;
    qp->value[qp->entries++] = value;
}

/* The rows that contain q_{t,j}: the differences at t .. t+k, then the frame's own constraints. */
static void fill_q_column(const L1L2PathProblem *p, L1L2PathQp *qp, int t, int j)
{
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++) {
        const int first = l1l2_path_first_term(order, p->history);
        for (int m = 0; m <= order; m++) {
            const int i = t + m - first;
            if (i < 0 || t + m >= p->count)
                continue;
            const double value = term_scale[order - 1] * p->difference[t + m][order - 1][m];
            put(qp, l1l2_path_qp_row_term(p, order, i, j, 0), value);
            put(qp, l1l2_path_qp_row_term(p, order, i, j, 1), -value);
        }
    }
    for (int r = 0; r < p->rows; r++)
        put(qp, l1l2_path_qp_row_constraint(p, t, r), crop_scale * p->G[t][r][j]);
}

/* A slack's column, and the bounds of its rows. The part of a difference that lies in the past is a constant. */
static void fill_term(const L1L2PathProblem *p, L1L2PathQp *qp, int order, int i, int j)
{
    const int t = i + l1l2_path_first_term(order, p->history);
    const int row = l1l2_path_qp_row_term(p, order, i, j, 0);
    double constant = 0.0;
    for (int m = t + 1; m <= order; m++)
        constant += p->difference[t][order - 1][m] * p->past[L1L2_PATH_HISTORY + t - m][j];
    put(qp, row, -1.0);
    put(qp, row + 1, -1.0);
    qp->lower[row] = qp->lower[row + 1] = -L1L2_PATH_QP_INFINITY;
    qp->upper[row] = -term_scale[order - 1] * constant;
    qp->upper[row + 1] = term_scale[order - 1] * constant;
}

void l1l2_path_problem_as_qp_fill(const L1L2PathProblem *p, L1L2PathQp *qp)
{
    const int n = p->count, h = p->history;
    qp->cols = l1l2_path_qp_cols(p);
    qp->rows = l1l2_path_qp_rows(p);
    qp->entries = 0;
    for (int t = 0; t < n; t++)
        for (int j = 0; j < p->dim; j++) {
            const int col = l1l2_path_qp_col_q(p, t, j);
            qp->start[col] = qp->entries;
            qp->p[col] = 2.0 * p->lambda[t];
            qp->q[col] = -2.0 * p->lambda[t] * p->camera[t][j];
            fill_q_column(p, qp, t, j);
        }
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int i = 0; i < l1l2_path_terms(order, n, h); i++)
            for (int j = 0; j < p->dim; j++) {
                const int col = l1l2_path_qp_col_slack(p, order, i, j);
                qp->start[col] = qp->entries;
                qp->p[col] = 0.0;
                qp->q[col] = p->weight[order - 1] / term_scale[order - 1];
                fill_term(p, qp, order, i, j);
            }
    qp->start[qp->cols] = qp->entries;
    for (int t = 0; t < n; t++)
        for (int r = 0; r < p->rows; r++) {
            const int row = l1l2_path_qp_row_constraint(p, t, r);
            qp->lower[row] = crop_scale * p->lo[t][r];
            qp->upper[row] = crop_scale * p->hi[t][r];
        }
    assert(qp->cols <= qp->max_cols && qp->rows <= qp->max_rows && qp->entries <= qp->max_entries);
}

void l1l2_path_problem_as_qp_point(const L1L2PathProblem *p, const L1L2PathPoint *point, double *z, double *y)
{
    const int n = p->count, h = p->history;
    for (int t = 0; t < n; t++) {
        for (int j = 0; j < p->dim; j++)
            z[l1l2_path_qp_col_q(p, t, j)] = point->q[t][j];
        for (int r = 0; r < p->rows; r++)
            y[l1l2_path_qp_row_constraint(p, t, r)] = point->constraint_dual[t][r] / crop_scale;
    }
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int i = 0; i < l1l2_path_terms(order, n, h); i++)
            for (int j = 0; j < p->dim; j++) {
                const int index = l1l2_path_term_index(p, order, i, j);
                z[l1l2_path_qp_col_slack(p, order, i, j)] = point->slack[index] * term_scale[order - 1];
                for (int side = 0; side < 2; side++)
                    y[l1l2_path_qp_row_term(p, order, i, j, side)] =
                        point->term_dual[index][side] / term_scale[order - 1];
            }
}
