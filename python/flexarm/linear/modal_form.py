r"""From masses, dampers and springs to state equations.

.. math:: M z'' + C z' + K z = F_0 u + F_1 u' + F_2 u''                                              (1)

A massless coordinate with a damper has a state but no rate of its own; one without follows the others at
once. In order: coordinates c in whose direction neither mass nor damper acts leave by K_cc c = f_c - K_cr r;
coordinates b without mass obey C_bb b' = f_b - K_ba a - K_bb b - C_ba a'; the others a are written in their
undamped modes, a = Phi eta with unit modal mass. The states are (eta, b, eta').

With only some modes kept, all massless coordinates follow at once, their dampers with them, and the modes
left out give what they would give to a constant input: D gains their flexibility.

.. math:: z_t = \Phi_t \Lambda_t^{-1} \Phi_t^T F_0 u                                                 (2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.linear.tangent import is_singular

_NOTHING = 1e-12
"""Share of the largest mass (damping) of a direction below which it has none."""
NO_POLE = 1e-3
"""Poles and frequencies below are zero but for rounding [1/s]: a quarter of an hour is a long swing."""


@dataclass(frozen=True, eq=False)
class Mechanics:
    """Equation (1); F has shape (3, coordinates, inputs)."""

    M: Floats
    C: Floats
    K: Floats
    F: Floats

    def along(self, T: Floats) -> Mechanics:
        """Return the system in coordinates y of z = T y."""
        return Mechanics(T.T @ self.M @ T, T.T @ self.C @ T, T.T @ self.K @ T, T.T @ self.F)


@dataclass(frozen=True, eq=False)
class Signal:
    """States' and inputs' part in some quantities: y = X x + U_0 u + U_1 u' + U_2 u''.

    Attributes
    ----------
    X : ndarray, shape (quantities, states)
    U : ndarray, shape (3, quantities, inputs)
    size : ndarray, shape (3, quantities, inputs)
        Sum of the sizes of what U was added up from, to tell rounding from a small number.
    """

    X: Floats
    U: Floats
    size: Floats

    def rate(self, A: Floats, B: Floats) -> Signal:
        """Return the derivative along x' = A x + B_0 u + B_1 u' + B_2 u''; U_2 must be zero."""
        U, size = self.X @ B, np.abs(self.X) @ np.abs(B)
        U[1:] += self.U[:2]
        size[1:] += self.size[:2]
        return Signal(self.X @ A, U, size)


@dataclass(frozen=True, eq=False)
class ModalForm:
    """State equations of (1), and z in terms of them."""

    A: Floats
    B: Floats
    """x' = A x + B_0 u + B_1 u' + B_2 u''."""
    z: Signal
    """The coordinates, of the modes kept."""
    residual: Floats
    """What the modes left out add to z, (2), shape (coordinates, inputs)."""
    states: tuple[str, ...]
    units: tuple[str, ...]
    """Names of the states, and their units."""


def modal_form(system: Mechanics, count: int | None = None) -> ModalForm:
    """Return the state equations, with the lowest `count` modes or all.

    Raise InvalidParameter if a coordinate has neither mass nor stiffness.
    """
    heavy, massless = _split(system.M)
    damped, slack = _split(massless.T @ system.C @ massless, np.abs(system.C).max(initial=0.0))
    if count is None:
        damped, slack = massless @ damped, massless @ slack
    else:
        damped, slack = massless[:, :0], massless
    # Massless coordinates are condensed: z_c = flexibility u - follows z of the others.
    compliance = slack @ _solve(slack.T @ system.K @ slack, slack.T)
    follows, flexibility = compliance @ system.K, compliance @ system.F[0]
    T_a, T_b = heavy - follows @ heavy, damped - follows @ damped
    if T_b.shape[1]:  # in the modes' shapes the damped massless coordinates stand where springs put them
        T_a = T_a - T_b @ _solve(T_b.T @ system.K @ T_b, T_b.T @ system.K @ T_a)
    values, shapes = _modes(system.along(T_a))
    T_a, kept = T_a @ shapes, len(values) if count is None else min(count, len(values))
    residual = _flexibility(T_a[:, kept:], values[kept:], system.F[0])
    A, B = _first_order(system, T_a[:, :kept], T_b)
    value = np.hstack([T_a[:, :kept], T_b, np.zeros((len(T_a), kept))])
    followed = np.stack([flexibility, 0 * flexibility, 0 * flexibility])
    if count is not None:
        residual, followed = residual + flexibility, 0 * followed
    states, units = _names(kept, T_b.shape[1])
    return ModalForm(A, B, Signal(value, followed, np.abs(followed)), residual, states, units)


def _split(M: Floats, largest: float | None = None) -> tuple[Floats, Floats]:
    """Return orthonormal directions in which a semi-definite matrix acts, and in which it does not."""
    if not len(M):
        return np.zeros((0, 0)), np.zeros((0, 0))
    values, vectors = np.linalg.eigh(0.5 * (M + M.T))
    nothing = values <= _NOTHING * (values[-1] if largest is None else largest)
    return vectors[:, ~nothing], vectors[:, nothing]


def _solve(K: Floats, right: Floats) -> Floats:
    if not len(K):
        return right
    if is_singular(K, 1e-14):
        raise InvalidParameter(
            "a coordinate has neither inertia nor stiffness; give the rotor of its joint an inertia",
            where="joints",
        )
    return np.asarray(np.linalg.solve(K, right))


def _modes(system: Mechanics) -> tuple[Floats, Floats]:
    """Return omega^2, rising, and shapes of unit modal mass."""
    from scipy.linalg import eigh

    if not len(system.M):
        return np.zeros(0), np.zeros((0, 0))
    values, shapes = eigh(0.5 * (system.K + system.K.T), 0.5 * (system.M + system.M.T))
    return np.asarray(values), np.asarray(shapes)


def _flexibility(shapes: Floats, values: Floats, F: Floats) -> Floats:
    """Return (2).

    Raise InvalidParameter if a mode left out has no stiffness, so that a constant input moves it without end.
    """
    loose = np.abs(values) < NO_POLE**2
    if loose.any():
        raise InvalidParameter(
            f"leave out {int(loose.sum())} motions without stiffness, for which no gain stands; keep more",
            where="modes",
        )
    return np.asarray((shapes / values) @ (shapes.T @ F))


def _first_order(system: Mechanics, T_a: Floats, T_b: Floats) -> tuple[Floats, Floats]:
    """Return A and B of the states (eta, b, eta'); the modes' mass is 1."""
    n, m = T_a.shape[1], T_b.shape[1]
    rows = np.hstack([T_a, T_b])
    force = -rows.T @ np.hstack([system.K @ T_a, system.K @ T_b, system.C @ T_a])  # of states on (a, b)
    F = rows.T @ system.F
    C_bb, C_ab = T_b.T @ system.C @ T_b, T_a.T @ system.C @ T_b
    rate_b, inputs_b = np.linalg.solve(C_bb, force[n:]), np.linalg.solve(C_bb, F[:, n:])
    A = np.zeros((2 * n + m, 2 * n + m))
    A[:n, n + m :] = np.eye(n)
    A[n : n + m] = rate_b
    A[n + m :] = force[:n] - C_ab @ rate_b
    B = np.zeros((3, 2 * n + m, F.shape[2]))
    B[:, n : n + m] = inputs_b
    B[:, n + m :] = F[:, :n] - C_ab @ inputs_b
    return A, B


def _names(modes: int, relaxing: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of the states: modal coordinates are in sqrt(kg) m."""
    names = [
        *(f"mode_{k}" for k in range(1, modes + 1)),
        *(f"relaxation_{k}" for k in range(1, relaxing + 1)),
        *(f"mode_{k}_rate" for k in range(1, modes + 1)),
    ]
    units = ["kg^0.5 m"] * modes + ["m, rad"] * relaxing + ["kg^0.5 m/s"] * modes
    return tuple(names), tuple(units)
