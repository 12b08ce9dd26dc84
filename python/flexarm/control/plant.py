"""The arm between two samples: what sensors could see of it, and the torques that it is told.

With derivatives every value is a `flexarm.control.dual.Dual`, and so are the torques.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexarm import _core
from flexarm.control.dual import Dual, Real, slopes_of, value_of
from flexarm.control.gauge import DeflectionGauge

Gauges = Sequence[tuple[DeflectionGauge, DeflectionGauge]]


class Plant:
    """An arm that moves under held torques.

    Parameters
    ----------
    run : SampledRun
        Of the core.
    """

    n_parameters = 0

    def __init__(self, run: _core.SampledRun) -> None:
        self._run = run

    @property
    def time(self) -> float:
        """Now [s]."""
        return self._run.time

    def angle(self, joint: int, output: bool) -> Real:
        """θ (output side) or φ [rad or m]."""
        return float((self._run.joint_angles if output else self._run.drive_angles)[joint])

    def rate(self, joint: int, output: bool) -> Real:
        """Their rates [rad/s or m/s]."""
        return float((self._run.joint_rates if output else self._run.drive_rates)[joint])

    def deflection(self, gauge: DeflectionGauge, beside: Gauges = ()) -> Real:
        """What a gauge without errors shows [m]; `beside` are those of the models beside the arm."""
        position = np.asarray(self._run.point_position(gauge.point))
        return gauge.read(position, np.asarray(self._run.joint_angles))

    def advance(self, torques: Sequence[Real], n_steps: int) -> None:
        """Steps with motor torques held, one a joint [N m]."""
        self._run.advance(np.array(torques), n_steps)


class DifferentiatedPlant(Plant):
    """The same with the derivatives of all that it shows.

    Parameters
    ----------
    run : DifferentiatedSampledRun
        Of the core.
    changes : sequence of (float, float)
        By how much the models beside the arm have more of each parameter, and less.
    """

    def __init__(self, run: _core.DifferentiatedSampledRun, changes: Sequence[tuple[float, float]]) -> None:
        super().__init__(run.run)
        self._differentiated = run
        self._changes = changes
        self.n_parameters = len(changes)

    def angle(self, joint: int, output: bool) -> Real:
        """θ (output side) or φ [rad or m]."""
        run = self._differentiated
        slopes = run.joint_angle_slopes if output else run.drive_angle_slopes
        return Dual(value_of(super().angle(joint, output)), slopes[joint])

    def rate(self, joint: int, output: bool) -> Real:
        """Their rates [rad/s or m/s]."""
        run = self._differentiated
        slopes = run.joint_rate_slopes if output else run.drive_rate_slopes
        return Dual(value_of(super().rate(joint, output)), slopes[joint])

    def deflection(self, gauge: DeflectionGauge, beside: Gauges = ()) -> Real:
        """What a gauge without errors shows [m], by differences of both models along the motion."""
        position = np.asarray(self._run.point_position(gauge.point))
        angles = np.asarray(self._run.joint_angles)
        moving = self._differentiated.point_position_slopes(gauge.point)
        turning = self._differentiated.joint_angle_slopes
        slopes = np.empty(self.n_parameters)
        for k, ((above, below), (up, down)) in enumerate(zip(beside, self._changes, strict=True)):
            high = above.read(position + up * moving[:, k], angles + up * turning[:, k])
            low = below.read(position + down * moving[:, k], angles + down * turning[:, k])
            slopes[k] = (high - low) / (up - down)
        return Dual(gauge.read(position, angles), slopes)

    def advance(self, torques: Sequence[Real], n_steps: int) -> None:
        """Steps with motor torques and their derivatives held."""
        slopes = np.array([slopes_of(torque, self.n_parameters) for torque in torques])
        self._differentiated.advance(np.array([value_of(torque) for torque in torques]), slopes, n_steps)

    def result(self) -> _core.DifferentiatedRun:
        """The run and its derivatives."""
        return self._differentiated.result()
