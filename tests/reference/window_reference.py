# SPDX-License-Identifier: MIT
"""Independent solution of the window problem (Qu & Song 2013, eq. 4 to 7), from the paper alone.

It shares nothing with the library. Its variables are the update transforms B_t (eq. 6) instead of the paths P_t, its
solver is Clarabel (HiGHS where lambda is 0), and its matrices are general sparse ones. It knows each motion model.
Unit: the frame's diagonal. The linear part has half the weight in both norms.
Frames may be at any times: `times` are those of the past and of the window's frames, in nominal frames.
It needs numpy, scipy and clarabel. The library's build and tests do not need it.
"""
import math

import numpy as np
import scipy.optimize
import scipy.sparse as sp

ORDERS = (1, 2, 3)


def difference(times):
    """Coefficients of k + 1 frames, the newest first: the k-th derivative, which is k! times the divided difference,
    times the time that it stands for, which is a k-th of the span. 1 -1; 1 -2 1; 1 -3 3 -1 for even times."""
    k = len(times) - 1
    divided = [1 / np.prod([a - b for j, b in enumerate(times) if j != i]) for i, a in enumerate(times)]
    return [math.factorial(k) * w * (times[-1] - times[0]) / k for w in divided][::-1]


def shares(times, past):
    """Part of time of each frame of the window. The steps before the path and after the window count as one frame."""
    steps = np.concatenate([[1], np.diff(times), [1]])[past:]
    return (steps[:-1] + steps[1:]) / 2


class Similarity:
    """p = (a, b, x, y): [a -b x; b a y]."""
    dim = 4
    terms = np.diag([0.5, 0.5, 1, 1])                    # what the norms are taken of, from p
    proximity = [([1, 0, 0, 0], 0.9, 1.1), ([0, 1, 0, 0], -0.1, 0.1)]

    @staticmethod
    def matrix(p):
        a, b, x, y = p
        return np.array([[a, -b, x], [b, a, y], [0, 0, 1.0]])

    @staticmethod
    def parameters(m):
        return np.array([m[0, 0], m[1, 0], m[0, 2], m[1, 2]])


class Translation:
    """p = (x, y)."""
    dim = 2
    terms = np.eye(2)
    proximity = []

    @staticmethod
    def matrix(p):
        return np.array([[1, 0, p[0]], [0, 1, p[1]], [0, 0, 1.0]])

    @staticmethod
    def parameters(m):
        return np.array([m[0, 2], m[1, 2]])


class Affine:
    """p = (a, b, c, d, x, y): [a b x; c d y]. The norms are taken of zoom, turn, stretch and skew, each halved."""
    dim = 6
    terms = np.array([[1, 0, 0, 1, 0, 0], [0, -1, 1, 0, 0, 0], [1, 0, 0, -1, 0, 0], [0, 1, 1, 0, 0, 0],
                      [0, 0, 0, 0, 4, 0], [0, 0, 0, 0, 0, 4]]) / 4
    proximity = [([1, 0, 0, 0, 0, 0], 0.9, 1.1), ([0, 0, 0, 1, 0, 0], 0.9, 1.1), ([0, 1, 0, 0, 0, 0], -0.1, 0.1),
                 ([0, 0, 1, 0, 0, 0], -0.1, 0.1), ([0, 1, 1, 0, 0, 0], -0.05, 0.05), ([1, 0, 0, -1, 0, 0], -0.1, 0.1)]

    @staticmethod
    def matrix(p):
        a, b, c, d, x, y = p
        return np.array([[a, b, x], [c, d, y], [0, 0, 1.0]])

    @staticmethod
    def parameters(m):
        return np.array([m[0, 0], m[0, 1], m[1, 0], m[1, 1], m[0, 2], m[1, 2]])


def left_multiplication(c, model):
    """The L and shift with parameters(C B) = L parameters(B) + shift."""
    shift = model.parameters(c @ model.matrix(np.zeros(model.dim)))
    return np.column_stack([model.parameters(c @ model.matrix(e)) - shift for e in np.eye(model.dim)]), shift


def camera_path(motions, model):
    """C_t relative to the window's first frame (eq. 1); motions[0] is not used."""
    path = [np.eye(3)]
    for f in motions[1:]:
        path.append(path[-1] @ model.matrix(f))
    return path


