/* SPDX-License-Identifier: MIT */
/* The optimum, compared with its conditions (KKT) and with the independent solutions of tests/reference/windows.txt. */
#include <stdio.h>
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "path/interior_point.h"
#include "path/solver.h"

enum { MAX_COUNT = 160 };

typedef struct Window {
    char name[64];
    int dim, count, history; /* dim: of the motion model, and of its maps' parameters */
    double crop, past[3][L1L2_DIM], motion[MAX_COUNT][L1L2_DIM];
    double step[2 + MAX_COUNT]; /* to frame -2, -1, 0, ... */
    int width, height;
} Window;

/* x y; a b x y of [a -b x; b a y]; a b c d x y of [a b x; c d y]. */
static L1L2Mat mat(int dim, const double p[L1L2_DIM])
{
    if (dim == 2)
        return l1l2_mat_translation(p[0], p[1]);
    if (dim == 4)
        return l1l2_mat_similarity(p[0], p[1], p[2], p[3]);
    return (L1L2Mat){{p[0], p[1], p[4], p[2], p[3], p[5], 0.0, 0.0, 1.0}};
}

static void describe(const Window *w, double lambda, L1L2PathProblem *p)
{
    const L1L2PathCropWindow crop = l1l2_path_crop_window(w->width, w->height, w->crop, w->dim);
    L1L2Mat camera = l1l2_mat_identity();
    p->dim = w->dim;
    p->rows = l1l2_path_constraint_count(w->dim);
    p->count = w->count;
    p->history = w->history;
    for (int i = 0; i < w->history; i++) {
        const L1L2Mat past = mat(w->dim, w->past[i]);
        l1l2_mat_to_q(&past, p->past[L1L2_PATH_HISTORY - w->history + i]);
    }
    for (int t = 0; t < w->count; t++) {
        if (t > 0)
            camera = l1l2_mat_mul(camera, mat(w->dim, w->motion[t]));
        const double *h = &w->step[2 + t];
        const double before = t > 0 || w->history > 0 ? h[0] : 1.0, after = t + 1 < w->count ? h[1] : 1.0;
        l1l2_path_problem_set(p, t, &camera, 0.5 * lambda * (before + after), &crop);
        l1l2_path_problem_set_steps(p, t, (double[]){h[0], h[-1], h[-2]});
    }
}

static void space_evenly(Window *w)
{
    for (int i = 0; i < 2 + MAX_COUNT; i++)
        w->step[i] = 1.0;
}

static bool read_map(FILE *file, int dim, double v[L1L2_DIM])
{
    for (int j = 0; j < dim; j++)
        if (fscanf(file, "%lf", &v[j]) != 1)
            return false;
    return true;
}

/* Reads the next window's motions. The next line of the file is then the first "lambda". */
static bool read_window(FILE *file, Window *w)
{
    char word[16];
    if (fscanf(file, "%15s %d %d %d %lf %d %d %63s", word, &w->dim, &w->count, &w->history, &w->crop, &w->width,
               &w->height, w->name) != 8)
        return false;
    ck_assert_str_eq(word, "window");
    ck_assert_int_le(w->count, MAX_COUNT);
    for (int i = 0; i < w->history; i++)
        ck_assert(fscanf(file, "%15s", word) == 1 && strcmp(word, "past") == 0 && read_map(file, w->dim, w->past[i]));
    space_evenly(w);
    ck_assert_int_eq(fscanf(file, "%15s", word), 1);
    for (int i = 0; strcmp(word, "step") == 0; i++) {
        ck_assert_int_lt(i, 2 + w->count);
        ck_assert_int_eq(fscanf(file, "%lf %15s", &w->step[i], word), 2);
    }
    for (int t = 0; t < w->count; t++) {
        if (t > 0)
            ck_assert_int_eq(fscanf(file, "%15s", word), 1);
        ck_assert(strcmp(word, "F") == 0 && read_map(file, w->dim, w->motion[t]));
    }
    return true;
}

