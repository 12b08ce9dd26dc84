"""The record that a simulation leaves behind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.measurement.frames import Registration
from flexarm.measurement.measure import measure
from flexarm.measurement.predict import FRAMED_READINGS, READINGS, predict
from flexarm.record import Record, Signal

if TYPE_CHECKING:
    from flexarm.arm import Arm


def virtual_record(run: Any, arm: Arm, driven_by: Record | None, seed: int) -> Record:
    """What the sensors saw of a run.

    Parameters
    ----------
    run : Simulation
        The run.
    arm : Arm
        Its sensors measure, with noise; without sensors every point's position is stored, one row a step.
    driven_by : Record or None
        The record that drove the run: then its signals at its instants, without noise.
    seed : int
        Seed of the sensors' noise.

    Returns
    -------
    Record
        With the drive as a joint_angle signal of every joint.
    """
    if driven_by is not None:
        signals = {name: _again(signal, run, driven_by) for name, signal in driven_by.signals.items()}
        return driven_by.replace(signals=signals, description=f"simulation of {arm.name}", path=None)
    seen = measure(run, arm.sensors, np.random.default_rng(seed))
    signals = dict(seen.signals) or {name: _position(run, i, name) for i, name in enumerate(run.points)}
    drives = [_drive(run, i, name, signals) for i, name in enumerate(run.joints)]
    return seen.replace(
        signals={**{signal.name: signal for signal in drives}, **signals},
        drive=tuple(signal.name for signal in drives),
        description=f"simulation of {arm.name}",
    )


def _again(signal: Signal, run: Any, record: Record) -> Signal:
    """A signal of the record as the simulation has it; what went into the simulation stays as it was."""
    if signal.quantity not in READINGS and signal.quantity not in FRAMED_READINGS:
        return signal
    if signal.name in record.drive and signal.quantity != "joint_angle":
        return signal
    frame = record.frame_of(signal)
    return signal.replace(
        values=predict(run, signal, registration=Registration(origin=frame.xyz, rpy=frame.rpy))
    )


def _position(run: Any, i: int, name: str) -> Signal:
    """Position of a point at every step, base axes."""
    return Signal(
        name=name,
        quantity="position",
        point=name,
        time=run.time,
        values=run.position[:, i],
        noise_std=0.0,
        file="points.csv",
    )


def _drive(run: Any, i: int, joint: str, taken: dict[str, Signal]) -> Signal:
    """The drive of a joint: the motor's angle over the ratio at every step."""
    name = joint if joint not in taken else f"{joint}_drive"
    return Signal(
        name=name,
        quantity="joint_angle",
        joint=joint,
        side="motor",
        time=run.time,
        values=run.drive_angle[:, i],
        noise_std=0.0,
        file="drive.csv",
    )
