"""Plausibility rules of virtual sensors.

noise    of a place a tenth of the reach of the arm, of an angle 0.2 rad: millimetres or degrees meant
rate     `quickest`: strain gauges and IMUs are sampled at some ten kHz at most
jitter   of a stamp more than the time between samples, so that stamps would not rise
latency  `LATEST`: milliseconds meant
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.arm.sensor import Sensor

LATEST = 10.0
"""Age of a value at its stamp [s]."""


def sensor_problems(sensor: Sensor, reach: float) -> Iterable[Problem]:
    """Yield implausible values of a sensor of an arm with this reach [m]."""
    quickest = 1e5  # samples a second [Hz]
    part, turned = 0.1, 0.2  # greatest noise of a place, over the reach; of an angle [rad]
    where = f"sensors.{sensor.name}"
    unit, factor = sensor.si
    noise = (sensor.noise_std or 0.0) * factor
    most = {"m": part * reach, "rad": turned}.get(unit, 0.0)
    if 0 < most < noise:
        what = f"is {noise:g} {unit} (1 sigma); it is in the unit of the sensor, {sensor.unit or unit}"
        yield Problem(f"{where}.noise_std", what)
    if sensor.rate_hz > quickest:
        yield Problem(f"{where}.rate_hz", f"is {sensor.rate_hz:g} Hz; no sensor of an arm samples so quickly")
    if sensor.jitter_std > 1 / sensor.rate_hz:
        what = f"is {sensor.jitter_std:g} s (1 sigma), samples are {1 / sensor.rate_hz:.3g} s apart"
        yield Problem(f"{where}.jitter_std", f"{what}; it is in s, not in ms")
    if sensor.latency_s > LATEST:
        yield Problem(f"{where}.latency_s", f"is {sensor.latency_s:g} s; it is in s, not in ms")
