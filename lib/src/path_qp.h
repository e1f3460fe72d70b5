/* SPDX-License-Identifier: MIT */
/*
 * The window problem of path_problem.h as a quadratic program in z = (q, e), with a slack e >= |D^k q| for each
 * component of each term.
 *
 *   columns   q      4 t + j
 *             e      4 (n + terms of orders below k + i) + j
 *   rows      D^k    2 (4 (terms of orders below k + i) + j) + s       s = 0:  D - e <= 0,  s = 1: -D - e <= 0
 *             G_t    8 (all terms) + 10 t + r
 *
 * n: frames; t: frame; j: component of q; i: term of order k, at frame i + l1l2_terms_first(k); r: crop row.
 * Rows and slacks are scaled by hand: e is scale_k times the slack, its rows are multiplied by scale_k.
 */
#ifndef L1L2_PATH_QP_H
#define L1L2_PATH_QP_H

#include "path_problem.h"
#include "qp.h"

int l1l2_col_q(int frame, int component);
int l1l2_col_slack(int count, int history, int order, int term, int component);
int l1l2_row_term(int count, int history, int order, int term, int component, int side);
int l1l2_row_crop(int count, int history, int frame, int row);
int l1l2_cols(int count, int history);
int l1l2_rows(int count, int history);

/* Room for windows of up to `capacity` frames; to be freed by l1l2_qp_free(). NULL when out of memory. */
L1L2Qp *l1l2_path_qp_create(int capacity);

/* The quadratic program of p, which must not cover more frames than qp has room for. */
void l1l2_path_qp_fill(const L1L2PathProblem *p, L1L2Qp *qp);

/* The same point, in the program's layout and scaling: z (cols) and duals y (rows) of q and the rest of `point`. */
void l1l2_path_qp_point(const L1L2PathProblem *p, const L1L2PathPoint *point, double *z, double *y);

#endif
