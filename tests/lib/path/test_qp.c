/* SPDX-License-Identifier: MIT */
/* The interface to OSQP: a small program with a known solution, a bound on iterations, and allocations that fail. */
#include <string.h>

#include "checkx.h"
#include "memory_fixture.h"
#include "path/qp.h"

enum { SIZE = 12 };

static const L1L2PathQpSettings settings = {.max_iterations = 1000, .rho = 1.0, .tolerance = 1e-6};

/* Minimize sum (z_i - i)^2 with z_i + z_{i+1} <= 6: from z_3 on the rows are active. */
static L1L2PathQp *chain(void)
{
    L1L2PathQp *qp = l1l2_path_qp_create(SIZE, SIZE - 1, 2 * SIZE);
    ck_assert_ptr_nonnull(qp);
    qp->cols = SIZE, qp->rows = SIZE - 1;
    for (int i = 0; i < SIZE; i++) {
        qp->p[i] = 2.0;
        qp->q[i] = -2.0 * i;
        qp->start[i] = qp->entries;
        for (int row = i - 1; row <= i; row++)
            if (row >= 0 && row < qp->rows) {
                qp->row[qp->entries] = row;
                qp->value[qp->entries++] = 1.0;
            }
    }
    qp->start[SIZE] = qp->entries;
    for (int row = 0; row < qp->rows; row++)
        qp->lower[row] = -L1L2_PATH_QP_INFINITY, qp->upper[row] = 6.0;
    return qp;
}

START_TEST(the_solution_meets_the_conditions_of_an_optimum)
{
    L1L2PathQp *qp = chain();
    double z[SIZE] = {0.0}, y[SIZE] = {0.0};
    L1L2PathQpReport report;
    ck_assert_int_eq(l1l2_path_qp_solve(qp, &settings, z, y, &report), L1L2STAB_OK);
    ck_assert_msg(report.converged, "%d iterations, residuals %g and %g", report.iterations, report.primal_residual,
                  report.dual_residual);
    for (int i = 0; i < SIZE; i++) /* stationarity: 2 (z_i - i) + y_{i-1} + y_i = 0 */
        ck_assert_near(2.0 * (z[i] - i) + (i > 0 ? y[i - 1] : 0.0) + (i < SIZE - 1 ? y[i] : 0.0), 0.0, 1e-5);
    for (int row = 0; row < SIZE - 1; row++) {
        ck_assert_double_le(z[row] + z[row + 1], 6.0 + 1e-5);
        ck_assert_double_ge(y[row], -1e-6);
        ck_assert_near(y[row] * (z[row] + z[row + 1] - 6.0), 0.0, 1e-4);
    }
    l1l2_path_qp_free(qp);
}
END_TEST

START_TEST(a_solve_stops_at_its_bound_of_iterations)
{
    L1L2PathQp *qp = chain();
    double z[SIZE] = {0.0}, y[SIZE] = {0.0};
    L1L2PathQpSettings few = settings;
    few.max_iterations = 3;
    L1L2PathQpReport report;
    ck_assert_int_eq(l1l2_path_qp_solve(qp, &few, z, y, &report), L1L2STAB_OK);
    ck_assert(!report.converged);
    ck_assert_int_eq(report.iterations, 3);
    l1l2_path_qp_free(qp);
}
END_TEST

START_TEST(the_failure_of_any_allocation_is_reported_and_leaks_nothing)
{
    L1L2PathQp *qp = chain();
    L1L2PathQpReport report;
    L1L2StabResult result = L1L2STAB_ERR_NOMEM;
    int failures = 0;
    memory_fixture_begin();
    for (; result != L1L2STAB_OK; failures++) {
        double z[SIZE] = {0.0}, y[SIZE] = {0.0};
        ck_assert_int_lt(failures, 1000);
        memory_countdown = failures;
        result = l1l2_path_qp_solve(qp, &settings, z, y, &report);
        memory_countdown = -1;
        if (result != L1L2STAB_OK)
            ck_assert_int_eq(result, L1L2STAB_ERR_NOMEM);
        ck_assert_int_eq(memory_alive, 0);
    }
    memory_fixture_end();
    ck_assert_int_gt(report.iterations, 0);
    if (failures > 2) /* the bundled OSQP allocates through the hook; a system's has an allocator of its own */
        ck_assert_int_gt(failures, 40);
    l1l2_path_qp_free(qp);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("qp");
    TCase *tcase = tcase_create("qp");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_solution_meets_the_conditions_of_an_optimum);
    tcase_add_test(tcase, a_solve_stops_at_its_bound_of_iterations);
    tcase_add_test(tcase, the_failure_of_any_allocation_is_reported_and_leaks_nothing);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
