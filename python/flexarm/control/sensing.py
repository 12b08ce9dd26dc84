"""Readings of a controller: the model's sensors at the sample instants.

    angle    the joint_angle sensor at the joint, motor side before output side, rounded to its step
    rate     the joint_rate sensor at the joint; without one (φ_k - φ_{k-1})/T_s of the readings      (1)
    d, d'    the deflection sensor that the controller names, rounded to its step; d' as (1)

Without an angle sensor both angle and rate are exact, on the motor's side. Effects of the model on the values
of these sensors act (`flexarm.measurement.effects_of`), all but outliers. Noise, rate and latency of a sensor
are those of what is written into a record, and so are delays: the controller reads at its own instants.

With derivatives a sensor that shows g(u; p) of a true value u passes on

    dy/dp = ∂g/∂u du/dp + ∂g/∂p                                                                      (2)

by central differences of g without its rounding, which has no derivative.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.controller import Controller
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats
from flexarm.control.deflection_sensor import DeflectionSensor
from flexarm.control.dual import Dual, Real, value_of
from flexarm.control.laws import Reading
from flexarm.control.plant import Plant
from flexarm.errors import InvalidParameter
from flexarm.measurement.effects_of import SensorEffects, effects_of
from flexarm.measurement.encoder import quantised


class Sensing:
    """The readings of one controller, which names joint and deflection sensor of the arm."""

    def __init__(self, arm: Arm, controller: Controller) -> None:
        self._arm = arm
        self.joint = [joint.name for joint in arm.joints].index(controller.joint)
        self._angle = _sensor(arm, controller.joint, "joint_angle")
        self._rate = _sensor(arm, controller.joint, "joint_rate")
        self._deflection = _deflection(arm, controller)
        self._geometry = DeflectionSensor(arm, self._deflection) if self._deflection is not None else None
        sensors = (self._angle, self._rate, self._deflection)
        self._effects = {sensor.name: effects_of(arm, sensor) for sensor in sensors if sensor is not None}
        self._steps = {sensor.name: sensor.step * sensor.si[1] for sensor in sensors if sensor is not None}
        self._period = controller.sample_time
        self._last: tuple[Real, Real] | None = None

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors that are read."""
        return tuple(self._effects)

    def read(self, plant: Plant) -> Reading:
        """Read the sensors at this instant; differences (1) are zero at the first one."""
        angle = self._shown(self._angle, plant.angle(self.joint, _output(self._angle)))
        deflection = self._shown(self._deflection, self._bent(plant))
        last_angle, last_deflection = self._last or (angle, deflection)
        self._last = angle, deflection
        rate = (angle - last_angle) / self._period  # eq. (1)
        if self._rate or not self._angle:
            rate = self._shown(self._rate, plant.rate(self.joint, _output(self._rate)))
        return Reading(angle, rate, deflection, (deflection - last_deflection) / self._period)

    def true_angle(self, shown: float) -> float:
        """Return the angle at which the angle sensor shows a value, without quantisation; else NaN."""
        if self._angle is None:
            return shown
        return float(self._effects[self._angle.name].true(np.array([[shown]]))[0, 0])

    def _shown(self, sensor: Sensor | None, true: Real) -> Real:
        """Return what a sensor shows of a true value."""
        if sensor is None or not self._errs(sensor):
            return true
        seen, step = self._effects[sensor.name], self._steps[sensor.name]
        return float(seen.written(quantised(seen.sensed(np.array([[true]])), step))[0, 0])

    def _errs(self, sensor: Sensor) -> bool:
        seen = self._effects[sensor.name]
        return bool(seen.before or seen.after or self._steps[sensor.name] > 0)

    def _bent(self, plant: Plant) -> Real:
        """Return the deflection at this instant without errors [m]."""
        return plant.deflection(self._geometry) if self._geometry is not None else 0.0


class DifferentiatedSensing(Sensing):
    """The readings of one controller with their derivatives, eq. (2).

    For each parameter `perturbed` has the model with a little more and a little less of it, and `spreads` by
    how much its two values differ.
    """

    def __init__(
        self, arm: Arm, controller: Controller, perturbed: Sequence[tuple[Arm, Arm]], spreads: Sequence[float]
    ) -> None:
        super().__init__(arm, controller)
        self._changed: dict[str, list[tuple[int, float, SensorEffects, SensorEffects]]] = {}
        self._moved: list[tuple[int, float, DeflectionSensor, DeflectionSensor]] = []
        for k, ((plus, minus), spread) in enumerate(zip(perturbed, spreads, strict=True)):
            up, down = Sensing(plus, controller), Sensing(minus, controller)
            for name in self._effects:
                if up._effects[name] != down._effects[name]:
                    change = (k, spread, up._effects[name], down._effects[name])
                    self._changed.setdefault(name, []).append(change)
            if up._geometry is not None and down._geometry is not None and up._geometry != down._geometry:
                self._moved.append((k, spread, up._geometry, down._geometry))

    def _shown(self, sensor: Sensor | None, true: Real) -> Real:
        # Of differences by a true value, in parts of the larger of it and one unit: errors of 1e-11 either
        # way.
        step = 1e-5
        if not isinstance(true, Dual) or sensor is None or not self._errs(sensor):
            return true
        u, seen = true.value, self._effects[sensor.name]
        h = step * max(1.0, abs(u))
        high, low = seen.reading(np.array([[u + h], [u - h]]), rounded=False)[:, 0]
        slopes: Floats = (high - low) / (2 * h) * true.slopes
        at = np.array([[u]])
        for k, spread, plus, minus in self._changed.get(sensor.name, ()):
            slopes[k] += (plus.reading(at, False)[0, 0] - minus.reading(at, False)[0, 0]) / spread
        return Dual(value_of(super()._shown(sensor, u)), slopes)  # eq. (2)

    def _bent(self, plant: Plant) -> Real:
        true = super()._bent(plant)
        if isinstance(true, Dual) and self._geometry is not None:
            seen = plant.seen_by(self._geometry)
            for k, spread, plus, minus in self._moved:
                true.slopes[k] += (plus.read(*seen) - minus.read(*seen)) / spread
        return true


def _output(sensor: Sensor | None) -> bool:
    return sensor is not None and sensor.side == "output"


def _sensor(arm: Arm, joint: str, quantity: str) -> Sensor | None:
    """Return the joint's sensor of that quantity, motor side before output side."""
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
