"""The arm between two samples: the true values of its sensors, and its motor torques.

With derivatives every value is a `flexarm.control.dual.Dual`, and so are the torques.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexarm import _core
from flexarm.arrays import Floats
from flexarm.control.deflection_sensor import DeflectionSensor
from flexarm.control.dual import Dual, Real, slopes_of, value_of


class Plant:
    """An arm that moves under held torques."""

    n_parameters = 0

    def __init__(self, run: _core.SampledRun) -> None:
        self._run = run

    @property
    def time(self) -> float:
        """Now [s]."""
        return self._run.time

    def angle(self, joint: int, output: bool) -> Real:
        """Return θ (output side) or φ [rad or m]."""
        return float((self._run.joint_angles if output else self._run.drive_angles)[joint])

    def rate(self, joint: int, output: bool) -> Real:
        """Return their rates [rad/s or m/s]."""
        return float((self._run.joint_rates if output else self._run.drive_rates)[joint])

    def deflection(self, sensor: DeflectionSensor) -> Real:
        """Return the reading of a deflection sensor without errors [m]."""
        return sensor.read(*self.seen_by(sensor))

    def seen_by(self, sensor: DeflectionSensor) -> tuple[Floats, Floats]:
        """Return the position of a sensor's point [m], and the angles of all joints [rad or m]."""
        return np.asarray(self._run.point_position(sensor.point)), np.asarray(self._run.joint_angles)

    def advance(self, torques: Sequence[Real], n_steps: int) -> None:
        """Advance some steps with motor torques held, one a joint [N m]."""
        self._run.advance(np.array(torques), n_steps)


class DifferentiatedPlant(Plant):
    """The same with the derivatives of all that it shows by `n_parameters`."""

    def __init__(self, run: _core.DifferentiatedSampledRun, n_parameters: int) -> None:
        super().__init__(run.run)
        self._differentiated = run
        self.n_parameters = n_parameters

    def angle(self, joint: int, output: bool) -> Real:
        """Return θ (output side) or φ [rad or m]."""
        run = self._differentiated
        slopes = run.joint_angle_slopes if output else run.drive_angle_slopes
        return Dual(value_of(super().angle(joint, output)), slopes[joint])

    def rate(self, joint: int, output: bool) -> Real:
        """Return their rates [rad/s or m/s]."""
        run = self._differentiated
        slopes = run.joint_rate_slopes if output else run.drive_rate_slopes
        return Dual(value_of(super().rate(joint, output)), slopes[joint])

    def deflection(self, sensor: DeflectionSensor) -> Real:
        """Return the reading of a deflection sensor without errors [m], with its derivatives."""
        by_position, by_angle = sensor.slopes(*self.seen_by(sensor))
        moving = self._differentiated.point_position_slopes(sensor.point)
        turning = self._differentiated.joint_angle_slopes
        return Dual(value_of(super().deflection(sensor)), by_position @ moving + by_angle @ turning)

    def advance(self, torques: Sequence[Real], n_steps: int) -> None:
        """Advance some steps with motor torques and their derivatives held."""
        slopes = np.array([slopes_of(torque, self.n_parameters) for torque in torques])
        self._differentiated.advance(np.array([value_of(torque) for torque in torques]), slopes, n_steps)

    def result(self) -> _core.DifferentiatedRun:
        """Return the run and its derivatives."""
        return self._differentiated.result()
