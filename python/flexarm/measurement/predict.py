"""Prediction of a sensor's readings in a simulated motion, at given stamps and without noise.

`measure` and `compare` both read simulations here, so a virtual measurement and the prediction of a real one
are the same code. `read` is the perfect sensor; effects of the model on sensors, clocks and frames are those
of `flexarm.measurement.effects_of`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flexarm.arrays import Floats
from flexarm.measurement import deformation, encoder, imu, torque, tracker
from flexarm.measurement.clocks import EXACT, ClockError
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.frames import IDENTITY, Registration
from flexarm.measurement.sampling import CannotMeasure, Described, columns

Reading = Callable[[Any, Described, Floats], Floats]

READINGS: dict[str, Reading] = {
    "joint_angle": encoder.joint_angle,
    "joint_rate": encoder.joint_rate,
    "joint_command": encoder.joint_command,
    "motor_torque": torque.motor_torque,
    "motor_voltage": torque.motor_voltage,
    "inclination": imu.inclination,
    "angular_rate": imu.angular_rate,
    "acceleration": imu.acceleration,
    "strain": deformation.strain,
    "deflection": deformation.deflection,
}
"""Readings that do not depend on a frame of measurement, by quantity."""

FRAMED_READINGS: dict[str, Reading] = {
    "position": tracker.base_position,
    "orientation": tracker.base_orientation,
}
"""Readings that are made in a frame of measurement, here still in the base, by quantity."""


def predict(
    simulation: Any,
    signal: Any,
    clock: ClockError = EXACT,
    registration: Registration = IDENTITY,
    *,
    arm: Any = None,
    rounded: bool = True,
    stamps: Floats | None = None,
) -> Floats:
    """Return the values of a signal in a simulated motion, at its stamps, as the model's sensors show them.

    Parameters
    ----------
    simulation : Simulation
        The motion.
    signal : Signal
        Names the quantity, its place and the stamps.
    clock : ClockError
        How the signal's clock differs from the simulation's time; effects of the model add to it.
    registration : Registration
        The signal's frame; only positions and orientations have one. Effects of the model add to it.
    arm : Arm, optional
        The model whose effects on sensors, clocks and frames count; default: that of the simulation.
    rounded : bool
        False leaves out the effect `encoder_quantisation`: readings then have derivatives.
    stamps : ndarray, shape (n,), optional
        In place of the signal's own: of a static record the number of each row's pose.

    Returns
    -------
    ndarray, shape (n, channels)
        In SI; NaN where the simulation has ended.

    Raises
    ------
    CannotMeasure
        If the simulation does not hold what the signal needs; says what is missing.
    """
    seen = effects_of(getattr(simulation, "arm", None) if arm is None else arm, signal)
    instants = seen.clock(clock, float(simulation.time[0])).instants(
        signal.time if stamps is None else stamps
    )
    return seen.reading(read(simulation, signal, instants, seen.registration(registration)), rounded)


def read(simulation: Any, what: Described, instants: Floats, registration: Registration = IDENTITY) -> Floats:
    """Return the values of a perfect sensor at true instants, shape (n, channels); errors as `predict`."""
    return in_frame(simulation, what, instants, in_base(simulation, what, instants), registration)


def in_base(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return what a perfect sensor would read if its frame were the base; of positions all three axes."""
    reading = FRAMED_READINGS.get(what.quantity) or READINGS.get(what.quantity)
    if reading is None:
        raise CannotMeasure(f"signal {what.name!r}: {what.quantity} is an input, no simulation predicts it")
    return reading(simulation, what, instants)


def in_frame(
    simulation: Any, what: Described, instants: Floats, values: Floats, registration: Registration
) -> Floats:
    """Return readings `in_base` as they are in the sensor's frame, along its axes."""
    if what.quantity == "position":
        elapsed = instants - simulation.time[0] if any(registration.velocity) else 0.0
        return registration.positions(values, elapsed, columns(what.axes))
    return registration.orientations(values) if what.quantity == "orientation" else values