/* Corners of the crop window under two paths, px at 1920x1080's diagonal. */
static double corner_distance_px(const Window *w, const double q[L1L2_DIM], const L1L2Mat *expected)
{
    const L1L2PathCropWindow crop = l1l2_path_crop_window(w->width, w->height, w->crop, w->dim);
    const L1L2Mat found = l1l2_mat_from_q(q, w->dim);
    return hypot(1920, 1080) *
           l1l2_mat_corner_distance(&found, expected, w->crop * crop.half_w, w->crop * crop.half_h);
}

/* least: how many windows of translations, similarities and affine maps the file must have at least. */
static void against_the_reference(const char *path, L1L2StabSolver choice, int lambdas, const int least[3],
                                  double relative, double corner_px)
{
    FILE *file = fopen(path, "r");
    ck_assert_ptr_nonnull(file);
    L1L2PathProblem *p = l1l2_path_problem_create(MAX_COUNT, L1L2_DIM);
    L1L2PathSolver *solver[3];
    for (int i = 0; i < 3; i++)
        solver[i] = l1l2_path_solver_create(MAX_COUNT, 2 + 2 * i);
    static double q[MAX_COUNT][L1L2_DIM];
    Window w;
    int windows[3] = {0}, at_first_check = 0, checked = 0;
    for (; read_window(file, &w); windows[w.dim / 2 - 1]++)
        for (int i = 0; i < lambdas; i++) {
            double lambda, objective, map[L1L2_DIM];
            int t;
            ck_assert_int_eq(fscanf(file, " lambda %lf %lf", &lambda, &objective), 2);
            describe(&w, lambda, p);
            const L1L2PathSolverReport report = l1l2_path_solver_solve(solver[w.dim / 2 - 1], choice, p->count, p, q);
            const double found = l1l2_path_objective(p, (const double(*)[L1L2_DIM])q);
            ck_assert_msg(report.converged, "%s, lambda %g: not converged, bound %g", w.name, lambda, report.bound);
            ck_assert_msg(fabs(found - objective) <= relative * objective + 1e-9,
                          "%s, lambda %g: objective %.12g, reference %.12g", w.name, lambda, found, objective);
            ck_assert_msg(report.excess <= 1e-6, "%s, lambda %g: a constraint is violated by %g", w.name, lambda,
                          report.excess);
            while (fscanf(file, " P %d", &t) == 1 && read_map(file, w.dim, map)) {
                const L1L2Mat expected = mat(w.dim, map);
                const double distance = corner_distance_px(&w, q[t], &expected);
                ck_assert_msg(distance <= corner_px, "%s, lambda %g, frame %d: corners %g px off", w.name, lambda, t,
                              distance);
            }
            checked++;
            at_first_check += report.osqp_iterations == 1;
        }
    fclose(file);
    printf("windows of translations, similarities, affine maps: %d, %d, %d, x %d lambdas; OSQP accepted at its first "
           "test: %d of %d\n", windows[0], windows[1], windows[2], lambdas, at_first_check, checked);
    ck_assert(windows[0] >= least[0] && windows[1] >= least[1] && windows[2] >= least[2]);
    if (choice == L1L2STAB_SOLVER_CHECKED && strcmp(path, REFERENCE_WINDOWS) == 0)
        ck_assert_int_ge(100 * at_first_check, 95 * checked);
    for (int i = 0; i < 3; i++)
        l1l2_path_solver_free(solver[i]);
    l1l2_path_problem_free(p);
}

START_TEST(the_checked_predictor_finds_the_reference_optimum)
{
    against_the_reference(REFERENCE_WINDOWS, L1L2STAB_SOLVER_CHECKED, 8, (int[]){5, 40, 10}, 1e-7, 0.01);
}
END_TEST

