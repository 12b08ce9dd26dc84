r"""Equation (2): the linear form of equation (1), Ca = Cw = 0.

    qdd + D qd + Ω q = p (τ_appl + τ_fric) + Q_g                                           (2)

Gravity is linear too. Where the drive prescribes an angle φ(t), the load is that of the rigid arm,

    Q_g = g B sin(φ + θ_0)                                                                 (L1)

and under a given torque, where no angle is known beforehand, it is expanded about θ_r = `about`:

    Q_g = Q_g(q_r) + dQ_g/dq (q - q_r),    q_r = (θ_r/φ_0', 0, ..., 0)                     (L2)

Left out: the dependence of inertia on deflection, centrifugal and gyroscopic forces, and in (L1)
the stiffness that gravity adds. Derivation: docs/theory.md, "Equation (2)". SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexarm.analytic.nonlinear_modal import Array, ModalArm, NonlinearModal


@dataclass(frozen=True)
class LinearModal(ModalArm):
    """Equation (2) of one link."""

    about: float = 0.0
    """Angle θ_r of (L2) [rad], counted like all angles of this arm; used with a torque drive only."""

    def coupling(self, q: Array) -> float:
        """Return zero: the mass matrix is the identity."""
        return 0.0

    def forces(self, q: Array, v: Array, drive_angle: float | None = None) -> Array:
        """Return every force of (2) but those at the joint."""
        return self.elastic_forces(q, v) + self.gravity_forces(q, drive_angle)

    def gravity_forces(self, q: Array, drive_angle: float | None = None) -> Array:
        """Return (L1) under a prescribed angle, else (L2)."""
        if drive_angle is None:
            start, tangent, q_r = self._expansion
            return start + tangent @ (q - q_r)  # eq. (L2)
        load: Array = self.gravity * self.basis.gravity_load * math.sin(drive_angle + self.zero_angle)
        return load  # eq. (L1)

    @cached_property
    def _expansion(self) -> tuple[Array, Array, Array]:
        """Q_g, dQ_g/dq and q_r of (L2)."""
        exact = NonlinearModal(self.basis, self.damping_ratio, self.gravity, self.hanging)
        q_r = np.zeros(self.basis.n_modes)
        q_r[0] = self.about / self.basis.rotation[0]
        return exact.gravity_forces(q_r), exact.gravity_tangent(q_r), q_r

    def gravity_tangent(self, q: Array, drive_angle: float | None = None) -> Array:
        """Return dQ_g/dq: zero in (L1)."""
        return self._expansion[1] if drive_angle is None else np.zeros_like(self.basis.Cw)
