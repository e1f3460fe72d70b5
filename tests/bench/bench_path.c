/* SPDX-License-Identifier: MIT */
/*
 * The path solver alone, on shaky pans: ms a window for the predictor with its own certificate, with OSQP's check, and
 * for OSQP alone; by length of the window and number of parameters (2 translation, 4 similarity, 6 affine).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/clock.h"
#include "common/rng.h"
#include "path/solver.h"

enum { ROUNDS = 40 };

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* With 2 parameters the turn is left out of the same shake, with 6 there is a stretch and a skew besides. */
static void describe(L1L2PathProblem *p, int count, uint64_t seed)
{
    L1L2Rng rng = l1l2_rng_seeded(seed);
    const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, seed % 2 ? 0.8 : 0.9, p->dim);
    const double shake = (double)(1 + seed % 5) * 0.003;
    p->count = count;
    p->history = 3;
    for (int i = 0; i < L1L2_PATH_HISTORY; i++)
        p->past[i][0] = 0.001 * (i - 3), p->past[i][2] = 0.5;
    for (int t = 0; t < count; t++) {
        const double roll = uniform(&rng, -shake, shake);
        const double shake_x = uniform(&rng, -shake, shake);
        const double shake_y = uniform(&rng, -shake, shake);
        double q[L1L2_DIM] = {0.0015 * t + 0.03 * sin(t / 25.0) + shake_x,
                              0.02 * sin(t / 40.0) + shake_y, 0.5 * cos(roll), 0.5 * sin(roll)};
        if (p->dim == 6)
            q[4] = uniform(&rng, -0.3 * shake, 0.3 * shake), q[5] = uniform(&rng, -0.3 * shake, 0.3 * shake);
        const L1L2Mat camera = l1l2_mat_from_q(q, p->dim);
        l1l2_path_problem_set(p, t, &camera, 0.5, &crop);
    }
}

static int ascending(const void *a, const void *b)
{
    return *(const double *)a < *(const double *)b ? -1 : *(const double *)a > *(const double *)b;
}

static void bench(const char *name, int dim, int count, L1L2StabSolver choice, int rounds)
{
    L1L2PathProblem *p = l1l2_path_problem_create(count, dim);
    L1L2PathSolver *solver = l1l2_path_solver_create(count, dim);
    double(*q)[L1L2_DIM] = calloc((size_t)count, sizeof *q), ms[ROUNDS];
    int converged = 0, first = 0;
    for (int i = 0; i < rounds; i++) {
        describe(p, count, (uint64_t)i);
        const int64_t start_ns = l1l2_clock_ns();
        const L1L2PathSolverReport report = l1l2_path_solver_solve(solver, choice, p->count, p, q);
        ms[i] = 1e-6 * (double)(l1l2_clock_ns() - start_ns);
        converged += report.converged;
        first += report.osqp_iterations == 1;
    }
    qsort(ms, (size_t)rounds, sizeof *ms, ascending);
    printf("%-28s %d  %4d  %8.2f %8.2f   %3d/%-3d  %3d\n", name, dim, count, ms[rounds / 2], ms[rounds - 1], converged,
           rounds, first);
    fflush(stdout);
    l1l2_path_solver_free(solver);
    l1l2_path_problem_free(p);
    free(q);
}

int main(void)
{
    printf("                      parameters     N    median    worst   arrived  OSQP accepted at its first check\n");
    static const int counts[] = {30, 75, 150, 300, 450, 900};
    for (int dim = 2; dim <= 6; dim += 2)
        for (int i = 0; i < 6; i++)
            bench("predictor", dim, counts[i], L1L2STAB_SOLVER_PREDICTOR, ROUNDS);
    for (int dim = 2; dim <= 6; dim += 2)
        for (int i = 0; i < 6; i++)
            bench("predictor, checked by OSQP", dim, counts[i], L1L2STAB_SOLVER_CHECKED, ROUNDS);
    bench("OSQP alone", 4, 150, L1L2STAB_SOLVER_OSQP, 5);
    return EXIT_SUCCESS;
}
