/* SPDX-License-Identifier: MIT */
#include "path_qp.h"

#include <assert.h>
#include <math.h>

#include "mem.h"

/* Signs and sizes of the backward differences: D^k q_t = sum_m binomial[k-1][m] q_{t-m}. */
static const double binomial[3][4] = {{1, -1, 0, 0}, {1, -2, 1, 0}, {1, -3, 3, -1}};

/* Hand-made equilibration, in place of the solver's own scaling, which measured worse: rows are multiplied by these,
 * the slacks of a difference with them. */
static const double term_scale[3] = {20.0, 50.0, 200.0};
static const double crop_scale = 3.0;

void l1l2_q_from_mat(const L1L2Mat *m, double q[L1L2_DIM])
{
    q[0] = 0.5 * m->m[0], q[1] = 0.5 * m->m[3], q[2] = m->m[2], q[3] = m->m[5];
}

L1L2Mat l1l2_q_to_mat(const double q[L1L2_DIM])
{
    return l1l2_mat_similarity(2.0 * q[0], 2.0 * q[1], q[2], q[3]);
}

L1L2WindowProblem *l1l2_window_problem_create(int capacity)
{
    const size_t n = (size_t)capacity;
    L1L2WindowProblem *p = l1l2_mem_new(1, sizeof *p);
    if (!p)
        return NULL;
    p->weight[0] = p->weight[1] = p->weight[2] = 1.0;
    p->camera = l1l2_mem_new(n, sizeof *p->camera);
    p->lambda = l1l2_mem_new(n, sizeof *p->lambda);
    p->G = l1l2_mem_new(n, sizeof *p->G);
    p->lo = l1l2_mem_new(n, sizeof *p->lo);
    p->hi = l1l2_mem_new(n, sizeof *p->hi);
    if (p->camera && p->lambda && p->G && p->lo && p->hi)
        return p;
    l1l2_window_problem_free(p);
    return NULL;
}

void l1l2_window_problem_free(L1L2WindowProblem *p)
{
    if (!p)
        return;
    l1l2_mem_free(p->camera);
    l1l2_mem_free(p->lambda);
    l1l2_mem_free(p->G);
    l1l2_mem_free(p->lo);
    l1l2_mem_free(p->hi);
    l1l2_mem_free(p);
}

/* D^k q_t, over the window's start into the past. */
static double difference(const L1L2WindowProblem *p, const double (*q)[L1L2_DIM], int order, int t, int j)
{
    double sum = 0.0;
    for (int m = 0; m <= order; m++)
        sum += binomial[order - 1][m] * (t - m >= 0 ? q[t - m][j] : p->past[L1L2_HISTORY + t - m][j]);
    return sum;
}

double l1l2_window_objective(const L1L2WindowProblem *p, const double (*q)[L1L2_DIM])
{
    double sum = 0.0;
    for (int order = 1; order <= 3; order++)
        for (int t = l1l2_terms_first(order, p->history); t < p->count; t++)
            for (int j = 0; j < L1L2_DIM; j++)
                sum += p->weight[order - 1] * fabs(difference(p, q, order, t, j));
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < L1L2_DIM; j++)
            sum += p->lambda[t] * (q[t][j] - p->camera[t][j]) * (q[t][j] - p->camera[t][j]);
    return sum;
}

double l1l2_window_excess(const L1L2WindowProblem *p, const double (*q)[L1L2_DIM])
{
    double worst = -HUGE_VAL;
    for (int t = 0; t < p->count; t++)
        for (int r = 0; r < L1L2_CROP_ROWS; r++) {
            double value = 0.0;
            for (int j = 0; j < L1L2_DIM; j++)
                value += p->G[t][r][j] * q[t][j];
            worst = fmax(worst, fmax(value - p->hi[t][r], p->lo[t][r] - value));
        }
    return worst;
}

int l1l2_terms_first(int order, int history)
{
    return order > history ? order - history : 0;
}

int l1l2_terms(int order, int count, int history)
{
    const int terms = count - l1l2_terms_first(order, history);
    return terms > 0 ? terms : 0;
}

/* Terms of all orders below this one. */
static int terms_below(int order, int count, int history)
{
    int sum = 0;
    for (int k = 1; k < order; k++)
        sum += l1l2_terms(k, count, history);
    return sum;
}

int l1l2_col_q(int frame, int component)
{
    return L1L2_DIM * frame + component;
}

int l1l2_col_slack(int count, int history, int order, int term, int component)
{
    return L1L2_DIM * (count + terms_below(order, count, history) + term) + component;
}

