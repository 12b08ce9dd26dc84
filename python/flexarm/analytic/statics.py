r"""Equilibrium of equation (1) at a held motor angle, and small vibrations about it.

At rest (1) reads, with the joint's spring k between the held angle φ and the hub angle pᵀ q,

    Ω q - Q_g(q) - p k (φ - pᵀ q) = 0                                                      (S1)

or, for k = inf, the constraint pᵀ q = φ. Both are solved as q = e φ + T y, with e the rigid
rotation by one radian and T an orthonormal basis of what φ leaves free: everything for a spring, pᵀ
T = 0 for a rigid joint. Vibrations about the solution:

    (I + c α αᵀ) qdd + (Ω - dQ_g/dq + k p pᵀ) q = 0                                        (S2)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from flexarm.analytic.linear_modal import LinearModal
from flexarm.analytic.nonlinear_modal import Array, NonlinearModal
from flexarm.errors import InvalidParameter, NotConverged

Equation = NonlinearModal | LinearModal


@dataclass(frozen=True)
class Freedom:
    """q = e φ + T y: the coordinates that a drive leaves free."""

    rigid: Array
    """e, the rigid rotation by one radian; zero where φ is no coordinate, shape (n + 1,)."""
    free: Array
    """T, orthonormal columns, shape (n + 1, m)."""

    @classmethod
    def all(cls, arm: Equation) -> Freedom:
        """Free every coordinate: a torque or a spring acts at the hub."""
        return cls(np.zeros(arm.basis.n_modes), np.eye(arm.basis.n_modes))

    @classmethod
    def hub_prescribed(cls, arm: Equation) -> Freedom:
        """Prescribe the hub angle: pᵀ q is φ."""
        p = arm.basis.hub_slope
        free = np.linalg.svd(p[None, :])[2][1:].T
        return cls(rigid_rotation(arm), free)


def rigid_rotation(arm: Equation) -> Array:
    """Return e, the coordinates of the rigid rotation by one radian."""
    e = np.zeros(arm.basis.n_modes)
    e[0] = 1 / arm.basis.rotation[0]
    return e


def equilibrium(arm: Equation, drive_angle: float, stiffness: float = math.inf) -> Array:
    """Return the coordinates q at rest under a held motor angle φ [rad], on a spring k [N m/rad]; inf: rigid.

    Raise NotConverged if Newton's iterations find no equilibrium (the arm buckles, or the spring is too soft
    for the load).
    """
    max_iterations = 50
    if not stiffness > 0:
        raise InvalidParameter(f"joint stiffness must be positive (inf: rigid), got {stiffness} N m/rad")
    rigid = math.isinf(stiffness)
    freedom = Freedom.hub_prescribed(arm) if rigid else Freedom.all(arm)
    T, p, spring = freedom.free, arm.basis.hub_slope, 0.0 if rigid else stiffness
    rest = np.zeros(arm.basis.n_modes)
    q = rigid_rotation(arm) * drive_angle
    for _ in range(max_iterations):
        force = arm.forces(q, rest, drive_angle) + p * spring * (drive_angle - p @ q)  # eq. (S1)
        tangent = T.T @ stiffness_matrix(arm, q, spring, drive_angle) @ T
        step = T @ np.linalg.solve(tangent, T.T @ force)
        q = q + step
        size = float(np.linalg.norm(step))
        if size <= 1e-13 * (1 + float(np.linalg.norm(q))):
            return q
    raise NotConverged(
        f"equilibrium at {drive_angle} rad: step {size:.1e} after {max_iterations} Newton iterations",
        iteration=max_iterations,
        residual=float(np.linalg.norm(T.T @ force)),
    )


def stiffness_matrix(arm: Equation, q: Array, spring: float, drive_angle: float | None) -> Array:
    """Return Ω - dQ_g/dq + k p pᵀ of (S2)."""
    p = arm.basis.hub_slope
    tangent = arm.gravity_tangent(q, drive_angle)
    return np.diag(arm.basis.omega**2) - tangent + spring * np.outer(p, p)


def small_vibrations_hz(arm: Equation, drive_angle: float, stiffness: float = math.inf) -> Array:
    """Return the frequencies [Hz] of (S2) about the equilibrium at a held motor angle, rising.

    Raise NotConverged if the equilibrium is unstable or is not found.
    """
    from scipy.linalg import eigh

    q = equilibrium(arm, drive_angle, stiffness)
    rigid = math.isinf(stiffness)
    T = (Freedom.hub_prescribed(arm) if rigid else Freedom.all(arm)).free
    alpha = T.T @ arm.basis.rotation
    mass = np.eye(T.shape[1]) + arm.coupling(q) * np.outer(alpha, alpha)
    squares = eigh(T.T @ stiffness_matrix(arm, q, 0.0 if rigid else stiffness, drive_angle) @ T, mass)[0]
    if squares[0] < 0:
        raise NotConverged(f"equilibrium at {drive_angle} rad is unstable: ω² = {squares[0]:.3g} rad²/s²")
    frequencies: Array = np.sqrt(squares) / (2 * math.pi)
    return frequencies
