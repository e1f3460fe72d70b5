/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "path/problem_as_qp.h"

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* A window on a random walk with `history` frames before it. */
static L1L2PathProblem *random_window(int dim, int count, int history, double lambda, uint64_t seed)
{
    L1L2Rng rng = l1l2_rng_seeded(seed);
    L1L2PathProblem *p = l1l2_path_problem_create(count, dim);
    const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, 0.8, dim);
    L1L2Mat camera = l1l2_mat_identity();
    p->count = count;
    p->history = history;
    for (int t = 0; t < count; t++) {
        l1l2_path_problem_set(p, t, &camera, lambda * uniform(&rng, 0.5, 1.5), &crop);
        double q[L1L2_DIM];
        for (int j = 0; j < L1L2_DIM; j++)
            q[j] = (j == 2 ? 0.5 : 0.0) + uniform(&rng, -0.02, 0.03);
        camera = l1l2_mat_mul(camera, l1l2_mat_from_q(q, dim));
    }
    for (int i = 0; i < L1L2_PATH_HISTORY; i++)
        for (int j = 0; j < dim; j++)
            p->past[i][j] = (j == 2 ? 0.5 : 0.0) + uniform(&rng, -0.02, 0.02);
    return p;
}

static void check_bijections(const L1L2PathProblem *p)
{
    const int cols = l1l2_path_qp_cols(p), rows = l1l2_path_qp_rows(p);
    int *col_seen = calloc((size_t)cols, sizeof *col_seen), *row_seen = calloc((size_t)rows, sizeof *row_seen);
    for (int t = 0; t < p->count; t++) {
        for (int j = 0; j < p->dim; j++)
            col_seen[l1l2_path_qp_col_q(p, t, j)]++;
        for (int r = 0; r < p->rows; r++)
            row_seen[l1l2_path_qp_row_constraint(p, t, r)]++;
    }
    for (int order = 1; order <= 3; order++)
        for (int i = 0; i < l1l2_path_terms(order, p->count, p->history); i++)
            for (int j = 0; j < p->dim; j++) {
                col_seen[l1l2_path_qp_col_slack(p, order, i, j)]++;
                row_seen[l1l2_path_qp_row_term(p, order, i, j, 0)]++;
                row_seen[l1l2_path_qp_row_term(p, order, i, j, 1)]++;
            }
    for (int i = 0; i < cols; i++)
        ck_assert_int_eq(col_seen[i], 1);
    for (int i = 0; i < rows; i++)
        ck_assert_int_eq(row_seen[i], 1);
    free(col_seen);
    free(row_seen);
}

START_TEST(every_column_and_row_has_one_place)
{
    for (int dim = 2; dim <= 6; dim += 2)
        for (int count = 1; count <= 9; count++)
            for (int history = 0; history <= 3; history++)
                check_bijections(&(L1L2PathProblem){
                    .dim = dim, .rows = l1l2_path_constraint_count(dim), .count = count, .history = history});
}
END_TEST

START_TEST(terms_reach_no_further_back_than_the_history)
{
    for (int history = 0; history <= 3; history++)
        for (int order = 1; order <= 3; order++) {
            const int first = l1l2_path_first_term(order, history);
            ck_assert_int_ge(first - order, -history); /* it exists */
            if (first > 0)
                ck_assert_int_lt(first - 1 - order, -history); /* the one before it would not */
            ck_assert_int_eq(l1l2_path_terms(order, 2, history), first < 2 ? 2 - first : 0);
        }
}
END_TEST

START_TEST(columns_are_sorted_and_fit_the_arrays)
{
    for (int round = 0; round < 144; round++) {
        const int dim = 2 + 2 * (round % 3), count = 1 + round / 12, history = round / 3 % 4;
        L1L2PathProblem *p = random_window(dim, count, history, 0.5, 3);
        L1L2PathQp *qp = l1l2_path_problem_as_qp_create(count, dim);
        l1l2_path_problem_as_qp_fill(p, qp);
        ck_assert_int_le(qp->entries, qp->max_entries);
        for (int c = 0; c < qp->cols; c++)
            for (int k = qp->start[c]; k < qp->start[c + 1]; k++) {
                ck_assert_int_lt(qp->row[k], qp->rows);
                if (k > qp->start[c])
                    ck_assert_int_lt(qp->row[k - 1], qp->row[k]);
            }
        l1l2_path_qp_free(qp);
        l1l2_path_problem_free(p);
    }
}
END_TEST

