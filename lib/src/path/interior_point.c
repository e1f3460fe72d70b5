/* SPDX-License-Identifier: MIT */
/*
 * Derivation.
 *
 * Inequalities come in pairs around one linear form v = g'q of the path. A pair has slacks s0, s1 > 0 and duals y0,
 * y1 > 0.
 *   Term:        v = D^k q (one component), with a slack variable e >= |v|.    s0 = e - v,    s1 = e + v
 *   Constraint:  v = G q (one row).                                            s0 = hi - v,   s1 = v - lo
 *
 * Optimality (KKT):
 *   in q         r := 2 lambda (q - c) + sum over all pairs (y0 - y1) g = 0                       [stationarity]
 *   in e         y0 + y1 = w_k for each term                                                      [kept from the start]
 *   in the rows  s0 y0 = s1 y1 = 0 for each pair                                                  [complementarity]
 *
 * Newton's step replaces the right-hand side of complementarity by a target, s y + s dy + y ds = mu - (second order).
 * Let a = mu - second order - s y, which `dy` holds until the step is known (aim()), and d = y/s. Then for each side
 *   dy = a/s - d ds.                                                                              (1)
 *
 * Constraint. ds0 = -dv and ds1 = dv. By (1), dy0 - dy1 = (a0/s0 - a1/s1) + (d0 + d1) dv. So the pair adds the weight
 * d0 + d1 to g g' in the system, and a0/s0 - a1/s1 to the force (crop_force()).
 *
 * Term. ds0 = de - dv and ds1 = de + dv. Both terms' duals keep their sum, dy0 + dy1 = 0. Inserting (1) gives
 *   a0/s0 + a1/s1 = d0 (de - dv) + d1 (de + dv), so
 *   de = (T + (d0 - d1) dv) / (d0 + d1)      with T = a0/s0 + a1/s1.
 * Then ds0 = de - dv = (T - 2 d1 dv) / (d0 + d1) and ds1 = de + dv = (T + 2 d0 dv) / (d0 + d1): move_term(). Written
 * so, nothing cancels where one side's d is far larger than the other's, as it is near the optimum. The force is
 *   dy0 - dy1 = a0/s0 - a1/s1 - d0 ds0 + d1 ds1
 *             = 2 (d1 a0/s0 - d0 a1/s1) / (d0 + d1)  +  4 d0 d1 / (d0 + d1) dv.
 * So the pair adds the weight 4 d0 d1 / (d0 + d1) to g g' (assemble()), and the first summand to the force
 * (term_force()). The weight is twice the harmonic mean of the two d: it vanishes with either, which is right, since e
 * can give way as long as one side is slack.
 *
 * System. Stationarity after the step, r + dr = 0, is (2 lambda + sum of weight g g') dq = -(r + sum of force g). A
 * form reaches the frames t-3 to t, so the matrix has a half-bandwidth of 4 dim - 1, and its LDL' factorization has no
 * fill outside the band.
 *
 * Predictor and corrector (Mehrotra). The affine step aims at mu = 0. Let it reach the gap left' along the longest step
 * that keeps all s and y >= 0. The corrector then solves with the same factors, for mu = (left'/gap)^3 gap / sides, and
 * with the affine step's own product ds dy as the second-order term. It goes 0.995 of the way to the nearest bound.
 *
 * Certificate. The Lagrangian at the iterate's duals is convex in (q, e), and its gradient there is r in q and 0 in e.
 * Its value is the objective less the gap, the sum of all s y. If r were 0 it would be minimal, so the gap would bound
 * the distance from the optimum. With r /= 0 its minimum is lower by at most the sum over components of r^2/(4 lambda),
 * by the strong convexity of the L2 term. It is also lower by at most |r|_1 within the feasible set, where any two
 * values of a component differ by less than a diagonal. The smaller of the two is added (stationarity()).
 */
#include "path/interior_point.h"

#include <math.h>
#include <string.h>

#include "common/mem.h"
#include "path/banded_ldl.h"