int l1l2_row_term(int count, int history, int order, int term, int component, int side)
{
    return 2 * (L1L2_DIM * (terms_below(order, count, history) + term) + component) + side;
}

int l1l2_row_crop(int count, int history, int frame, int row)
{
    return 2 * L1L2_DIM * terms_below(4, count, history) + L1L2_CROP_ROWS * frame + row;
}

int l1l2_cols(int count, int history)
{
    return l1l2_col_slack(count, history, 4, 0, 0);
}

int l1l2_rows(int count, int history)
{
    return l1l2_row_crop(count, history, count, 0);
}

L1L2Qp *l1l2_path_qp_create(int capacity)
{
    /* A component of q stands in 2 (2 + 3 + 4) rows of differences and in the crop rows; a slack in two rows. */
    return l1l2_qp_create(l1l2_cols(capacity, L1L2_HISTORY), l1l2_rows(capacity, L1L2_HISTORY),
                          L1L2_DIM * capacity * (18 + L1L2_CROP_ROWS) +
                              2 * (l1l2_cols(capacity, L1L2_HISTORY) - L1L2_DIM * capacity));
}

static void put(L1L2Qp *qp, int row, double value)
{
    qp->row[qp->entries] = row;
    qp->value[qp->entries++] = value;
}

/* The rows in which q_{t,j} stands: the differences at t .. t+k, then the frame's own crop rows. */
static void fill_q_column(const L1L2WindowProblem *p, L1L2Qp *qp, int t, int j)
{
    for (int order = 1; order <= 3; order++) {
        const int first = l1l2_terms_first(order, p->history);
        for (int m = 0; m <= order; m++) {
            const int i = t + m - first;
            if (i < 0 || t + m >= p->count)
                continue;
            const double value = term_scale[order - 1] * binomial[order - 1][m];
            put(qp, l1l2_row_term(p->count, p->history, order, i, j, 0), value);
            put(qp, l1l2_row_term(p->count, p->history, order, i, j, 1), -value);
        }
    }
    for (int r = 0; r < L1L2_CROP_ROWS; r++)
        put(qp, l1l2_row_crop(p->count, p->history, t, r), crop_scale * p->G[t][r][j]);
}

/* Slacks, and the bounds of their rows: what a difference takes from the past is a constant. */
static void fill_term(const L1L2WindowProblem *p, L1L2Qp *qp, int order, int i, int j)
{
    const int t = i + l1l2_terms_first(order, p->history);
    const int row = l1l2_row_term(p->count, p->history, order, i, j, 0);
    double constant = 0.0;
    for (int m = t + 1; m <= order; m++)
        constant += binomial[order - 1][m] * p->past[L1L2_HISTORY + t - m][j];
    put(qp, row, -1.0);
    put(qp, row + 1, -1.0);
    qp->lower[row] = qp->lower[row + 1] = -L1L2_QP_INFINITY;
    qp->upper[row] = -term_scale[order - 1] * constant;
    qp->upper[row + 1] = term_scale[order - 1] * constant;
}

void l1l2_path_qp_fill(const L1L2WindowProblem *p, L1L2Qp *qp)
{
    const int n = p->count, h = p->history;
    qp->cols = l1l2_cols(n, h);
    qp->rows = l1l2_rows(n, h);
    qp->entries = 0;
    for (int t = 0; t < n; t++)
        for (int j = 0; j < L1L2_DIM; j++) {
            const int col = l1l2_col_q(t, j);
            qp->start[col] = qp->entries;
            qp->p[col] = 2.0 * p->lambda[t];
            qp->q[col] = -2.0 * p->lambda[t] * p->camera[t][j];
            fill_q_column(p, qp, t, j);
        }
    for (int order = 1; order <= 3; order++)
        for (int i = 0; i < l1l2_terms(order, n, h); i++)
            for (int j = 0; j < L1L2_DIM; j++) {
                const int col = l1l2_col_slack(n, h, order, i, j);
                qp->start[col] = qp->entries;
                qp->p[col] = 0.0;
                qp->q[col] = p->weight[order - 1] / term_scale[order - 1];
                fill_term(p, qp, order, i, j);
            }
    qp->start[qp->cols] = qp->entries;
    for (int t = 0; t < n; t++)
        for (int r = 0; r < L1L2_CROP_ROWS; r++) {
            const int row = l1l2_row_crop(n, h, t, r);
            qp->lower[row] = crop_scale * p->lo[t][r];
            qp->upper[row] = crop_scale * p->hi[t][r];
        }
    assert(qp->cols <= qp->max_cols && qp->rows <= qp->max_rows && qp->entries <= qp->max_entries);
}
