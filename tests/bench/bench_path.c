/* SPDX-License-Identifier: MIT */
/*
 * The time of the path solver alone, in ms of processor time for each window.
 *
 * Shaky pans: the predictor with its own certificate, with OSQP's check, and OSQP alone, by the length of the window
 * and the number of parameters (2 translation, 4 similarity, 6 affine).
 * A zoom of 1.5 a frame, on which nothing converges at N >= 150: the bound on the work, for windows that emit a third
 * of their frames and for windows that slide by one frame.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "common/rng.h"
#include "path/solver.h"

enum { ROUNDS = 40 };

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* The same shake for each model: with 2 parameters it has no turn, with 6 it also has stretch and skew. */
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

/* A zoom of 1.5 a frame: C_t leaves the range in which double precision suffices. */
static void describe_zoom(L1L2PathProblem *p, int count)
{
    const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, 0.9, p->dim);
    p->count = count;
    p->history = 0;
    for (int t = 0; t < count; t++) {
        const double zoom = pow(1.5, t);
        const L1L2Mat camera = l1l2_mat_similarity(zoom, 0.0, 0.0, 0.0);
        l1l2_path_problem_set(p, t, &camera, 0.5, &crop);
    }
}

static double processor_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
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
        const double start_ms = processor_ms();
        const L1L2PathSolverReport report = l1l2_path_solver_solve(solver, choice, p->count, p, q);
        ms[i] = processor_ms() - start_ms;
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

static void bench_divergence(int count, int emitted)
{
    L1L2PathProblem *p = l1l2_path_problem_create(count, 4);
    L1L2PathSolver *solver = l1l2_path_solver_create(count, 4);
    double(*q)[L1L2_DIM] = calloc((size_t)count, sizeof *q);
    describe_zoom(p, count);
    const double start_ms = processor_ms();
    const L1L2PathSolverReport report = l1l2_path_solver_solve(solver, L1L2STAB_SOLVER_AUTO, emitted, p, q);
    printf("zoom of 1.5 a frame, N = %3d, %3d emitted: %8.2f ms, %2d + %4d iterations, %s\n", count, emitted,
           processor_ms() - start_ms, report.predictor_iterations, report.osqp_iterations,
           report.converged ? "converged" : "did not converge");
    l1l2_path_solver_free(solver);
    l1l2_path_problem_free(p);
    free(q);
}

int main(void)
{
    printf("                      parameters     N    median    worst   converged  OSQP accepted at its first test\n");
    static const int counts[] = {30, 75, 150, 300, 450, 900};
    for (int dim = 2; dim <= 6; dim += 2)
        for (int i = 0; i < 6; i++)
            bench("predictor", dim, counts[i], L1L2STAB_SOLVER_PREDICTOR, ROUNDS);
    for (int dim = 2; dim <= 6; dim += 2)
        for (int i = 0; i < 6; i++)
            bench("predictor, checked by OSQP", dim, counts[i], L1L2STAB_SOLVER_CHECKED, ROUNDS);
    bench("OSQP alone", 4, 150, L1L2STAB_SOLVER_OSQP, 5);
    static const int lengths[] = {30, 75, 150, 300, 900};
    for (int i = 0; i < 5; i++) {
        bench_divergence(lengths[i], lengths[i] / 3);
        bench_divergence(lengths[i], 1);
    }
    return EXIT_SUCCESS;
}
