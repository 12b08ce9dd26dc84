"""Parts for tests of super-elements: a frame of welded bars, assembled and reduced with dense NumPy.

Bars are Euler-Bernoulli beams with cubic shape functions (J. S. Przemieniecki, Theory of Matrix Structural
Analysis, 1968, eqs. 5.116 and 11.23); the reduction is Craig-Bampton's. Nothing of it is shared with flexarm.
"""

from itertools import pairwise

import numpy as np
from scipy.linalg import block_diag, eigh

from flexarm import SuperElement

E, NU, RHO = 70e9, 0.33, 2700.0
WIDTH, HEIGHT = 0.03, 0.05
CORNERS = {
    "foot": (0.1, -0.2, 0.05),
    "elbow": (0.3, 0.1, 0.15),
    "hand": (0.9, 0.2, -0.1),
    "ear": (0.35, 0.5, 0.3),
}
BARS = (("foot", "elbow"), ("elbow", "hand"), ("elbow", "ear"))
DIVISIONS = 6


def frame_part(n_modes: int = 4, damping: float = 0.0) -> SuperElement:
    """A branched frame with the interfaces foot, hand and ear, none of them along another's axes."""
    names, K, M, points = frame_matrices()
    held = np.concatenate([6 * names[n] + np.arange(6) for n in ("foot", "hand", "ear")])
    free = np.setdiff1d(np.arange(len(K)), held)
    squares, modes = eigh(
        K[np.ix_(free, free)], M[np.ix_(free, free)], subset_by_index=(0, max(n_modes, 1) - 1)
    )
    T = np.zeros((len(K), len(held) + n_modes))
    T[held, np.arange(len(held))] = 1
    T[free, : len(held)] = -np.linalg.solve(K[np.ix_(free, free)], K[np.ix_(free, held)])
    T[np.ix_(free, np.arange(len(held), T.shape[1]))] = modes[:, :n_modes]
    stiffness = T.T @ K @ T
    return SuperElement(
        name="frame",
        interfaces=("foot", "hand", "ear"),
        positions=points[[names["foot"], names["hand"], names["ear"]]],
        rotations=np.array([np.eye(3)] * 3),
        stiffness=(stiffness + stiffness.T) / 2,
        mass=T.T @ M @ T,
        damping=damping * (stiffness + stiffness.T) / 2,
        frequency_hz=np.sqrt(squares[:n_modes]) / (2 * np.pi),
    )


def frame_mass() -> float:
    """Mass of the bars [kg]."""
    lengths = [np.linalg.norm(np.subtract(CORNERS[b], CORNERS[a])) for a, b in BARS]
    return RHO * WIDTH * HEIGHT * float(sum(lengths))


def frame_matrices():
    """Names of corners with their points' numbers, K, M and the points of the undivided frame."""
    names = {name: i for i, name in enumerate(CORNERS)}
    points = [np.array(p) for p in CORNERS.values()]
    pairs = []
    for a, b in BARS:
        chain = [names[a]]
        for k in range(1, DIVISIONS):
            points.append(points[names[a]] + (points[names[b]] - points[names[a]]) * k / DIVISIONS)
            chain.append(len(points) - 1)
        chain.append(names[b])
        pairs += list(pairwise(chain))
    K = np.zeros((6 * len(points), 6 * len(points)))
    M = np.zeros_like(K)
    for i, j in pairs:
        k, m = bar(points[i], points[j])
        at = np.concatenate([6 * i + np.arange(6), 6 * j + np.arange(6)])
        K[np.ix_(at, at)] += k
        M[np.ix_(at, at)] += m
    return names, K, M, np.array(points)


def bar(start, end):
    """Stiffness and consistent mass of one bar in the axes of its points."""
    L = float(np.linalg.norm(end - start))
    x = (end - start) / L
    y = np.cross((0.3, 0.2, 1.0), x)
    y /= np.linalg.norm(y)
    R = np.column_stack([x, y, np.cross(x, y)])
    T = block_diag(R, R, R, R)
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    A, Iy, Iz = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12, HEIGHT * WIDTH**3 / 12
    pair, line = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    k[np.ix_([0, 6], [0, 6])] = E * A / L * pair
    m[np.ix_([0, 6], [0, 6])] = RHO * A * L * line
    k[np.ix_([3, 9], [3, 9])] = E / (2 * (1 + NU)) * (Iy + Iz) / L * pair
    m[np.ix_([3, 9], [3, 9])] = RHO * (Iy + Iz) * L * line
    for at, inertia, sign in (([1, 5, 7, 11], Iz, 1), ([2, 4, 8, 10], Iy, -1)):
        S = np.diag([1, sign, 1, sign])
        b, d = 6 * L, 2 * L**2
        bend = np.array([[12, b, -12, b], [b, 2 * d, -b, d], [-12, -b, 12, -b], [b, d, -b, 2 * d]])
        e, f, g, h = 22 * L, 13 * L, 4 * L**2, 3 * L**2
        move = np.array([[156, e, 54, -f], [e, g, f, -h], [54, f, 156, -e], [-f, -h, -e, g]])
        k[np.ix_(at, at)] = E * inertia / L**3 * S @ bend @ S
        m[np.ix_(at, at)] = RHO * A * L / 420 * S @ move @ S
    return T @ k @ T.T, T @ m @ T.T
