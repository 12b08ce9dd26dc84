r"""Equation (1): nonlinear modal equations of one flexible link.

    (I + qᵀ Cw q Ca) qdd + (2 qdᵀ Cw q I - Cw q qdᵀ) Ca qd + D qd + Ω q
        = p (τ_appl + τ_fric) + Q_g(q)                                                     (1)

with Ca = α αᵀ and Cw of `modal_basis`, Ω = diag(ω_i²), p_i = φ_i'(0), modal damping D = diag(2 ζ_i
ω_i), and gravity, whose potential to second order in the deflection is

    V = g (S cos θ - bᵀ q sin θ - ½ qᵀ N q cos θ),   θ = αᵀ q + θ_0                        (N1)

with b = B but b_0 = 0, θ from the upright vertical and θ_0 = π where angles are measured from the
hanging one. The bracket of the gyroscopic forces is printed in [GagarinaSasia2008] without the
factor 2; it follows from d/dt(qᵀ Cw q) = 2 qdᵀ Cw q, and without it neither energy nor angular
momentum is conserved. `printed=True` gives the printed form. Derivation: docs/theory.md, "Equation
(1)". SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexarm.analytic.modal_basis import ModalBasis
from flexarm.errors import InvalidParameter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModalArm:
    """The common part of equations (1) and (2): shapes, damping, gravity, posture."""

    basis: ModalBasis
    """Shapes and their integrals."""
    damping_ratio: float | Sequence[float] = 0.0
    """ζ of each bending mode [-], one for all or n values."""
    gravity: float = 9.81
    """g [m/s²], downwards."""
    hanging: bool = False
    """Angles count from the hanging vertical instead of the upright one. Positive angles turn z towards x."""

    def __post_init__(self) -> None:
        ratios = np.asarray(self.damping_ratio, dtype=float)
        if ratios.shape not in ((), (self.basis.n_modes - 1,)):
            raise InvalidParameter(
                f"damping ratio must be one number or {self.basis.n_modes - 1}, one a bending mode, "
                f"got shape {ratios.shape}"
            )
        if not np.all(np.isfinite(ratios) & (ratios >= 0)):
            raise InvalidParameter(f"damping ratio must be zero or positive, got {self.damping_ratio}")
        if not math.isfinite(self.gravity):
            raise InvalidParameter(f"gravity must be finite, got {self.gravity} m/s²")

    @cached_property
    def damping(self) -> Array:
        """Diagonal of D, 2 ζ_i ω_i [rad/s]; zero for the rigid rotation."""
        ratios = np.broadcast_to(self.damping_ratio, self.basis.n_modes - 1)
        return 2 * np.append(0.0, ratios) * self.basis.omega

    @property
    def zero_angle(self) -> float:
        """θ_0 [rad], the angle of q = 0 from the upright vertical."""
        return math.pi if self.hanging else 0.0

    def frame_angle(self, q: Array) -> Array:
        """Return θ of (N1) [rad] for coordinates of shape (..., n + 1)."""
        return q @ self.basis.rotation + self.zero_angle

    def elastic_forces(self, q: Array, v: Array) -> Array:
        """Return -Ω q - D v."""
        return -(self.basis.omega**2) * q - self.damping * v


@dataclass(frozen=True)
class NonlinearModal(ModalArm):
    """Equation (1) of one link."""

    printed: bool = False
    """Leave the factor 2 out of the gyroscopic forces, as printed in the paper; for comparison only."""

    def coupling(self, q: Array) -> float:
        """Return the scalar c = qᵀ Cw q, so that the mass matrix is I + c α αᵀ."""
        return float(q @ self.basis.Cw @ q)

    def forces(self, q: Array, v: Array, drive_angle: float | None = None) -> Array:
        """Return every force of (1) but those at the joint; `drive_angle` is not used."""
        return self.elastic_forces(q, v) - self.gyroscopic_forces(q, v) + self.gravity_forces(q)

    def gyroscopic_forces(self, q: Array, v: Array) -> Array:
        """Return (2 qdᵀ Cw q I - Cw q qdᵀ) Ca qd."""
        rate = float(self.basis.rotation @ v)
        Cw_q = self.basis.Cw @ q
        factor = 1.0 if self.printed else 2.0
        return factor * float(v @ Cw_q) * rate * self.basis.rotation - rate**2 * Cw_q  # eq. (1)

    def gravity_forces(self, q: Array) -> Array:
        """Return Q_g = -dV/dq with (N1)."""
        basis, theta = self.basis, float(self.frame_angle(q))
        s, c = math.sin(theta), math.cos(theta)
        Nq = basis.gravity_stiffness @ q
        turning = basis.link.static_moment * s + self._bending_load @ q * c - q @ Nq / 2 * s
        return self.gravity * (turning * basis.rotation + self._bending_load * s + Nq * c)

    def gravity_tangent(self, q: Array, drive_angle: float | None = None) -> Array:
        """Return dQ_g/dq, symmetric; `drive_angle` is not used."""
        basis, theta = self.basis, float(self.frame_angle(q))
        s, c = math.sin(theta), math.cos(theta)
        Nq, load = basis.gravity_stiffness @ q, self._bending_load
        turning = basis.link.static_moment * c - load @ q * s - q @ Nq / 2 * c
        across = np.outer(basis.rotation, load * c - Nq * s)
        tangent: Array = turning * basis.Ca + across + across.T + basis.gravity_stiffness * c
        return self.gravity * tangent

    def energies(self, q: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return the kinetic, elastic and gravity energy [J] of states of shape (..., n + 1)."""
        basis, theta = self.basis, self.frame_angle(q)
        coupling = np.einsum("...i,ij,...j", q, basis.Cw, q)
        kinetic = (np.sum(v**2, axis=-1) + coupling * (v @ basis.rotation) ** 2) / 2
        elastic = np.sum((basis.omega * q) ** 2, axis=-1) / 2
        sag = np.einsum("...i,ij,...j", q, basis.gravity_stiffness, q) / 2
        height = (basis.link.static_moment - sag) * np.cos(theta) - q @ self._bending_load * np.sin(theta)
        return kinetic, elastic, self.gravity * height

    @cached_property
    def _bending_load(self) -> Array:
        """Load b of (N1)."""
        load = self.basis.gravity_load.copy()
        load[0] = 0.0
        return load