START_TEST(the_predictor_alone_finds_the_reference_optimum)
{
    against_the_reference(REFERENCE_WINDOWS, L1L2STAB_SOLVER_PREDICTOR, 8, (int[]){5, 40, 10}, 1e-7, 0.01);
}
END_TEST

START_TEST(the_checked_predictor_finds_the_reference_optimum_of_uneven_steps)
{
    against_the_reference(REFERENCE_WINDOWS_UNEVEN, L1L2STAB_SOLVER_CHECKED, 4, (int[]){3, 8, 3}, 1e-7, 0.01);
}
END_TEST

static void random_walk(Window *w, int dim, uint64_t seed, int count, int history, double shake)
{
    static const double still[3][L1L2_DIM] = {{0, 0}, {1, 0, 0, 0}, {1, 0, 0, 1, 0, 0}};
    L1L2Rng rng = l1l2_rng_seeded(seed);
    *w = (Window){.dim = dim, .count = count, .history = history, .crop = 0.8, .width = 640, .height = 360};
    space_evenly(w);
    for (int t = 0; t < count; t++)
        for (int j = 0; j < dim; j++)
            w->motion[t][j] = still[dim / 2 - 1][j] + shake * (l1l2_rng_next(&rng) / 2147483648.0 - 1.0);
    for (int i = 0; i < history; i++) {
        memcpy(w->past[i], still[dim / 2 - 1], sizeof w->past[i]);
        w->past[i][dim - 2] = 0.002 * i;
    }
}

/* The conditions of an optimum, each checked from the problem's definition. */
static void check_kkt(const L1L2PathProblem *p, const L1L2PathPoint *point)
{
    const double(*q)[L1L2_DIM] = (const double(*)[L1L2_DIM])point->q;
    static double force[MAX_COUNT][L1L2_DIM];
    ck_assert(l1l2_path_excess(p, q) <= 1e-12);
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            force[t][j] = 2.0 * p->lambda[t] * (q[t][j] - p->camera[t][j]);
    for (int order = 1; order <= 3; order++)
        for (int i = 0; i < l1l2_path_terms(order, p->count, p->history); i++)
            for (int j = 0; j < p->dim; j++) {
                const int t = i + l1l2_path_first_term(order, p->history);
                const double *y = point->term_dual[l1l2_path_term_index(p, order, i, j)];
                const double d = l1l2_path_difference(p, q, order, t, j);
                ck_assert(y[0] >= 0.0 && y[1] >= 0.0);
                ck_assert_near(y[0] + y[1], p->weight[order - 1], 1e-9);
                ck_assert_near((y[0] - y[1]) * d, p->weight[order - 1] * fabs(d), 1e-8); /* a subgradient of |d| */
                for (int m = 0; m <= order && m <= t; m++)
                    force[t - m][j] += (y[0] - y[1]) * p->difference[t][order - 1][m];
            }
    for (int t = 0; t < p->count; t++)
        for (int r = 0; r < p->rows; r++) {
            const double y = point->constraint_dual[t][r];
            double v = 0.0;
            for (int j = 0; j < p->dim; j++) {
                v += p->G[t][r][j] * q[t][j];
                force[t][j] += y * p->G[t][r][j];
            }
            ck_assert_near(y > 0.0 ? y * (p->hi[t][r] - v) : y * (p->lo[t][r] - v), 0.0, 1e-8);
        }
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < p->dim; j++)
            ck_assert_near(force[t][j], 0.0, 1e-5);
}

