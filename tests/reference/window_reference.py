# SPDX-License-Identifier: MIT
"""Independent solution of the window problem (Qu & Song 2013, eq. 4 to 7), from the paper and nothing else.

Other variables than the library's (the update transforms B_t, eq. 6, instead of the paths P_t), another solver
(Clarabel; HiGHS where lambda is 0) and general sparse matrices. Unit: the frame's diagonal; p = (a, b, x, y), the
linear part at half weight in both norms. Needs numpy, scipy and clarabel; not needed to build or test the library.
"""
import numpy as np
import scipy.optimize
import scipy.sparse as sp

WEIGHT = np.array([0.5, 0.5, 1.0, 1.0])
DIFFERENCES = {1: [1, -1], 2: [1, -2, 1], 3: [1, -3, 3, -1]}


def similarity(p):
    a, b, x, y = p
    return np.array([[a, -b, x], [b, a, y], [0, 0, 1.0]])


def parameters(m):
    return np.array([m[0, 0], m[1, 0], m[0, 2], m[1, 2]])


def left_multiplication(c):
    """The 4x4 L with parameters(C B) = L parameters(B) + shift."""
    a, b, x, y = parameters(c)
    rotate = np.array([[a, -b], [b, a]])
    return np.block([[rotate, np.zeros((2, 2))], [np.zeros((2, 2)), rotate]]), np.array([0, 0, x, y])


def camera_path(motions):
    """C_t relative to the window's first frame (eq. 1); motions[0] is not used."""
    path = [np.eye(3)]
    for f in motions[1:]:
        path.append(path[-1] @ similarity(f))
    return path


def assemble(motions, past, lam, crop, width, height):
    """Rows of the problem in p = parameters of B_t: differences (d + D p), their count, L2 part, and G p <= h.
    past: parameters of P of up to three frames before the window, newest last, in the window's reference."""
    n, diagonal = len(motions), np.hypot(width, height)
    path = camera_path(motions)
    lifts = [left_multiplication(c) for c in path]

    def smooth(t):
        """P_t as (matrix over all variables, constant)."""
        if t < 0:
            return sp.csr_matrix((4, 4 * n)), np.asarray(past[t], float)
        lift, shift = lifts[t]
        block = sp.lil_matrix((4, 4 * n))
        block[:, 4 * t:4 * t + 4] = lift
        return block.tocsr(), shift

    rows, constants = [], []
    for order, signs in DIFFERENCES.items():
        for t in range(n):
            if t - order < -len(past):
                continue
            parts = [smooth(t - m) for m in range(order + 1)]
            rows.append(sp.diags(WEIGHT) @ sum(s * q[0] for s, q in zip(signs, parts)))
            constants.append(WEIGHT * sum(s * q[1] for s, q in zip(signs, parts)))
    D = sp.vstack(rows).tocsr() if rows else sp.csr_matrix((0, 4 * n))
    d = np.concatenate(constants) if constants else np.zeros(0)

    L = sp.vstack([sp.diags(WEIGHT) @ smooth(t)[0] for t in range(n)]).tocsr()
    l = np.concatenate([WEIGHT * (smooth(t)[1] - parameters(path[t])) for t in range(n)])

    G, h = [], []
    half_w, half_h = width / 2 / diagonal, height / 2 / diagonal
    for t in range(n):
        for sx in (-1, 1):
            for sy in (-1, 1):
                u, v = sx * crop * half_w, sy * crop * half_h
                for row, bound in (([u, -v, 1, 0], half_w), ([v, u, 0, 1], half_h)):
                    for sign in (-1, 1):
                        G.append((t, sign * np.array(row)))
                        h.append(bound)
        G += [(t, np.array([1.0, 0, 0, 0])), (t, np.array([-1.0, 0, 0, 0]))]
        h += [1.1, -0.9]
        G += [(t, np.array([0, 1.0, 0, 0])), (t, np.array([0, -1.0, 0, 0]))]
        h += [0.1, 0.1]
    data = np.concatenate([row for _, row in G])
    index = np.concatenate([4 * t + np.arange(4) for t, _ in G])
    G = sp.csr_matrix((data, index, 4 * np.arange(len(G) + 1)), shape=(len(G), 4 * n))
    return D, d, L, l, G, np.array(h), path


def solve(motions, past, lam, crop, width, height):
    """Objective, parameters of P_t (n x 4) in the window's reference."""
    D, d, L, l, G, h, path = assemble(motions, past, lam, crop, width, height)
    n, terms = 4 * len(motions), D.shape[0]
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
        result = clarabel.DefaultSolver(sp.triu(H).tocsc(), cost, A.tocsc(), b, [clarabel.NonnegativeConeT(len(b))],
                                        settings).solve()
        assert str(result.status) in ('Solved', 'AlmostSolved', 'InsufficientProgress'), result.status
        z = np.array(result.x)
    p = z[:n]
    objective = np.abs(D @ p + d).sum() + lam * ((L @ p + l) ** 2).sum()
    smooth = np.array([parameters(c @ similarity(q)) for c, q in zip(path, p.reshape(-1, 4))])
    return objective, smooth
