r"""An arm with its drive as first-order equations.

With q = e φ + T y (see `statics`), f all forces but the joint's and p τ the joint's,

    (I + c a aᵀ) ydd = Tᵀ [f + p τ - (e + c α αᵀ e) φ_ddot],    a = Tᵀ α                   (M1)
    (I + c a aᵀ)^-1 = I - c/(1 + c aᵀ a) a aᵀ                                              (M2)

because the mass matrix differs from the identity by one outer product. Where the hub follows φ, Tᵀ
p = 0 and the torque is the multiplier pᵀ [(I + c α αᵀ) qdd - f]/pᵀ p. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.analytic.drives import JointTorque, MotorAngle
from flexarm.analytic.linear_modal import LinearModal
from flexarm.analytic.motion import ArmMotion, make_motion
from flexarm.analytic.nonlinear_modal import Array
from flexarm.analytic.statics import Equation, Freedom, stiffness_matrix

Drive = MotorAngle | JointTorque


@dataclass(frozen=True)
class JointedArm:
    """An arm with its drive as first-order equations in z = (y, ydot)."""

    arm: Equation
    drive: Drive
    freedom: Freedom

    @classmethod
    def of(cls, arm: Equation, drive: Drive) -> JointedArm:
        """Choose what is free: all coordinates, or those that leave the hub where the motor is."""
        rigid = isinstance(drive, MotorAngle) and drive.rigid
        return cls(arm, drive, Freedom.hub_prescribed(arm) if rigid else Freedom.all(arm))

    def reduce(self, t: float, q: Array, v: Array) -> Array:
        """State z of coordinates and rates; what the drive prescribes is taken out."""
        e, T = self.freedom.rigid, self.freedom.free
        phi, rate = self._phi(t, 0) or 0.0, self._phi(t, 1) or 0.0
        return np.concatenate([T.T @ (q - e * phi), T.T @ (v - e * rate)])

    def expand(self, t: float, z: Array) -> tuple[Array, Array]:
        """Coordinates q and their rates."""
        e, T = self.freedom.rigid, self.freedom.free
        y, u = np.split(z, 2)
        phi, rate = self._phi(t, 0) or 0.0, self._phi(t, 1) or 0.0
        return e * phi + T @ y, e * rate + T @ u

    def rhs(self, t: float, z: Array) -> Array:
        """dz/dt, eq. (M1)."""
        q, v = self.expand(t, z)
        e, T, alpha = self.freedom.rigid, self.freedom.free, self.arm.basis.rotation
        c, a = self.arm.coupling(q), T.T @ alpha
        prescribed = (e + c * (alpha @ e) * alpha) * (self._phi(t, 2) or 0.0)
        force = T.T @ (self._forces(t, q, v) - prescribed)
        acceleration = force - a * (c * (a @ force) / (1 + c * (a @ a)))  # eq. (M2)
        return np.concatenate([z[len(z) // 2 :], acceleration])

    def linear_part(self) -> Array:
        """A of z' = A z + N(t, z): springs, dampers and, in equation (2), gravity's constant tangent."""
        T, p = self.freedom.free, self.arm.basis.hub_slope
        spring, damper = 0.0, 0.0
        if isinstance(self.drive, MotorAngle) and not self.drive.rigid:
            spring, damper = self.drive.stiffness, self.drive.damping
        K = np.diag(self.arm.basis.omega**2) + spring * np.outer(p, p)
        if isinstance(self.arm, LinearModal):
            K = stiffness_matrix(self.arm, np.zeros_like(p), spring, self._phi(0.0, 0))
        D = np.diag(self.arm.damping) + damper * np.outer(p, p)
        zero, one = np.zeros((T.shape[1],) * 2), np.eye(T.shape[1])
        return np.block([[zero, one], [-T.T @ K @ T, -T.T @ D @ T]])

    def torque(self, t: float, z: Array) -> float:
        """The drive's torque on the hub [N m], friction excluded."""
        q, v = self.expand(t, z)
        if isinstance(self.drive, MotorAngle) and self.drive.rigid:
            return self._reaction(t, z, q, v)
        return self._torque(t, q, v)

    def motion(self, time: Array, z: Array) -> ArmMotion:
        """Coordinates, torque and tip at every time."""
        states = [self.expand(t, row) for t, row in zip(time, z, strict=True)]
        q, v = (np.array(part) for part in zip(*states, strict=True))
        torque = np.array([self.torque(t, row) for t, row in zip(time, z, strict=True)])
        phi = np.array([self.drive.angle(t) for t in time]) if isinstance(self.drive, MotorAngle) else None
        return make_motion(self.arm, time, q, v, phi, torque)

    def _phi(self, t: float, derivative: int) -> float | None:
        return float(self.drive.angle(t, derivative)) if isinstance(self.drive, MotorAngle) else None

    def _forces(self, t: float, q: Array, v: Array) -> Array:
        p = self.arm.basis.hub_slope
        friction = self.drive.friction(float(p @ v)) if self.drive.friction else 0.0
        total: Array = self.arm.forces(q, v, self._phi(t, 0)) + p * (self._torque(t, q, v) + friction)
        return total

    def _torque(self, t: float, q: Array, v: Array) -> float:
        drive, p = self.drive, self.arm.basis.hub_slope
        if isinstance(drive, JointTorque):
            return drive(t)
        if drive.rigid:
            return 0.0  # a reaction, orthogonal to all that is free
        twist, rate = float(drive.angle(t)) - p @ q, float(drive.angle(t, 1)) - p @ v
        return float(drive.stiffness * twist + drive.damping * rate)

    def _reaction(self, t: float, z: Array, q: Array, v: Array) -> float:
        e, T, alpha = self.freedom.rigid, self.freedom.free, self.arm.basis.rotation
        acceleration = e * (self._phi(t, 2) or 0.0) + T @ self.rhs(t, z)[len(z) // 2 :]
        inertia = acceleration + self.arm.coupling(q) * (alpha @ acceleration) * alpha
        p = self.arm.basis.hub_slope
        return float(p @ (inertia - self._forces(t, q, v)) / (p @ p))