START_TEST(the_predictor_meets_the_conditions_of_an_optimum)
{
    static const double shakes[] = {0.0, 0.001, 0.01, 0.05, 0.3}, lambdas[] = {0.0, 0.01, 0.5, 100.0};
    L1L2PathProblem *p = l1l2_path_problem_create(MAX_COUNT, L1L2_DIM);
    L1L2PathInteriorPoint *ipm = l1l2_path_interior_point_create(MAX_COUNT, L1L2_DIM);
    L1L2PathPoint point;
    Window w;
    for (int i = 0; i < 240; i++) {
        const int counts[] = {1, 2, 3, 4, 7, 30, 150}, dim = 2 + 2 * (i / 80), round = i % 80;
        random_walk(&w, dim, (uint64_t)round, counts[round % 7], round % 4, shakes[round % 5]);
        describe(&w, lambdas[round / 20], p);
        const L1L2PathInteriorPointReport report = l1l2_path_interior_point_solve(ipm, p, &point);
        ck_assert_msg(report.converged, "%d parameters, round %d: bound %g after %d iterations", dim, round,
                      report.bound, report.iterations);
        check_kkt(p, &point);
    }
    l1l2_path_interior_point_free(ipm);
    l1l2_path_problem_free(p);
}
END_TEST

START_TEST(the_predictor_meets_the_conditions_of_an_optimum_of_uneven_steps)
{
    L1L2PathProblem *p = l1l2_path_problem_create(MAX_COUNT, L1L2_DIM);
    L1L2PathInteriorPoint *ipm = l1l2_path_interior_point_create(MAX_COUNT, L1L2_DIM);
    L1L2PathPoint point;
    Window w;
    for (int i = 0; i < 60; i++) {
        const int counts[] = {1, 2, 3, 4, 7, 30, 150}, dim = 2 + 2 * (i / 20);
        L1L2Rng rng = l1l2_rng_seeded((uint64_t)i);
        random_walk(&w, dim, (uint64_t)i, counts[i % 7], i % 4, i % 2 ? 0.05 : 0.005);
        for (int t = 0; t < 2 + w.count; t++)
            w.step[t] = pow(4.0, l1l2_rng_next(&rng) / 2147483648.0 - 1.0);
        describe(&w, i % 3 ? 0.5 : 0.01, p);
        const L1L2PathInteriorPointReport report = l1l2_path_interior_point_solve(ipm, p, &point);
        ck_assert_msg(report.converged, "%d parameters, round %d: bound %g after %d iterations", dim, i, report.bound,
                      report.iterations);
        check_kkt(p, &point);
    }
    l1l2_path_interior_point_free(ipm);
    l1l2_path_problem_free(p);
}
END_TEST

START_TEST(osqp_alone_comes_near_the_optimum)
{
    L1L2PathProblem *p = l1l2_path_problem_create(MAX_COUNT, 4);
    L1L2PathSolver *solver = l1l2_path_solver_create(MAX_COUNT, 4);
    static double q[MAX_COUNT][L1L2_DIM], best[MAX_COUNT][L1L2_DIM];
    Window w;
    for (int round = 0; round < 4; round++) {
        random_walk(&w, 4, (uint64_t)round, 40, round, 0.01);
        describe(&w, 0.5, p);
        ck_assert(l1l2_path_solver_solve(solver, L1L2STAB_SOLVER_CHECKED, p->count, p, best).converged);
        const L1L2PathSolverReport report = l1l2_path_solver_solve(solver, L1L2STAB_SOLVER_OSQP, p->count, p, q);
        ck_assert_int_eq(report.decided_by, L1L2STAB_SOLVER_OSQP);
        ck_assert_near(l1l2_path_objective(p, (const double(*)[L1L2_DIM])q) /
                           l1l2_path_objective(p, (const double(*)[L1L2_DIM])best), 1.0, 1e-3);
    }
    l1l2_path_solver_free(solver);
    l1l2_path_problem_free(p);
}
END_TEST

