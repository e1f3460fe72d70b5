/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "common/cholesky.h"
#include "common/rng.h"

enum { MAX = 25 };

static double uniform(L1L2Rng *rng)
{
    return l1l2_rng_below(rng, 1u << 30) / (double)(1u << 29) - 1.0;
}

/* A = M M' + ridge I, with M random: symmetric positive definite. The upper triangle is NaN: it must not be read. */
static void random_system(L1L2Rng *rng, int size, double ridge, double A[MAX][MAX])
{
    double M[MAX][MAX];
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++)
            M[i][j] = uniform(rng);
    for (int i = 0; i < MAX; i++)
        for (int j = 0; j < MAX; j++) {
            A[i][j] = j <= i && i < size ? (i == j ? ridge : 0.0) : NAN;
            for (int k = 0; k < size && j <= i && i < size; k++)
                A[i][j] += M[i][k] * M[j][k];
        }
}

START_TEST(random_systems_of_every_size_are_solved)
{
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (int size = 0; size <= MAX; size++) {
        double A[MAX][MAX], L[MAX][MAX], truth[MAX], x[MAX];
        random_system(&rng, size, 0.1, A);
        memcpy(L, A, sizeof L);
        for (int i = 0; i < size; i++)
            truth[i] = uniform(&rng);
        for (int i = 0; i < size; i++) {
            x[i] = 0.0;
            for (int j = 0; j < size; j++)
                x[i] += (j <= i ? A[i][j] : A[j][i]) * truth[j];
        }
        ck_assert(l1l2_cholesky_factorize(&L[0][0], size, MAX));
        l1l2_cholesky_solve(&L[0][0], size, MAX, x);
        for (int i = 0; i < size; i++)
            ck_assert_near(x[i], truth[i], 1e-10);
    }
}
END_TEST

START_TEST(the_factor_times_its_transpose_is_the_matrix_and_the_upper_triangle_is_untouched)
{
    L1L2Rng rng = l1l2_rng_seeded(6);
    const int size = 12;
    double A[MAX][MAX], L[MAX][MAX];
    random_system(&rng, size, 0.0, A);
    memcpy(L, A, sizeof L);
    ck_assert(l1l2_cholesky_factorize(&L[0][0], size, MAX));
    for (int i = 0; i < size; i++)
        for (int j = 0; j < MAX; j++) {
            double sum = 0.0;
            for (int k = 0; k <= j && j <= i; k++)
                sum += L[i][k] * L[j][k];
            if (j <= i)
                ck_assert_near(sum, A[i][j], 1e-13);
            else
                ck_assert(isnan(L[i][j]));
        }
}
END_TEST

START_TEST(a_matrix_that_is_not_positive_definite_is_refused)
{
    double zero[1] = {0.0}, negative[1] = {-1.0};
    double singular[4] = {1.0, 0.0, 1.0, 1.0}, indefinite[4] = {1.0, 0.0, 2.0, 1.0};
    ck_assert(!l1l2_cholesky_factorize(zero, 1, 1));
    ck_assert(!l1l2_cholesky_factorize(negative, 1, 1));
    ck_assert(!l1l2_cholesky_factorize(singular, 2, 2));
    ck_assert(!l1l2_cholesky_factorize(indefinite, 2, 2));
}
END_TEST

START_TEST(an_element_that_is_not_finite_is_refused_wherever_it_is)
{
    const double wrong[] = {NAN, INFINITY, -INFINITY, 1e308 * 10.0};
    for (int w = 0; w < 4; w++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j <= i; j++) {
                double A[3][3] = {{2.0, 0.0, 0.0}, {0.5, 2.0, 0.0}, {0.5, 0.5, 2.0}};
                A[i][j] = wrong[w];
                ck_assert(!l1l2_cholesky_factorize(&A[0][0], 3, 3));
            }
}
END_TEST

/* The Hilbert matrix: condition number 1.6e13 for 10 rows. The residual is small though the solution is not exact. */
START_TEST(an_ill_conditioned_system_has_a_small_residual)
{
    enum { SIZE = 10 };
    double A[SIZE][SIZE], L[SIZE][SIZE], x[SIZE];
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
            A[i][j] = L[i][j] = 1.0 / (i + j + 1.0);
    for (int i = 0; i < SIZE; i++)
        x[i] = 1.0;
    ck_assert(l1l2_cholesky_factorize(&L[0][0], SIZE, SIZE));
    l1l2_cholesky_solve(&L[0][0], SIZE, SIZE, x);
    double largest = 0.0;
    for (int i = 0; i < SIZE; i++)
        largest = fmax(largest, fabs(x[i]));
    for (int i = 0; i < SIZE; i++) {
        double residual = -1.0;
        for (int j = 0; j < SIZE; j++)
            residual += A[i][j] * x[j];
        ck_assert_double_lt(fabs(residual), 1e-15 * SIZE * largest);
    }
}
END_TEST

START_TEST(numbers_of_very_different_size_are_no_obstacle)
{
    double A[2][2] = {{1e-200, 0.0}, {0.0, 1e200}}, x[2] = {1e-200, 3e200};
    ck_assert(l1l2_cholesky_factorize(&A[0][0], 2, 2));
    l1l2_cholesky_solve(&A[0][0], 2, 2, x);
    ck_assert_near(x[0], 1.0, 1e-12);
    ck_assert_near(x[1], 3.0, 1e-12);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cholesky");
    TCase *tcase = tcase_create("cholesky");
    tcase_add_test(tcase, random_systems_of_every_size_are_solved);
    tcase_add_test(tcase, the_factor_times_its_transpose_is_the_matrix_and_the_upper_triangle_is_untouched);
    tcase_add_test(tcase, a_matrix_that_is_not_positive_definite_is_refused);
    tcase_add_test(tcase, an_element_that_is_not_finite_is_refused_wherever_it_is);
    tcase_add_test(tcase, an_ill_conditioned_system_has_a_small_residual);
    tcase_add_test(tcase, numbers_of_very_different_size_are_no_obstacle);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