/*
 * Parameters
 *
 * name             value  unit        effect, and what chose the value
 * ---------------  -----  ----------  --------------------------------------------------------------------------------
 * initial_slack    1e-2   diagonals   Distance of e from |v| at the start: the size of a shake.
 * step_fraction    0.995  -           Part of the way to the nearest bound that a step goes: less than 1.
 * bound_goal       1e-13  objective   Stop below this bound: objectives are 0.01 to 10, and doubles give nothing more.
 * enough_absolute  1e-9   objective   A bound below enough_absolute + enough_relative * objective is converged. That
 * enough_relative  1e-7   -           keeps corners within 0.01 px of the reference at 1920x1080 (test_solver).
 * max_iterations   60     iterations  15 to 25 are usual (docs/path.md). It bounds the work of a solve.
 * patience         2      iterations  How many in a row may be no better than the best before the method stops. Near
 *                                     the limit of double precision iterates get worse again.
 */
static const double initial_slack = 1e-2;
static const double step_fraction = 0.995;
static const double bound_goal = 1e-13;
static const double enough_absolute = 1e-9, enough_relative = 1e-7;
static const int max_iterations = 60, patience = 2;

/* Two inequalities around one linear form v: their slacks s > 0 and their duals y > 0. Side 0 bounds v from above. */
typedef struct Pair {
    double s[2], y[2], ds[2], dy[2];
    double dv; /* step of v */
} Pair;

/* d: components of q. */
struct L1L2PathInteriorPoint {
    Pair *term, *crop;      /* by l1l2_path_term_index(); by rows t + r */
    double *band;           /* d n columns of band_of(d): the system, then its factors */
    double *rhs;            /* d n: right-hand side, then the step in q */
    double *gradient;       /* d n: stationarity in q at the iterate */
    double *diagonal;       /* d n: of the system before its factorization */
    double (*q)[L1L2_DIM], (*best_q)[L1L2_DIM];
    double *slack;
    double (*term_dual)[2];
    double (*constraint_dual)[L1L2_PATH_CONSTRAINTS];
    int terms, crops;       /* pairs in use */
};

/* The diagonal and what is below it: a third difference reaches three frames. */
L1L2_INLINE int band_of(const int dim)
{
    return dim * (L1L2_PATH_HISTORY + 1);
}

L1L2PathInteriorPoint *l1l2_path_interior_point_create(int capacity, int dim)
{
    const size_t n = (size_t)capacity, size = n * (size_t)dim, terms = size * L1L2_PATH_ORDERS;
    L1L2PathInteriorPoint *ipm = l1l2_mem_new(1, sizeof *ipm);
    if (!ipm)
        return NULL;
    ipm->term = l1l2_mem_new(terms, sizeof *ipm->term);
    ipm->crop = l1l2_mem_new(n * (size_t)l1l2_path_constraint_count(dim), sizeof *ipm->crop);
    ipm->band = l1l2_mem_new(size, (size_t)band_of(dim) * sizeof *ipm->band);
    ipm->rhs = l1l2_mem_new(size, sizeof *ipm->rhs);
    ipm->gradient = l1l2_mem_new(size, sizeof *ipm->gradient);
    ipm->diagonal = l1l2_mem_new(size, sizeof *ipm->diagonal);
    ipm->q = l1l2_mem_new(n, sizeof *ipm->q);
    ipm->best_q = l1l2_mem_new(n, sizeof *ipm->best_q);
    ipm->slack = l1l2_mem_new(terms, sizeof *ipm->slack);
    ipm->term_dual = l1l2_mem_new(terms, sizeof *ipm->term_dual);
    ipm->constraint_dual = l1l2_mem_new(n, sizeof *ipm->constraint_dual);
    if (ipm->term && ipm->crop && ipm->band && ipm->rhs && ipm->gradient && ipm->diagonal && ipm->q && ipm->best_q &&
        ipm->slack && ipm->term_dual && ipm->constraint_dual)
        return ipm;
    l1l2_path_interior_point_free(ipm);
    return NULL;
}

void l1l2_path_interior_point_free(L1L2PathInteriorPoint *ipm)
{
    if (!ipm)
        return;
    l1l2_mem_free(ipm->term);
    l1l2_mem_free(ipm->crop);
    l1l2_mem_free(ipm->band);
    l1l2_mem_free(ipm->rhs);
    l1l2_mem_free(ipm->gradient);
    l1l2_mem_free(ipm->diagonal);
    l1l2_mem_free(ipm->q);
    l1l2_mem_free(ipm->best_q);
    l1l2_mem_free(ipm->slack);
    l1l2_mem_free(ipm->term_dual);
    l1l2_mem_free(ipm->constraint_dual);
    l1l2_mem_free(ipm);
}

/* A strictly feasible start: q = c and e = |D c| + initial_slack. Each dual of a term is half its weight, so that their
 * sum is the weight from here on. The duals of the constraints are such that all products s y are equal. */
