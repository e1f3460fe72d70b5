/* SPDX-License-Identifier: MIT */
/*
 * The window problem of problem.h as a quadratic program in z = (q, e), with a slack e >= |D^k q| for each
 * component of each term.
 *
 *   columns   q      d t + j
 *             e      d (n + terms of orders below k + i) + j
 *   rows      D^k    2 (d (terms of orders below k + i) + j) + s       s = 0:  D - e <= 0,  s = 1: -D - e <= 0
 *             G_t    2 d (all terms) + R t + r
 *
 * d: components of q; R: constraint rows of a frame; n: frames; t: frame; j: component; i: term of order k, at frame
 * i + l1l2_path_first_term(k); r: constraint row.
 * Rows and slacks are scaled: the column is scale_k times the slack, and its two rows are multiplied by scale_k. The
 * scales are in problem_as_qp.c.
 */
#ifndef L1L2_PATH_PROBLEM_AS_QP_H
#define L1L2_PATH_PROBLEM_AS_QP_H

#include "path/problem.h"
#include "path/qp.h"

int l1l2_path_qp_col_q(const L1L2PathProblem *p, int frame, int component);
int l1l2_path_qp_col_slack(const L1L2PathProblem *p, int order, int term, int component);
int l1l2_path_qp_row_term(const L1L2PathProblem *p, int order, int term, int component, int side);
int l1l2_path_qp_row_constraint(const L1L2PathProblem *p, int frame, int row);
int l1l2_path_qp_cols(const L1L2PathProblem *p);
int l1l2_path_qp_rows(const L1L2PathProblem *p);

/* Room for windows of up to `capacity` frames; to be freed by l1l2_path_qp_free(). NULL when out of memory. */
L1L2PathQp *l1l2_path_problem_as_qp_create(int capacity, int dim);

/* The quadratic program of p, which must not cover more frames than qp has room for. */
void l1l2_path_problem_as_qp_fill(const L1L2PathProblem *p, L1L2PathQp *qp);

/* The same point, in the program's layout and scaling: z (cols) and duals y (rows) of q and the rest of `point`. */
void l1l2_path_problem_as_qp_point(const L1L2PathProblem *p, const L1L2PathPoint *point, double *z, double *y);

#endif
