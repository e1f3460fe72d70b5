/* SPDX-License-Identifier: MIT */
#include "path/problem.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/mem.h"

const double l1l2_path_difference_coefficients[L1L2_PATH_ORDERS][L1L2_PATH_HISTORY + 1] = {
    {1, -1, 0, 0}, {1, -2, 1, 0}, {1, -3, 3, -1}};

L1L2PathProblem *l1l2_path_problem_create(int capacity, int dim)
{
    const size_t n = (size_t)capacity;
    L1L2PathProblem *p = l1l2_mem_new(1, sizeof *p);
    if (!p)
        return NULL;
    p->dim = dim;
    p->rows = l1l2_path_constraint_count(dim);
    p->weight[0] = p->weight[1] = p->weight[2] = 1.0;
    p->camera = l1l2_mem_new(n, sizeof *p->camera);
    p->difference = l1l2_mem_new(n, sizeof *p->difference);
    p->lambda = l1l2_mem_new(n, sizeof *p->lambda);
    p->G = l1l2_mem_new(n, sizeof *p->G);
    p->lo = l1l2_mem_new(n, sizeof *p->lo);
    p->hi = l1l2_mem_new(n, sizeof *p->hi);
    if (!p->camera || !p->difference || !p->lambda || !p->G || !p->lo || !p->hi) {
        l1l2_path_problem_free(p);
        return NULL;
    }
    for (int t = 0; t < capacity; t++)
        memcpy(p->difference[t], l1l2_path_difference_coefficients, sizeof p->difference[t]);
    return p;
}

void l1l2_path_problem_free(L1L2PathProblem *p)
{
    if (!p)
        return;
    l1l2_mem_free(p->camera);
    l1l2_mem_free(p->difference);
    l1l2_mem_free(p->lambda);
    l1l2_mem_free(p->G);
    l1l2_mem_free(p->lo);
    l1l2_mem_free(p->hi);
    l1l2_mem_free(p);
}

void l1l2_path_problem_set(L1L2PathProblem *p, int t, const L1L2Mat *camera, double lambda,
                           const L1L2PathCropWindow *crop)
{
    assert(crop->dim == p->dim);
    l1l2_mat_to_q(camera, p->camera[t]);
    p->lambda[t] = lambda;
    l1l2_path_constraint_rows(crop, camera, p->G[t], p->lo[t], p->hi[t]);
}

void l1l2_path_problem_set_steps(L1L2PathProblem *p, int t, const double step[L1L2_PATH_HISTORY])
{
    const double u[3] = {1.0 / step[0], 1.0 / step[1], 1.0 / step[2]};
    const double s[2] = {2.0 / (step[0] + step[1]), 2.0 / (step[1] + step[2])};
    double(*row)[L1L2_PATH_HISTORY + 1] = p->difference[t];
    row[0][0] = 1.0;
    row[0][1] = -1.0;
    row[1][0] = u[0];
    row[1][1] = -(u[0] + u[1]);
    row[1][2] = u[1];
    row[2][0] = s[0] * u[0];
    row[2][1] = -s[0] * (u[0] + u[1]) - s[1] * u[1];
    row[2][2] = s[0] * u[1] + s[1] * (u[1] + u[2]);
    row[2][3] = -s[1] * u[2];
}

double l1l2_path_difference(const L1L2PathProblem *p, const double (*q)[L1L2_DIM], int order, int t, int j)
{
    double sum = 0.0;
    for (int m = 0; m <= order; m++)
        sum += p->difference[t][order - 1][m] *
               (t - m >= 0 ? q[t - m][j] : p->past[L1L2_PATH_HISTORY + t - m][j]);
    return sum;
}

double l1l2_path_objective(const L1L2PathProblem *p, const double (*q)[L1L2_DIM])
{
    double sum = 0.0;
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int t = l1l2_path_first_term(order, p->history); t < p->count; t++)
            for (int j = 0; j < p->dim; j++)
                sum += p->weight[order - 1] * fabs(l1l2_path_difference(p, q, order, t, j));
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            sum += p->lambda[t] * (q[t][j] - p->camera[t][j]) * (q[t][j] - p->camera[t][j]);
    return sum;
}

double l1l2_path_excess(const L1L2PathProblem *p, const double (*q)[L1L2_DIM])
{
    double worst = -HUGE_VAL;
    for (int t = 0; t < p->count; t++)
        for (int r = 0; r < p->rows; r++) {
            double value = 0.0;
            for (int j = 0; j < p->dim; j++)
                value += p->G[t][r][j] * q[t][j];
            worst = fmax(worst, fmax(value - p->hi[t][r], p->lo[t][r] - value));
        }
    return worst;
}

int l1l2_path_first_term(int order, int history)
{
    return order > history ? order - history : 0;
}

int l1l2_path_terms(int order, int count, int history)
{
    const int terms = count - l1l2_path_first_term(order, history);
    return terms > 0 ? terms : 0;
}

int l1l2_path_term_index(const L1L2PathProblem *p, int order, int term, int component)
{
    for (int below = 1; below < order; below++)
        term += l1l2_path_terms(below, p->count, p->history);
    return p->dim * term + component;
}

int l1l2_path_term_components(const L1L2PathProblem *p)
{
    return l1l2_path_term_index(p, L1L2_PATH_ORDERS + 1, 0, 0);
}