L1L2_INLINE void start(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, const int dim)
{
    const int n = p->count;
    memcpy(ipm->q, p->camera, (size_t)n * sizeof *ipm->q);
    ipm->terms = l1l2_path_term_components(p);
    ipm->crops = p->rows * n;
    Pair *pair = ipm->term;
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int t = l1l2_path_first_term(order, p->history); t < n; t++)
            for (int j = 0; j < dim; j++, pair++) {
                const double v = l1l2_path_difference(p, (const double(*)[L1L2_DIM])ipm->q, order, t, j);
                *pair = (Pair){.dv = 0.0}; /* a step that was not finite is not carried into the next window */
                pair->s[0] = fabs(v) + initial_slack - v;
                pair->s[1] = fabs(v) + initial_slack + v;
                pair->y[0] = pair->y[1] = 0.5 * p->weight[order - 1];
            }
    pair = ipm->crop;
    for (int t = 0; t < n; t++)
        for (int r = 0; r < p->rows; r++, pair++) {
            double v = 0.0;
            for (int j = 0; j < dim; j++)
                v += p->G[t][r][j] * ipm->q[t][j];
            *pair = (Pair){.dv = 0.0};
            pair->s[0] = p->hi[t][r] - v;
            pair->s[1] = v - p->lo[t][r];
            for (int side = 0; side < 2; side++)
                pair->y[side] = 0.1 * initial_slack / pair->s[side];
        }
}

/* rhs += sum over pairs of value(pair) * gradient of its form. */
L1L2_INLINE void add_gradients(const L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p,
                               double (*term_value)(const Pair *), double (*crop_value)(const Pair *), double *rhs,
                               const int dim)
{
    const Pair *pair = ipm->term;
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int t = l1l2_path_first_term(order, p->history); t < p->count; t++)
            for (int j = 0; j < dim; j++, pair++) {
                const double v = term_value(pair);
                for (int m = 0; m <= order && m <= t; m++)
                    rhs[dim * (t - m) + j] += v * p->difference[t][order - 1][m];
            }
    pair = ipm->crop;
    for (int t = 0; t < p->count; t++)
        for (int r = 0; r < p->rows; r++, pair++) {
            const double v = crop_value(pair);
            for (int j = 0; j < dim; j++)
                rhs[dim * t + j] += v * p->G[t][r][j];
        }
}

static double dual_force(const Pair *pair)
{
    return pair->y[0] - pair->y[1];
}

/* The residual of stationarity, into r. Returns what r adds to the gap in the certificate, see above. */
L1L2_INLINE double stationarity(const L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, double *r,
                                const int dim)
{
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < dim; j++)
            r[dim * t + j] = 2.0 * p->lambda[t] * (ipm->q[t][j] - p->camera[t][j]);
    add_gradients(ipm, p, dual_force, dual_force, r, dim);
    double bound = 0.0;
    for (int i = 0; i < dim * p->count; i++) {
        const double linear = fabs(r[i]), lambda = p->lambda[i / dim];
        bound += linear < 4.0 * lambda ? linear * linear / (4.0 * lambda) : linear;
    }
    return bound;
}

/* The system in q after all slacks and duals are eliminated. */
L1L2_INLINE void assemble(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, const int dim)
{
    const int n = p->count, band = band_of(dim);
    double *system = ipm->band;
    memset(system, 0, (size_t)(dim * n * band) * sizeof *system);
    for (int t = 0; t < n; t++)
        for (int j = 0; j < dim; j++)
            system[(dim * t + j) * band] = 2.0 * p->lambda[t];
    const Pair *pair = ipm->term;
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int t = l1l2_path_first_term(order, p->history); t < n; t++)
            for (int j = 0; j < dim; j++, pair++) {
                const double d0 = pair->y[0] / pair->s[0], d1 = pair->y[1] / pair->s[1];
                const double weight = 4.0 * d0 * d1 / (d0 + d1);
                const double *c = p->difference[t][order - 1];
                for (int a = 0; a <= order && a <= t; a++)     /* frame t - a, the earlier one, is the column */
                    for (int b = 0; b <= a; b++)
                        system[(dim * (t - a) + j) * band + dim * (a - b)] += weight * c[a] * c[b];
            }
    pair = ipm->crop;
    for (int t = 0; t < n; t++)
        for (int r = 0; r < p->rows; r++, pair++) {
            const double *g = p->G[t][r];
            const double weight = pair->y[0] / pair->s[0] + pair->y[1] / pair->s[1];
            for (int a = 0; a < dim; a++)
                for (int b = a; b < dim; b++)
                    system[(dim * t + a) * band + b - a] += weight * g[a] * g[b];
        }
}

