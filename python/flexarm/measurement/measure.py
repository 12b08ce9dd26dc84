"""Virtual measurements: a record as sensors would write it of a simulated motion.

    instants   t_k + jitter e,   t_k = t_0 + start + k/rate_hz                                       (1)
    values     reading at (1) + noise_std e, rounded to `step`; a share `drop_out` of them is lost   (2)
    stamps     t + rate (t - t_0) + delay,   t = t_k + latency                                       (3)

t_0 is the start of the run, e are independent normal numbers, (delay, rate) the error of the sensor's clock.
The stamp knows nothing of the jitter. Effects of the model on sensors, clocks and frames act as
`flexarm.measurement.effects_of` says, where the noise has its place among them; what a record states of
noise, clocks and frames does not know them.
Every random number comes from the generator that is passed in, sensor by sensor in their order.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arguments import NAMES, SENSORS, takes
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import EXACT, ClockError
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.encoder import quantised, told
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.predict import read

if TYPE_CHECKING:
    from flexarm.arm.sensor import Sensor
    from flexarm.record import Clock, Frame, Record, Signal


@takes(sensors=SENSORS, drive=NAMES)
def measure(
    simulation: Any,
    sensors: Iterable[Sensor],
    rng: np.random.Generator,
    *,
    drive: Iterable[str] = (),
    clocks: Mapping[str, Clock] | None = None,
    frames: Mapping[str, Frame] | None = None,
    clock_errors: Mapping[str, ClockError] | None = None,
    registrations: Mapping[str, Registration] | None = None,
    description: str = "",
    **tables: Any,
) -> Record:
    """Return a record of a simulated motion as its sensors measure it.

    Parameters
    ----------
    simulation : Simulation
        The motion.
    sensors : iterable of Sensor
        What measures; `arm.sensors` for those of the model.
    rng : numpy.random.Generator
        Source of all noise.
    drive : iterable of str
        Names of the sensors whose signals drive a simulation of the record.
    clocks, frames : dict, optional
        What the record states about clocks and frames; those that sensors name and nobody states are exact.
        The first clock is the reference.
    clock_errors : dict of str to ClockError, optional
        How clocks really differ from the time of the run, those left out by nothing; default: by the
        offsets that `clocks` states.
    registrations : dict of str to Registration, optional
        Where frames really are; default: where `frames` states them.
    description : str
        Of the record.
    **tables
        `joints`, `payloads`, `links`, `controllers` and `base` of the record.

    Returns
    -------
    Record
        Of kind "motion", a signal for each sensor.

    Raises
    ------
    CannotMeasure
        If the simulation does not hold what a sensor measures.

    Examples
    --------
    >>> record = measure(simulation, arm.sensors, np.random.default_rng(1))  # doctest: +SKIP
    """
    from flexarm.record import Clock, Frame, Record

    sensors = list(sensors)
    if not isinstance(rng, np.random.Generator):
        raise InvalidParameter(
            f"rng must be a numpy.random.Generator, got {type(rng).__name__}; "
            "numpy.random.default_rng(seed) makes one"
        )
    stated_clocks = dict(clocks or {"clock": Clock()})
    stated_frames = dict(frames or {})
    reference = next(iter(stated_clocks))
    for sensor in sensors:
        stated_clocks.setdefault(sensor.clock or reference, Clock())
        if sensor.frame not in (None, "base"):
            stated_frames.setdefault(sensor.frame, Frame())
    places = {name: Registration(origin=f.xyz, rpy=f.rpy) for name, f in stated_frames.items()}
    places |= dict(registrations or {})
    if clock_errors is None:
        clock_errors = {name: ClockError(delay=clock.offset) for name, clock in stated_clocks.items()}
    drives = tuple(drive)
    signals = [
        _signal(simulation, sensor, rng, sensor.clock or reference, clock_errors, places, drives)
        for sensor in sensors
    ]
    return Record(
        signals={signal.name: signal for signal in signals},
        drive=drives,
        clocks=stated_clocks,
        frames=stated_frames,
        description=description,
        **tables,
    )


def _signal(
    simulation: Any,
    sensor: Sensor,
    rng: np.random.Generator,
    clock: str,
    clock_errors: Mapping[str, ClockError],
    places: Mapping[str, Registration],
    drives: Collection[str],
) -> Signal:
    """Return the signal that one sensor writes; those that drive show what joints were told."""
    from flexarm.record import Signal

    planned, instants = _instants(simulation, sensor, rng)
    unit, factor = sensor.si if sensor.unit else (_default_unit(simulation.arm, sensor), 1.0)
    seen = effects_of(simulation.arm, sensor, clock)
    place = seen.registration(places.get(sensor.frame or "base", IDENTITY))
    values = seen.sensed(read(simulation, told(simulation, sensor, drives), instants, place))
    values = values + (sensor.noise_std or 0.0) * factor * rng.standard_normal(values.shape)
    values = seen.written(quantised(values, sensor.step * factor))  # eq. (2)
    values[rng.random(len(values)) < sensor.drop_out] = np.nan
    if (off := seen.outliers()) is not None:
        values = off.thrown(values, rng)
    noise_std = (
        None
        if sensor.noise_std is None and not sensor.step
        else np.hypot(sensor.noise_std or 0.0, sensor.step / np.sqrt(12)) * factor
    )
    late = seen.clock(clock_errors.get(clock, EXACT), float(simulation.time[0]))
    stamps = late.stamps(planned + sensor.latency_s)  # eq. (3)
    return Signal(
        name=sensor.name,
        quantity=sensor.quantity,
        values=values,
        time=stamps,
        unit=unit,
        noise_std=noise_std,
        jitter_std=sensor.jitter_std,
        clock=clock,
        **sensor.located,
        time_column=sensor.time,
    )


def _default_unit(arm: Any, sensor: Sensor) -> str:
    """Return the SI unit of a sensor that states none; prismatic joints have units of their own."""
    units = sensor.spec.units
    slides = sensor.joint is not None and arm.joint(sensor.joint).type == "prismatic"
    return units[-1] if slides else units[0]


def _instants(simulation: Any, sensor: Sensor, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return planned and true instants (1), as many as fit into the run."""
    from flexarm.record.step_limit import MOST_STEPS

    first, last = float(simulation.time[0]), float(simulation.time[-1])
    count = int(np.floor((last - first - sensor.start) * sensor.rate_hz * (1 + 1e-12))) + 1
    if count < 1:
        raise InvalidParameter(
            f"sensor {sensor.name!r} starts at {sensor.start:g} s, "
            f"after the end of a run of {last - first:g} s"
        )
    if count > MOST_STEPS:
        what = f"makes {count:.3g} samples of {last - first:g} s; allowed are {MOST_STEPS:.3g}"
        raise InvalidParameter(what, where=f"sensors.{sensor.name}.rate_hz")
    planned = first + sensor.start + np.arange(count) / sensor.rate_hz
    return planned, np.clip(planned + sensor.jitter_std * rng.standard_normal(count), first, last)  # eq. (1)
