"""Exact rods, solved without finite elements: Cosserat's equations of a rod with a dead load at its tip.

    r' = R (e_x + C_n^-1 R^T n)                      centre line                                      (1)
    R' = R skew(kappa_0 + C_m^-1 R^T m)              section, R as a unit quaternion                  (2)
    n' = 0,  m' = -r' x n                            equilibrium, base axes                           (3)

with r(0) = 0, R(0) given, n(L) the load, m(L) = 0. Shooting for m(0), the load growing in steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import root

Floats = NDArray[np.float64]


def rotation(q: Floats) -> Floats:
    """Rotation matrix of a quaternion w, x, y, z of any length."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def turned(q: Floats, kappa: Floats) -> Floats:
    """q' of (2)."""
    w, v = q[0], q[1:]
    return 0.5 * np.concatenate([[-v @ kappa], w * kappa + np.cross(v, kappa)])


def rod_tip(
    length: float,
    load: ArrayLike,
    force_stiffness: ArrayLike,
    moment_stiffness: ArrayLike,
    curvature: ArrayLike = (0.0, 0.0, 0.0),
    load_steps: int = 4,
) -> Floats:
    """Tip of a rod that starts at the origin along x, under a dead force at its tip.

    Parameters
    ----------
    length : float
        Length [m].
    load : (3,)
        Force at the tip, base axes [N].
    force_stiffness, moment_stiffness : (3,)
        (EA, GA_y, GA_z) [N] and (GJ, EI_y, EI_z) [N m2].
    curvature : (3,)
        Of the unloaded rod, section axes [1/m].
    """
    C_n, C_m = np.asarray(force_stiffness, float), np.asarray(moment_stiffness, float)
    kappa_0, full = np.asarray(curvature, float), np.asarray(load, float)

    def slope(_: float, y: Floats, n: Floats) -> Floats:
        R, m = rotation(y[3:7]), y[7:]
        r = R @ (np.array([1.0, 0, 0]) + (R.T @ n) / C_n)  # eq. (1)
        return np.concatenate([r, turned(y[3:7], kappa_0 + (R.T @ m) / C_m), -np.cross(r, n)])  # eq. (2), (3)

    def end(m_0: Floats, n: Floats) -> Floats:
        start = np.concatenate([np.zeros(3), [1.0, 0, 0, 0], m_0])
        solution = solve_ivp(slope, (0, length), start, args=(n,), method="DOP853", rtol=1e-8, atol=1e-10)
        return solution.y[:, -1]

    m_0 = np.zeros(3)
    for share in np.linspace(0, 1, load_steps + 1)[1:]:
        scale = np.linalg.norm(share * full) * length
        found = root(lambda x, n=share * full, s=scale: end(x * s, n)[7:] / s, m_0 / scale, tol=1e-9)
        assert found.success, found.message
        m_0 = found.x * scale
    return end(m_0, full)[:3]
