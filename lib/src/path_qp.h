/* SPDX-License-Identifier: MIT */
/*
 * The window problem (paper, eq. 4 to 7), written once.
 *
 *   minimise over q_t:   sum_k w_k sum_t |D^k q_t|_1  +  sum_t lambda_t |q_t - c_t|^2,      k = 1, 2, 3
 *   subject to           lo_t <= G_t q_t <= hi_t        (inclusion and proximity, crop.h)
 *
 * q_t = (a/2, b/2, x, y) of the similarity P_t, c_t the same of C_t, in diagonals, relative to the window's first
 * frame. The linear part is halved because a change of a or b by d moves the frame's corner by d/2 diagonals: it is
 * the variable that is scaled, in both norms. w_k = 1 (eq. 5); lambda_t is lambda * 30 / frame rate.
 * D^k q_t is the k-th backward difference. It reaches back over the `history` last frames that were given out before
 * the window (0 to 3; the "continuous" join), which are constants; terms that would reach further do not exist.
 *
 * As a quadratic program in z = (q, e), with a slack e >= |D^k q| for each term:
 *
 *   columns   q      4 t + j
 *             e_k    4 n + 4 (terms of orders below k) + 4 i + j
 *   rows      D_k    8 (terms of orders below k) + 8 i + 2 j + s       s = 0:  D - e <= 0,  s = 1: -D - e <= 0
 *             G_t    8 (all terms) + 10 t + r
 *
 * n: frames; j: component of q; i: term of order k, which is the difference at frame i + first_k.
 */
#ifndef L1L2_PATH_QP_H
#define L1L2_PATH_QP_H

#include "crop.h"
#include "qp.h"

#define L1L2_DIM 4     /* components of q_t */
#define L1L2_HISTORY 3 /* the third difference reaches three frames back */

typedef struct L1L2WindowProblem {
    int count;    /* n, frames, >= 1 */
    int history;  /* frames of `past` that exist, 0..3 */
    double past[L1L2_HISTORY][L1L2_DIM]; /* q of the frames before the window, newest last: past[2] is frame -1 */
    double weight[3];                    /* w_k */
    double (*camera)[L1L2_DIM];          /* n: c_t */
    double *lambda;                      /* n: lambda_t */
    double (*G)[L1L2_CROP_ROWS][L1L2_DIM]; /* n */
    double (*lo)[L1L2_CROP_ROWS];          /* n */
    double (*hi)[L1L2_CROP_ROWS];          /* n */
} L1L2WindowProblem;

/* q of a similarity, and back. */
void l1l2_q_from_mat(const L1L2Mat *m, double q[L1L2_DIM]);
L1L2Mat l1l2_q_to_mat(const double q[L1L2_DIM]);

/* Arrays for up to `capacity` frames; weights 1, the rest 0. NULL when out of memory. */
L1L2WindowProblem *l1l2_window_problem_create(int capacity);
void l1l2_window_problem_free(L1L2WindowProblem *p);

/* eq. (4) at q: n rows of L1L2_DIM. */
double l1l2_window_objective(const L1L2WindowProblem *p, const double (*q)[L1L2_DIM]);

/* The largest violation of a constraint row at q: <= 0 where all hold. */
double l1l2_window_excess(const L1L2WindowProblem *p, const double (*q)[L1L2_DIM]);

/* The layout. order: k = 1, 2, 3. */
int l1l2_terms_first(int order, int history);            /* frame of an order's first term */
int l1l2_terms(int order, int count, int history);       /* how many terms an order has */
int l1l2_col_q(int frame, int component);
int l1l2_col_slack(int count, int history, int order, int term, int component);
int l1l2_row_term(int count, int history, int order, int term, int component, int side);
int l1l2_row_crop(int count, int history, int frame, int row);
int l1l2_cols(int count, int history);
int l1l2_rows(int count, int history);

/* The quadratic program of p: fills qp, which was created for p's count and capacity frames. */
L1L2Qp *l1l2_path_qp_create(int capacity);
void l1l2_path_qp_fill(const L1L2WindowProblem *p, L1L2Qp *qp);

#endif