START_TEST(the_same_window_gives_the_same_bits)
{
    L1L2PathProblem *p = l1l2_path_problem_create(MAX_COUNT, 4);
    L1L2PathSolver *a = l1l2_path_solver_create(MAX_COUNT, 4);
    L1L2PathSolver *b = l1l2_path_solver_create(MAX_COUNT, 4);
    static double first[MAX_COUNT][L1L2_DIM], second[MAX_COUNT][L1L2_DIM];
    Window w;
    for (int round = 0; round < 6; round++) { /* b has solved other windows before */
        random_walk(&w, 4, (uint64_t)(round % 3), 150, 3, 0.02);
        describe(&w, 0.5, p);
        l1l2_path_solver_solve(b, L1L2STAB_SOLVER_CHECKED, p->count, p, second);
        if (round < 3)
            continue;
        l1l2_path_solver_solve(a, L1L2STAB_SOLVER_CHECKED, p->count, p, first);
        ck_assert_mem_eq(first, second, sizeof(double) * 150 * L1L2_DIM);
    }
    l1l2_path_solver_free(a);
    l1l2_path_solver_free(b);
    l1l2_path_problem_free(p);
}
END_TEST

static double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* A shaky pan of 900 frames. */
static void describe_long(L1L2PathProblem *p, uint64_t seed)
{
    L1L2Rng rng = l1l2_rng_seeded(seed);
    const L1L2PathCropWindow crop = l1l2_path_crop_window(640, 360, 0.9, p->dim);
    p->count = 900;
    p->history = 3;
    for (int i = 0; i < L1L2_PATH_HISTORY; i++)
        p->past[i][0] = 0.001 * (i - 3), p->past[i][2] = 0.5;
    for (int t = 0; t < p->count; t++) {
        const double roll = uniform(&rng, -0.012, 0.012);
        const double shake_x = uniform(&rng, -0.012, 0.012);
        const double shake_y = uniform(&rng, -0.012, 0.012);
        const double q[L1L2_DIM] = {0.0015 * t + 0.03 * sin(t / 25.0) + shake_x,
                                    0.02 * sin(t / 40.0) + shake_y, 0.5 * cos(roll),
                                    0.5 * sin(roll)};
        const L1L2Mat camera = l1l2_mat_from_q(q, p->dim);
        l1l2_path_problem_set(p, t, &camera, 0.5, &crop);
    }
}

/* Near the limit of double precision the last step of a long window may not be finite. The next window must not see
 * it. */
START_TEST(a_window_does_not_depend_on_how_the_window_before_it_ended)
{
    L1L2PathProblem *p = l1l2_path_problem_create(900, 4);
    L1L2PathInteriorPoint *fresh = l1l2_path_interior_point_create(900, 4),
                          *used = l1l2_path_interior_point_create(900, 4);
    L1L2PathPoint a, b;
    describe_long(p, 3);
    ck_assert(l1l2_path_interior_point_solve(fresh, p, &a).converged);
    for (uint64_t seed = 0; seed < 10; seed++) {
        describe_long(p, seed);
        ck_assert(l1l2_path_interior_point_solve(used, p, &b).converged);
    }
    describe_long(p, 3);
    ck_assert(l1l2_path_interior_point_solve(used, p, &b).converged);
    ck_assert_mem_eq(a.q, b.q, 900 * sizeof *a.q);
    l1l2_path_interior_point_free(fresh);
    l1l2_path_interior_point_free(used);
    l1l2_path_problem_free(p);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("solver");
    TCase *tcase = tcase_create("solver");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_checked_predictor_finds_the_reference_optimum);
    tcase_add_test(tcase, the_predictor_alone_finds_the_reference_optimum);
    tcase_add_test(tcase, the_predictor_meets_the_conditions_of_an_optimum);
    tcase_add_test(tcase, the_predictor_meets_the_conditions_of_an_optimum_of_uneven_steps);
    tcase_add_test(tcase, the_checked_predictor_finds_the_reference_optimum_of_uneven_steps);
    tcase_add_test(tcase, osqp_alone_comes_near_the_optimum);
    tcase_add_test(tcase, the_same_window_gives_the_same_bits);
    tcase_add_test(tcase, a_window_does_not_depend_on_how_the_window_before_it_ended);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
