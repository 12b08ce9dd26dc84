"""What a controller sees of the arm: readings of the model's sensors at the sample instants.

    angle    the joint_angle sensor at the joint, motor side before output side, rounded to its step
    rate     the joint_rate sensor at the joint; without one (φ_k - φ_{k-1})/T_s of the readings      (1)
    d, d'    the deflection sensor that the controller names, rounded to its step; d' as (1)

Without an angle sensor both angle and rate are exact, on the motor's side. Effects of the model on the values
of these sensors act (`flexarm.measurement.effects_of`), all but outliers. Noise, rate and latency of a sensor
are those of what is written into a record, and so are delays: the controller reads at its own instants.
"""

from __future__ import annotations

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.controller import Controller
from flexarm.arm.sensor import Sensor
from flexarm.control.gauge import DeflectionGauge
from flexarm.control.laws import Reading
from flexarm.errors import InvalidParameter
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.encoder import quantised


class Sensing:
    """The readings of one controller.

    Parameters
    ----------
    arm : Arm
        The model.
    controller : Controller
        Names joint and deflection sensor.
    """

    def __init__(self, arm: Arm, controller: Controller) -> None:
        self._arm = arm
        self._joint = [joint.name for joint in arm.joints].index(controller.joint)
        self._angle = _sensor(arm, controller.joint, "joint_angle")
        self._rate = _sensor(arm, controller.joint, "joint_rate")
        self._deflection = _deflection(arm, controller)
        self._gauge = DeflectionGauge(arm, self._deflection) if self._deflection is not None else None
        sensors = (self._angle, self._rate, self._deflection)
        self._effects = {sensor.name: effects_of(arm, sensor) for sensor in sensors if sensor is not None}
        self._steps = {sensor.name: sensor.step * sensor.si[1] for sensor in sensors if sensor is not None}
        self._period = controller.sample_time
        self._last: tuple[float, float] | None = None

    def read(self, run: _core.SampledRun) -> Reading:
        """Reading at this instant; differences (1) are zero at the first one."""
        angle = self._shown(self._angle, self._of_joint(run, self._angle, rate=False))
        deflection = self._bent(run) if self._deflection else 0.0
        last_angle, last_deflection = self._last or (angle, deflection)
        self._last = angle, deflection
        rate = (angle - last_angle) / self._period  # eq. (1)
        if self._rate or not self._angle:
            rate = self._shown(self._rate, self._of_joint(run, self._rate, rate=True))
        return Reading(angle, rate, deflection, (deflection - last_deflection) / self._period)

    def true_angle(self, shown: float) -> float:
        """The angle at which the angle sensor shows a value, its steps aside; NaN where nothing does."""
        if self._angle is None:
            return shown
        return float(self._effects[self._angle.name].true(np.array([[shown]]))[0, 0])

    def _shown(self, sensor: Sensor | None, true: float) -> float:
        """What a sensor shows of a true value."""
        if sensor is None:
            return true
        seen, step = self._effects[sensor.name], self._steps[sensor.name]
        if not (seen.before or seen.after or step > 0):
            return true
        return float(seen.written(quantised(seen.sensed(np.array([[true]])), step))[0, 0])

    def _of_joint(self, run: _core.SampledRun, sensor: Sensor | None, rate: bool) -> float:
        output = sensor is not None and sensor.side == "output"
        if rate:
            return float((run.joint_rates if output else run.drive_rates)[self._joint])
        return float((run.joint_angles if output else run.drive_angles)[self._joint])

    def _bent(self, run: _core.SampledRun) -> float:
        """Deflection as a record would have it, of this one instant [m]."""
        assert self._gauge is not None
        position = np.asarray(run.point_position(self._gauge.point))
        return self._shown(self._deflection, self._gauge.read(position, np.asarray(run.joint_angles)))


def _sensor(arm: Arm, joint: str, quantity: str) -> Sensor | None:
    """The joint's sensor of that quantity, motor side before output side."""
    found = [sensor for sensor in arm.sensors if sensor.joint == joint and sensor.quantity == quantity]
    return min(found, key=lambda sensor: sensor.side != "motor") if found else None


def _deflection(arm: Arm, controller: Controller) -> Sensor | None:
    name = getattr(controller, "deflection", None)
    if name is None:
        return None
    sensor = next(sensor for sensor in arm.sensors if sensor.name == name)
    if len(sensor.axes) != 1:
        raise InvalidParameter(
            f"the controller of {controller.joint!r} feeds back the deflection {name!r}, which must have one "
            f"axis, got {list(sensor.axes)}",
            where=f"sensors.{name}.axes",
        )
    return sensor