def limits(crop, half_w, half_h, model):
    """Rows g and bounds h, g p <= h on the parameters of one B: the corners inside, and the proximity."""
    rows = []
    for sx in (-1, 1):
        for sy in (-1, 1):
            corner = np.array([sx * crop * half_w, sy * crop * half_h, 1])
            fixed = (model.matrix(np.zeros(model.dim)) @ corner)[:2]
            moved = np.column_stack([(model.matrix(e) @ corner)[:2] - fixed for e in np.eye(model.dim)])
            for g, at, half in zip(moved, fixed, (half_w, half_h)):
                rows += [(g, half - at), (-g, half + at)]
    for g, low, high in model.proximity:
        rows += [(np.array(g, float), high), (-np.array(g, float), -low)]
    return rows


def assemble(motions, past, crop, width, height, model, times):
    """Rows of the problem in p = parameters of B_t: differences (d + D p), L2 part (l + L p), and G p <= h.
    past: parameters of P of up to three frames before the window, newest last, in the window's reference."""
    n, diagonal, dim = len(motions), np.hypot(width, height), model.dim
    path = camera_path(motions, model)
    lifts = [left_multiplication(c, model) for c in path]

    def smooth(t):
        """P_t as (matrix over all variables, constant)."""
        if t < 0:
            return sp.csr_matrix((dim, dim * n)), np.asarray(past[t], float)
        lift, shift = lifts[t]
        block = sp.lil_matrix((dim, dim * n))
        block[:, dim * t:dim * t + dim] = lift
        return block.tocsr(), shift

    terms = sp.csr_matrix(model.terms)
    rows, constants = [], []
    for order in ORDERS:
        for t in range(n):
            if t - order < -len(past):
                continue
            parts = [smooth(t - m) for m in range(order + 1)]
            signs = difference(times[len(past) + t - order:len(past) + t + 1])
            rows.append(terms @ sum(s * q[0] for s, q in zip(signs, parts)))
            constants.append(model.terms @ sum(s * q[1] for s, q in zip(signs, parts)))
    D = sp.vstack(rows).tocsr() if rows else sp.csr_matrix((0, dim * n))
    d = np.concatenate(constants) if constants else np.zeros(0)

    L = sp.vstack([terms @ smooth(t)[0] for t in range(n)]).tocsr()
    l = np.concatenate([model.terms @ (smooth(t)[1] - model.parameters(path[t])) for t in range(n)])

    frame = limits(crop, width / 2 / diagonal, height / 2 / diagonal, model)
    G = sp.block_diag([np.array([g for g, _ in frame])] * n).tocsr()
    h = np.array([bound for _, bound in frame] * n)
    return D, d, L, l, G, h, path


def solve(motions, past, lam, crop, width, height, model=Similarity, times=None):
    """Objective, parameters of P_t (n x dim) in the window's reference."""
    if times is None:
        times = np.arange(len(past) + len(motions))
    D, d, L, l, G, h, path = assemble(motions, past, crop, width, height, model, times)
    share = np.repeat(np.sqrt(shares(times, len(past))), model.dim)
    L, l = sp.diags(share) @ L, share * l
    n, terms = model.dim * len(motions), D.shape[0]
    eye = sp.identity(terms)
    A = sp.vstack([sp.hstack([D, -eye]), sp.hstack([-D, -eye]), sp.hstack([G, sp.csr_matrix((G.shape[0], terms))])])
    b = np.concatenate([-d, d, h])
    cost = np.concatenate([2 * lam * (L.T @ l), np.ones(terms)])
    if lam == 0:
        for method in ('highs-ipm', 'highs-ds'):
            result = scipy.optimize.linprog(cost, A_ub=A.tocsc(), b_ub=b, bounds=(None, None), method=method,
                                            options={'primal_feasibility_tolerance': 1e-10,
                                                     'dual_feasibility_tolerance': 1e-10})
            if result.status == 0:
                break
        assert result.status == 0, result.message
        z = result.x
    else:
        import clarabel
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-13
        settings.max_iter = 400
        H = sp.block_diag([2 * lam * (L.T @ L), sp.csc_matrix((terms, terms))]).tocsc()
        for refinements in (10, 50):
            settings.iterative_refinement_max_iter = refinements
            result = clarabel.DefaultSolver(sp.triu(H).tocsc(), cost, A.tocsc(), b, [clarabel.NonnegativeConeT(len(b))],
                                            settings).solve()
            if str(result.status) == 'Solved':
                break
            settings.iterative_refinement_reltol = settings.iterative_refinement_abstol = 1e-15
        assert str(result.status) in ('Solved', 'AlmostSolved', 'InsufficientProgress'), result.status
        z = np.array(result.x)
    p = z[:n]
    objective = np.abs(D @ p + d).sum() + lam * ((L @ p + l) ** 2).sum()
    smooth = np.array([model.parameters(c @ model.matrix(q)) for c, q in zip(path, p.reshape(-1, model.dim))])
    return objective, smooth