/* a = mu - second order - s y of each side, into dy. corrector: s and y steps of the affine step are in ds and dy. */
static void aim(Pair *pair, int count, double mu, bool corrector)
{
    for (int i = 0; i < count; i++)
        for (int side = 0; side < 2; side++) {
            const double second = corrector ? pair[i].ds[side] * pair[i].dy[side] : 0.0;
            pair[i].dy[side] = mu - second - pair[i].s[side] * pair[i].y[side];
        }
}

/* What a pair's targets a, in dy, add to the right-hand side. */
static double term_force(const Pair *pair)
{
    const double d0 = pair->y[0] / pair->s[0], d1 = pair->y[1] / pair->s[1];
    return 2.0 * (d1 * pair->dy[0] / pair->s[0] - d0 * pair->dy[1] / pair->s[1]) / (d0 + d1);
}

static double crop_force(const Pair *pair)
{
    return pair->dy[0] / pair->s[0] - pair->dy[1] / pair->s[1];
}

/* The steps of a pair's slacks and duals that follow from dv, the step of its form. */
static void move_term(Pair *pair)
{
    const double d0 = pair->y[0] / pair->s[0], d1 = pair->y[1] / pair->s[1];
    const double target = pair->dy[0] / pair->s[0] + pair->dy[1] / pair->s[1];
    pair->ds[0] = (target - 2.0 * d1 * pair->dv) / (d0 + d1);
    pair->ds[1] = (target + 2.0 * d0 * pair->dv) / (d0 + d1);
    for (int side = 0; side < 2; side++)
        pair->dy[side] = (pair->dy[side] - pair->y[side] * pair->ds[side]) / pair->s[side];
}

static void move_crop(Pair *pair)
{
    pair->ds[0] = -pair->dv, pair->ds[1] = pair->dv;
    for (int side = 0; side < 2; side++)
        pair->dy[side] = (pair->dy[side] - pair->y[side] * pair->ds[side]) / pair->s[side];
}

/* The step of every pair's form, from the step in q. */
L1L2_INLINE void step_forms(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, const int dim)
{
    const double *step = ipm->rhs;
    Pair *pair = ipm->term;
    for (int order = 1; order <= L1L2_PATH_ORDERS; order++)
        for (int t = l1l2_path_first_term(order, p->history); t < p->count; t++)
            for (int j = 0; j < dim; j++, pair++) {
                pair->dv = 0.0;
                for (int m = 0; m <= order && m <= t; m++)
                    pair->dv += p->difference[t][order - 1][m] * step[dim * (t - m) + j];
            }
    pair = ipm->crop;
    for (int t = 0; t < p->count; t++)
        for (int r = 0; r < p->rows; r++, pair++) {
            pair->dv = 0.0;
            for (int j = 0; j < dim; j++)
                pair->dv += p->G[t][r][j] * step[dim * t + j];
        }
}

/* One direction: targets, right-hand side, solution, and every pair's step. */
L1L2_INLINE void direction(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, double mu, bool corrector,
                           const int dim)
{
    const int size = dim * p->count;
    double *step = ipm->rhs;
    aim(ipm->term, ipm->terms, mu, corrector);
    aim(ipm->crop, ipm->crops, mu, corrector);
    memcpy(step, ipm->gradient, (size_t)size * sizeof *step);
    add_gradients(ipm, p, term_force, crop_force, step, dim);
    for (int i = 0; i < size; i++)
        step[i] = -step[i];
    l1l2_path_ldl_solve(ipm->band, step, size, band_of(dim));
    step_forms(ipm, p, dim);
    for (int i = 0; i < ipm->terms; i++)
        move_term(&ipm->term[i]);
    for (int i = 0; i < ipm->crops; i++)
        move_crop(&ipm->crop[i]);
}

/* How far along the direction all slacks and duals stay >= 0: at most 1. */
static double reach(const Pair *pair, int count, double alpha)
{
    for (int i = 0; i < count; i++)
        for (int side = 0; side < 2; side++) {
            if (pair[i].s[side] + alpha * pair[i].ds[side] < 0.0)
                alpha = -pair[i].s[side] / pair[i].ds[side];
            if (pair[i].y[side] + alpha * pair[i].dy[side] < 0.0)
                alpha = -pair[i].y[side] / pair[i].dy[side];
        }
    return alpha;
}

