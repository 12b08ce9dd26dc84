"""Derivatives of predicted signals: through sensors, clocks and frames.

A run x(p) with derivatives dx/dp is seen by sensors that may depend on p too, y = f(x; p):

    dy/dp = (f(x + d dx/dp; p + d) - f(x - d dx/dp; p - d))/(2 d)                                     (1)

Sensors are linear or smooth in the motion, so that (1) is exact to rounding for most and to d^2 for the
others. Delays and drifts of clocks, registrations and drifts of frames are parameters like any other.
Rounding by an encoder's steps is left out: it has no derivative.

Encoders, torque sensors and trackers read a true value u that is linear in the motion, and show y = g(u; p):
u(dx/dp) is then computed for all parameters at once, and (1) is left to g, if that does anything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexarm.arm.parameter import Parameter, neighbours, path_of
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.measurement import encoder, torque, tracker
from flexarm.measurement.clocks import EXACT, ClockError
from flexarm.measurement.effects_of import SensorEffects, effects_of
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.predict import predict, read
from flexarm.measurement.sampling import columns

_LINEAR: dict[str, Callable[[Any, Any, Floats], Floats]] = {
    "joint_angle": encoder.joint_angle,
    "joint_rate": encoder.joint_rate,
    "motor_torque": torque.motor_torque,
    "position": tracker.base_position,
}
"""Readings that are linear in the run's arrays, and take arrays with a further axis."""


def predict_slopes(
    simulation: Any,
    signal: Any,
    clock: ClockError = EXACT,
    registration: Registration = IDENTITY,
    *,
    stamps: Floats | None = None,
) -> Floats:
    """Return the derivatives of a predicted signal with respect to every parameter of a run or of poses.

    The shape is (n, channels, parameter), SI over the parameter's unit; NaN where the simulation has ended.
    Other arguments are as in `predict`.

    Raise InvalidParameter if the run has no derivatives, and CannotMeasure if the simulation does not hold
    what the signal needs.
    """
    found = simulation.sensitivities
    if found is None:
        raise InvalidParameter("has no derivatives; simulate with sensitivities=[...]", where="simulation")
    if signal.quantity in _LINEAR:
        when = signal.time if stamps is None else stamps
        return _Linear(simulation, signal, when, clock, registration).slopes()
    slopes = []
    for k, parameter in enumerate(found.parameters):
        (above, up), (below, down) = neighbours(simulation.arm, parameter)

        def seen(arm: Any, amount: float, k: int = k) -> Floats:
            arrays = {
                name: getattr(simulation, name) + amount * array[..., k]
                for name, array in found.arrays.items()
            }
            there = replace(simulation, arm=arm, sensitivities=None, **arrays)
            return predict(there, signal, clock, registration, rounded=False, stamps=stamps)

        slopes.append((seen(above, up) - seen(below, down)) / (up - down))  # eq. (1)
    return np.stack(slopes, axis=-1) if slopes else np.empty((*signal.values.shape, 0))


@dataclass(frozen=True)
class _Directions:
    """A run with the derivatives of its arrays in their place, as a linear sensor reads it."""

    simulation: Any

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.simulation, name)
        if name in ("arm", "time", "points", "joints") or found is None:
            return found
        slopes = self.simulation.sensitivities
        if name in slopes.arrays:
            return slopes.arrays[name]
        return np.zeros((*found.shape, len(slopes.parameters)))


@dataclass(frozen=True)
class _Linear:
    """A signal whose true values are linear in the motion."""

    simulation: Any
    signal: Any
    stamps: Floats
    clock: ClockError
    registration: Registration

    def slopes(self) -> Floats:
        """Return dy/dp for all parameters."""
        arm, along = self.simulation.arm, self._along()
        seen = effects_of(arm, self.signal)
        true = self._true(arm, seen)
        slopes = along.copy()
        for k, parameter in enumerate(self.simulation.sensitivities.parameters):
            direct = _changes_sensors(arm, parameter)
            if not direct and not (seen.before or seen.after):
                continue
            (above, up), (below, down) = neighbours(arm, parameter)
            changes = up * along[..., k], down * along[..., k]
            if direct:
                difference = self._shown(above, changes[0]) - self._shown(below, changes[1])
            else:
                difference = seen.reading(true + changes[0], False) - seen.reading(true + changes[1], False)
            slopes[..., k] = difference / (up - down)  # eq. (1)
        return slopes

    def _shown(self, arm: Any, change: Floats) -> Floats:
        """Return the readings of an arm's sensors of the run's own motion, its true values changed."""
        seen = effects_of(arm, self.signal)
        return seen.reading(self._true(arm, seen) + change, rounded=False)

    def _true(self, arm: Any, seen: SensorEffects) -> Floats:
        there = replace(self.simulation, arm=arm, sensitivities=None)
        return read(there, self.signal, self._instants(seen), seen.registration(self.registration))

    def _instants(self, seen: SensorEffects) -> Floats:
        return seen.clock(self.clock, float(self.simulation.time[0])).instants(self.stamps)

    def _along(self) -> Floats:
        """Return u(dx/dp), shape (n, channels, parameter)."""
        seen = effects_of(self.simulation.arm, self.signal)
        directions = _Directions(self.simulation)
        found = _LINEAR[self.signal.quantity](directions, self.signal, self._instants(seen))
        if self.signal.quantity != "position":
            return found
        frame = seen.registration(self.registration)
        turned: Floats = (frame.scale * frame.frame_axes.T @ frame.error_rotation) @ found
        return turned[:, columns(self.signal.axes)]


def _changes_sensors(arm: Any, parameter: Parameter) -> bool:
    """Return True if a parameter changes the readings of the same motion: effects on sensors, gear ratios."""
    from flexarm.sensitivity import moves_arm

    if parameter.drives:
        return False
    return not moves_arm(arm, parameter) or path_of(arm, parameter.key).table in ("joints", "gears")
