/* SPDX-License-Identifier: MIT */
/*
 * The window problem (paper, eq. 4 to 7), stated once.
 *
 *   minimize over q_t:   sum_k w_k sum_t |D^k q_t|_1  +  sum_t lambda_t |q_t - c_t|^2,      k = 1, 2, 3
 *   subject to           lo_t <= G_t q_t <= hi_t        (inclusion and proximity, constraints.h)
 *
 * q_t are the parameters of P_t (geom.h: 2, 4 or 6 by the motion model), c_t those of C_t, in diagonals, relative to
 * the window's first frame. They are scaled so that a change of any of them by 1 moves the frame's corners by 1. The
 * variable itself is scaled, so the scale is the same in both norms. w_k = 1 (eq. 5). lambda_t is lambda * 30 / frame
 * rate.
 *
 * D^k q_t is the k-th backward difference; a "term" is one of them. Terms reach back over the `history` last frames
 * that were emitted before the window (0 to 3; the continuous join). These frames are constants. A term that would
 * reach further back does not exist, so order k has a term at each frame from max(0, k - history) on.
 *
 * Time. The problem approximates the integral over time of w_1 |q'| + w_2 |q''| + w_3 |q'''| + lambda |q - c|^2. The
 * unit of time is the nominal frame. Let h_t be the time from frame t-1 to frame t: 1 at a constant frame rate. The
 * derivatives are divided differences (C. de Boor, "A Practical Guide to Splines", chapter 1):
 *     velocity       v_t = (q_t - q_{t-1}) / h_t,
 *     acceleration   a_t = (v_t - v_{t-1}) / m_t,    m_t = (h_t + h_{t-1}) / 2: between the centers of two steps,
 *     jerk           j_t = (a_t - a_{t-1}) / k_t,    k_t = (h_t + h_{t-1} + h_{t-2}) / 3.
 * The integral weighs each with the time that it stands for: h_t |v_t|, m_t |a_t| and k_t |j_t|. The last division
 * cancels, and what is left is the total variation of the path, of its velocity and of its acceleration:
 *     D^1 q_t = q_t - q_{t-1},    D^2 q_t = v_t - v_{t-1},    D^3 q_t = a_t - a_{t-1}.
 * With u_t = 1 / h_t and s_t = 1 / m_t the coefficients of q_t, q_{t-1}, q_{t-2} and q_{t-3} are
 *     D^1    1          -1
 *     D^2    u_t        -(u_t + u_{t-1})                           u_{t-1}
 *     D^3    s_t u_t    -s_t (u_t + u_{t-1}) - s_{t-1} u_{t-1}
 *                       s_t u_{t-1} + s_{t-1} (u_{t-1} + u_{t-2})    -s_{t-1} u_{t-2}
 * Where all steps are 1 they are exactly 1 -1, 1 -2 1 and 1 -3 3 -1. Every uniform path, q_t = q_0 + speed * time, has
 * D^2 = D^3 = 0 whatever the steps. The L2 term weighs a frame with its share of time, (h_t + h_{t+1}) / 2, which the
 * caller puts into lambda_t.
 *
 * The variable is P, not B: the L1 and L2 parts then have constant coefficients, and only G depends on C_t.
 */
#ifndef L1L2_PATH_PROBLEM_H
#define L1L2_PATH_PROBLEM_H

#include "path/constraints.h"

#define L1L2_PATH_ORDERS 3  /* of differences */
#define L1L2_PATH_HISTORY 3 /* frames that the third difference reaches back */

typedef struct L1L2PathProblem {
    int dim;     /* components of q_t that are used: 2, 4 or 6 */
    int rows;    /* of G_t that are used: l1l2_path_constraint_count(dim) */
    int count;   /* n, frames, >= 1 */
    int history; /* frames of `past` that exist, 0..3 */
    double past[L1L2_PATH_HISTORY][L1L2_DIM]; /* q of the frames before the window, newest last: [2] is frame -1 */
    double weight[L1L2_PATH_ORDERS];            /* w_k, > 0 */
    double (*camera)[L1L2_DIM];            /* n: c_t */
    double (*difference)[L1L2_PATH_ORDERS][L1L2_PATH_HISTORY + 1]; /* n: D^k q_t = sum_m [t][k-1][m] q_{t-m} */
    double *lambda;                        /* n: lambda_t, >= 0 */
    double (*G)[L1L2_PATH_CONSTRAINTS][L1L2_DIM]; /* n */
    double (*lo)[L1L2_PATH_CONSTRAINTS];          /* n */
    double (*hi)[L1L2_PATH_CONSTRAINTS];          /* n */
} L1L2PathProblem;

/* A point with its duals. Term components are counted order by order: component j of term i of order k is number
 * dim (terms of the orders below k + i) + j; see l1l2_path_term_index(). */
typedef struct L1L2PathPoint {
    double (*q)[L1L2_DIM];              /* n */
    double *slack;                      /* term components: e >= |D^k q| */
    double (*term_dual)[2];             /* term components: of D^k q <= e and of -D^k q <= e, >= 0 */
    double (*constraint_dual)[L1L2_PATH_CONSTRAINTS]; /* n: of G q <= hi less that of G q >= lo */
} L1L2PathPoint;

/* The coefficients where all steps are 1: D^k q_t = sum_m l1l2_path_difference_coefficients[k-1][m] q_{t-m}. */
extern const double l1l2_path_difference_coefficients[L1L2_PATH_ORDERS][L1L2_PATH_HISTORY + 1];

/* Arrays for up to `capacity` frames of a motion model of `dim` parameters; weights and steps 1, the rest 0. NULL when
 * out of memory. */
L1L2PathProblem *l1l2_path_problem_create(int capacity, int dim);
void l1l2_path_problem_free(L1L2PathProblem *p);

/* Fills in frame t, whose camera path (of the motion model, as is `crop`) is `camera`. */
void l1l2_path_problem_set(L1L2PathProblem *p, int t, const L1L2Mat *camera, double lambda,
                           const L1L2PathCropWindow *crop);

/* The times that the terms at frame t span, in nominal frames, > 0. step: h_t, h_{t-1}, h_{t-2}; 1 where no term needs
 * it. */
void l1l2_path_problem_set_steps(L1L2PathProblem *p, int t, const double step[L1L2_PATH_HISTORY]);

/* Frame of an order's first term, and how many terms it has. order: 1, 2, 3. */
int l1l2_path_first_term(int order, int history);
int l1l2_path_terms(int order, int count, int history);
int l1l2_path_term_index(const L1L2PathProblem *p, int order, int term, int component);
/* Components of all terms. */
int l1l2_path_term_components(const L1L2PathProblem *p);

/* D^order q at frame t, component j; q: n rows. */
double l1l2_path_difference(const L1L2PathProblem *p, const double (*q)[L1L2_DIM], int order, int t, int j);

/* eq. (4) at q. */
double l1l2_path_objective(const L1L2PathProblem *p, const double (*q)[L1L2_DIM]);

/* The largest violation of a constraint row at q: <= 0 where all hold. */
double l1l2_path_excess(const L1L2PathProblem *p, const double (*q)[L1L2_DIM]);

#endif