static double gap_after(const Pair *pair, int count, double alpha)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        for (int side = 0; side < 2; side++)
            sum += (pair[i].s[side] + alpha * pair[i].ds[side]) * (pair[i].y[side] + alpha * pair[i].dy[side]);
    return sum;
}

static void move(Pair *pair, int count, double alpha)
{
    for (int i = 0; i < count; i++)
        for (int side = 0; side < 2; side++) {
            pair[i].s[side] += alpha * pair[i].ds[side];
            pair[i].y[side] += alpha * pair[i].dy[side];
        }
}

/* Predictor and corrector with one factorization. False where a number is not finite. */
L1L2_INLINE bool iterate(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, double gap, const int dim)
{
    const int sides = 2 * (ipm->terms + ipm->crops), size = dim * p->count;
    assemble(ipm, p, dim);
    for (int i = 0; i < size; i++)
        ipm->diagonal[i] = ipm->band[i * band_of(dim)];
    if (!l1l2_path_ldl_factorize(ipm->band, ipm->diagonal, size, band_of(dim)))
        return false;
    direction(ipm, p, 0.0, false, dim);
    double alpha = reach(ipm->crop, ipm->crops, reach(ipm->term, ipm->terms, 1.0));
    const double left = gap_after(ipm->term, ipm->terms, alpha) + gap_after(ipm->crop, ipm->crops, alpha);
    const double centering = (left / gap) * (left / gap) * (left / gap);
    direction(ipm, p, centering * gap / sides, true, dim);
    alpha = reach(ipm->crop, ipm->crops, reach(ipm->term, ipm->terms, 1.0 / step_fraction)) * step_fraction;
    if (!isfinite(alpha))
        return false;
    move(ipm->term, ipm->terms, alpha);
    move(ipm->crop, ipm->crops, alpha);
    for (int t = 0; t < p->count; t++)
        for (int j = 0; j < dim; j++)
            ipm->q[t][j] += alpha * ipm->rhs[dim * t + j];
    return true;
}

/* The iterate as a point; ipm keeps it. */
static void keep(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p)
{
    memcpy(ipm->best_q, ipm->q, (size_t)p->count * sizeof *ipm->q);
    for (int i = 0; i < ipm->terms; i++) {
        ipm->slack[i] = 0.5 * (ipm->term[i].s[0] + ipm->term[i].s[1]);
        ipm->term_dual[i][0] = ipm->term[i].y[0];
        ipm->term_dual[i][1] = ipm->term[i].y[1];
    }
    for (int i = 0; i < ipm->crops; i++)
        ipm->constraint_dual[i / p->rows][i % p->rows] = ipm->crop[i].y[0] - ipm->crop[i].y[1];
}

L1L2_INLINE L1L2PathInteriorPointReport solve(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p, const int dim)
{
    L1L2PathInteriorPointReport best = {.bound = HUGE_VAL};
    int since_best = 0;
    start(ipm, p, dim);
    keep(ipm, p);
    for (int iteration = 0; iteration < max_iterations; iteration++) {
        const double gap = gap_after(ipm->term, ipm->terms, 0.0) + gap_after(ipm->crop, ipm->crops, 0.0);
        const double bound = gap + stationarity(ipm, p, ipm->gradient, dim);
        if (bound < best.bound) {
            best = (L1L2PathInteriorPointReport){.iterations = iteration, .bound = bound};
            since_best = 0;
            keep(ipm, p);
        }
        if (bound <= bound_goal || ++since_best > patience || !iterate(ipm, p, gap, dim))
            break;
    }
    return best;
}

L1L2PathInteriorPointReport l1l2_path_interior_point_solve(L1L2PathInteriorPoint *ipm, const L1L2PathProblem *p,
                                                           L1L2PathPoint *point)
{
    L1L2PathInteriorPointReport best = p->dim == 2   ? solve(ipm, p, 2)
                                       : p->dim == 4 ? solve(ipm, p, 4)
                                                     : solve(ipm, p, 6);
    *point = (L1L2PathPoint){ipm->best_q, ipm->slack, ipm->term_dual, ipm->constraint_dual};
    const double objective = l1l2_path_objective(p, (const double(*)[L1L2_DIM])point->q);
    best.converged = best.bound <= enough_absolute + enough_relative * objective;
    return best;
}
