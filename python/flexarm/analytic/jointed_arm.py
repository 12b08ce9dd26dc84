r"""An arm with its drive as first-order equations.

With q = e φ + T y (see `statics`), f all forces but the joint's and p τ the joint's,

    (I + c a aᵀ) ydd = Tᵀ [f + p τ - (e + c α αᵀ e) φ_ddot],    a = Tᵀ α                   (M1)
    (I + c a aᵀ)^-1 = I - c/(1 + c aᵀ a) a aᵀ                                              (M2)

because the mass matrix differs from the identity by one outer product. Where the hub follows φ, Tᵀ
p = 0 and the torque is the multiplier pᵀ [(I + c α αᵀ) qdd - f]/pᵀ p. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flexarm.analytic.drives import JointTorque, MotorAngle
from flexarm.analytic.linear_modal import LinearModal
from flexarm.analytic.motion import ArmMotion, make_motion
from flexarm.analytic.nonlinear_modal import Array
from flexarm.analytic.statics import Equation, Freedom, stiffness_matrix
from flexarm.errors import NotConverged

Drive = MotorAngle | JointTorque
_BEYOND = "the inertia I + c α αᵀ is no longer positive; equation (1) holds for small deflections"


class Motor(NamedTuple):
    """φ, its rate and its acceleration at one time [rad, rad/s, rad/s²]."""

    angle: float
    rate: float
    acceleration: float


_NO_MOTOR = Motor(0.0, 0.0, 0.0)
"""Under a torque no coordinate is prescribed."""


@dataclass(frozen=True)
class JointedArm:
    """An arm with its drive as first-order equations in z = (y, ydot)."""

    arm: Equation
    drive: Drive
    freedom: Freedom

    @classmethod
    def of(cls, arm: Equation, drive: Drive) -> JointedArm:
        """Choose the free coordinates: all, or those that leave the hub where the motor is."""
        rigid = isinstance(drive, MotorAngle) and drive.rigid
        return cls(arm, drive, Freedom.hub_prescribed(arm) if rigid else Freedom.all(arm))

    def reduce(self, t: float, q: Array, v: Array) -> Array:
        """Return the state z of coordinates and rates, without what the drive prescribes."""
        e, T, motor = self.freedom.rigid, self.freedom.free, self._motor(t)
        return np.concatenate([T.T @ (q - e * motor.angle), T.T @ (v - e * motor.rate)])

    def expand(self, z: Array, motor: Motor) -> tuple[Array, Array]:
        """Return the coordinates q and their rates."""
        e, T = self.freedom.rigid, self.freedom.free
        y, u = np.split(z, 2)
        return e * motor.angle + T @ y, e * motor.rate + T @ u

    def rhs(self, t: float, z: Array) -> Array:
        """Return dz/dt, eq. (M1)."""
        motor = self._motor(t)
        q, v = self.expand(z, motor)
        e, T, alpha = self.freedom.rigid, self.freedom.free, self.arm.basis.rotation
        c, a = self.arm.coupling(q), T.T @ alpha
        inertia = 1 + c * (a @ a)
        if inertia <= 0:
            raise NotConverged(f"t = {t:.4g} s: bent so far that {_BEYOND}", time=t)
        prescribed = (e + c * (alpha @ e) * alpha) * motor.acceleration
        force = T.T @ (self._forces(t, q, v, motor) - prescribed)
        acceleration = force - a * (c * (a @ force) / inertia)  # eq. (M2)
        return np.concatenate([z[len(z) // 2 :], acceleration])

    def linear_part(self) -> Array:
        """Return A of z' = A z + N(t, z): springs, dampers and, in (2), gravity's constant tangent."""
        T, p = self.freedom.free, self.arm.basis.hub_slope
        spring, damper = 0.0, 0.0
        if isinstance(self.drive, MotorAngle) and not self.drive.rigid:
            spring, damper = self.drive.stiffness, self.drive.damping
        K = np.diag(self.arm.basis.omega**2) + spring * np.outer(p, p)
        if isinstance(self.arm, LinearModal):
            angle = 0.0 if isinstance(self.drive, MotorAngle) else None  # gravity: (L1) or (L2)
            K = stiffness_matrix(self.arm, np.zeros_like(p), spring, angle)
        D = np.diag(self.arm.damping) + damper * np.outer(p, p)
        zero, one = np.zeros((T.shape[1],) * 2), np.eye(T.shape[1])
        return np.block([[zero, one], [-T.T @ K @ T, -T.T @ D @ T]])

    def motion(self, time: Array, z: Array) -> ArmMotion:
        """Return coordinates, torque and tip at every time."""
        motors = [self._motor(t) for t in time]
        states = [self.expand(row, motor) for row, motor in zip(z, motors, strict=True)]
        q, v = (np.array(part) for part in zip(*states, strict=True))
        torque = np.array([self.torque(t, row) for t, row in zip(time, z, strict=True)])
        angles = np.array([motor.angle for motor in motors]) if isinstance(self.drive, MotorAngle) else None
        return make_motion(self.arm, time, q, v, angles, torque)

    def torque(self, t: float, z: Array) -> float:
        """Return the drive's torque on the hub [N m], friction excluded."""
        motor = self._motor(t)
        q, v = self.expand(z, motor)
        if not (isinstance(self.drive, MotorAngle) and self.drive.rigid):
            return self._torque(t, q, v, motor)
        e, T = self.freedom.rigid, self.freedom.free
        alpha, p = self.arm.basis.rotation, self.arm.basis.hub_slope
        acceleration = e * motor.acceleration + T @ self.rhs(t, z)[len(z) // 2 :]
        inertia = acceleration + self.arm.coupling(q) * (alpha @ acceleration) * alpha
        return float(p @ (inertia - self._forces(t, q, v, motor)) / (p @ p))

    def _motor(self, t: float) -> Motor:
        if isinstance(self.drive, JointTorque):
            return _NO_MOTOR
        angle = self.drive.angle
        return Motor(float(angle(t)), float(angle(t, 1)), float(angle(t, 2)))

    def _forces(self, t: float, q: Array, v: Array, motor: Motor) -> Array:
        p = self.arm.basis.hub_slope
        friction = self.drive.friction(float(p @ v)) if self.drive.friction else 0.0
        angle = None if motor is _NO_MOTOR else motor.angle
        return self.arm.forces(q, v, angle) + p * (self._torque(t, q, v, motor) + friction)

    def _torque(self, t: float, q: Array, v: Array, motor: Motor) -> float:
        drive, p = self.drive, self.arm.basis.hub_slope
        if isinstance(drive, JointTorque):
            return drive(t)
        if drive.rigid:
            return 0.0  # a reaction, orthogonal to all that is free
        return float(drive.stiffness * (motor.angle - p @ q) + drive.damping * (motor.rate - p @ v))