/* Let every slack be |D^k q|. Then the program's objective is eq. (4) less its constant, its term rows hold with
 * equality, and its constraint rows hold where the problem's do. */
START_TEST(the_program_has_the_objective_and_constraints_of_the_problem)
{
    L1L2Rng rng = l1l2_rng_seeded(11);
    for (int round = 0; round < 120; round++) {
        const int dim = 2 + 2 * (round % 3), count = 1 + round % 10, history = round % 4;
        L1L2PathProblem *p = random_window(dim, count, history, 0.7, (uint64_t)round);
        L1L2PathQp *qp = l1l2_path_problem_as_qp_create(count, dim);
        l1l2_path_problem_as_qp_fill(p, qp);
        double q[10][L1L2_DIM], slack[180], dual[180][2] = {{0}}, constraint_dual[10][L1L2_PATH_CONSTRAINTS] = {{0}};
        double constant = 0.0;
        for (int t = 0; t < count; t++)
            for (int j = 0; j < dim; j++) {
                q[t][j] = p->camera[t][j] + uniform(&rng, -0.05, 0.05);
                constant += p->lambda[t] * p->camera[t][j] * p->camera[t][j];
            }
        const double(*cq)[L1L2_DIM] = (const double(*)[L1L2_DIM])q;
        for (int order = 1; order <= 3; order++)
            for (int i = 0; i < l1l2_path_terms(order, count, history); i++)
                for (int j = 0; j < dim; j++)
                    slack[l1l2_path_term_index(p, order, i, j)] = fabs(
                        l1l2_path_difference(p, cq, order, i + l1l2_path_first_term(order, history), j));
        double *z = calloc((size_t)qp->cols, sizeof *z), *y = calloc((size_t)qp->rows, sizeof *y);
        double *Az = calloc((size_t)qp->rows, sizeof *Az);
        const L1L2PathPoint point = {q, slack, dual, constraint_dual};
        l1l2_path_problem_as_qp_point(p, &point, z, y);
        double objective = constant;
        for (int c = 0; c < qp->cols; c++) {
            objective += 0.5 * qp->p[c] * z[c] * z[c] + qp->q[c] * z[c];
            for (int k = qp->start[c]; k < qp->start[c + 1]; k++)
                Az[qp->row[k]] += qp->value[k] * z[c];
        }
        ck_assert_near(objective, l1l2_path_objective(p, cq), 1e-12);
        double crop_worst = -1.0;
        const int first_crop = l1l2_path_qp_row_constraint(p, 0, 0);
        for (int r = 0; r < first_crop; r += 2) /* one side of each pair is active, none is violated */
            ck_assert_near(fmax(Az[r] - qp->upper[r], Az[r + 1] - qp->upper[r + 1]), 0.0, 1e-10);
        for (int r = first_crop; r < qp->rows; r++)
            crop_worst = fmax(crop_worst, fmax(Az[r] - qp->upper[r], qp->lower[r] - Az[r]));
        ck_assert_near(crop_worst, 3.0 * l1l2_path_excess(p, cq), 1e-10);
        free(z);
        free(y);
        free(Az);
        l1l2_path_qp_free(qp);
        l1l2_path_problem_free(p);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("problem_as_qp");
    TCase *tcase = tcase_create("problem_as_qp");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, every_column_and_row_has_one_place);
    tcase_add_test(tcase, terms_reach_no_further_back_than_the_history);
    tcase_add_test(tcase, columns_are_sorted_and_fit_the_arrays);
    tcase_add_test(tcase, the_program_has_the_objective_and_constraints_of_the_problem);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
