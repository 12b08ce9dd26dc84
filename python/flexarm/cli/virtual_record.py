"""The record that a simulation leaves behind, with what the model's sensors, clocks and frames make of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.measurement.clocks import EXACT
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.encoder import follows_late
from flexarm.measurement.measure import measure
from flexarm.measurement.predict import FRAMED_READINGS, READINGS, predict
from flexarm.record import Clock, Record, Signal

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.simulated_record import Placement
    from flexarm.drive import Drive
    from flexarm.simulation import Simulation


CLOCK = "clock"
"""The reference clock of a virtual measurement that is told nothing of clocks."""


def sensed(run: Simulation, arm: Arm, motion: Drive, seed: int) -> Record:
    """Return the readings of the sensors of the model in a run, with noise of a seed.

    Without sensors every point's position is stored, one row a step. The drive of each joint that is driven
    or let go becomes a joint_angle signal: what an encoder of that name shows, without noise.
    """
    seen = measure(run, arm.sensors, np.random.default_rng(seed)) if arm.sensors else _every_point(run)
    drives = [_drive(run, joint, dict(seen.signals)) for joint in motion.joints]
    return seen.replace(
        joints={name: value for name, value in motion.rest.items() if name not in motion.joints},
        initial="equilibrium" if motion.rates is None else "moving",
        signals={**{signal.name: signal for signal in drives}, **seen.signals},
        drive=tuple(signal.name for signal in drives),
        description=f"simulation of {arm.name}",
    )


def simulated(record: Record, run: Simulation, arm: Arm) -> Record:
    """Return the record that drove a run, with its signals as the run has them: its instants, without noise.

    Clocks and frames are as the record states them, offsets and poses included. Where a command drove, the
    motor's angle is added.
    """
    from flexarm.comparison.alignment_parameters import stated_placement

    placement = stated_placement(record)
    signals = {name: _again(signal, run, record, placement) for name, signal in record.signals.items()}
    for driver in (record.signals[name] for name in record.drive):
        if driver.quantity != "joint_angle":  # a command: what the motor made of it is the drive of the arm
            motor = _drive(run, str(driver.joint), signals, driver.clock)
            signals[motor.name] = motor
    return record.replace(signals=signals, description=f"simulation of {arm.name}", path=None)


def _again(signal: Signal, run: Simulation, record: Record, placement: Placement) -> Signal:
    """Return a signal of the record as simulated; inputs of the simulation stay as they were."""
    if signal.quantity not in READINGS and signal.quantity not in FRAMED_READINGS:
        return signal
    late = follows_late(run, signal.joint)
    if signal.name in record.drive and (signal.quantity != "joint_angle" or late):
        return signal
    return signal.replace(values=predict(run, signal, placement.clock(signal), placement.frame(signal)))


def _every_point(run: Simulation) -> Record:
    """Return positions of all points, by the one clock there is."""
    signals = [_position(run, i, name) for i, name in enumerate(run.points)]
    return Record(signals={signal.name: signal for signal in signals}, clocks={CLOCK: Clock()})


def _position(run: Simulation, i: int, name: str) -> Signal:
    """Position of a point at every step, base axes."""
    signal = Signal(
        name=name,
        quantity="position",
        point=name,
        time=run.time,
        values=run.position[:, i],
        noise_std=0.0,
        file="points.csv",
        clock=CLOCK,
    )
    return _shown(signal, run)


def _drive(run: Simulation, joint: str, taken: dict[str, Signal], clock: str = CLOCK) -> Signal:
    """Return the drive of a joint: what it was told where it lags, else the motor's angle over the ratio."""
    name = joint if joint not in taken else f"{joint}_drive"
    signal = Signal(
        name=name,
        quantity="joint_angle",
        joint=joint,
        side="motor",
        unit="m" if run.arm.joint(joint).type == "prismatic" else "rad",
        time=run.time,
        values=run.drive_angle[:, run.joints.index(joint)],
        noise_std=0.0,
        file="drive.csv",
        clock=clock,
    )
    shown = _shown(signal, run)
    if run.joint_command is None or not follows_late(run, joint):
        return shown
    told = run.joint_command[:, [run.joints.index(joint)]]
    return shown.replace(values=effects_of(run.arm, signal).reading(told))


def _shown(signal: Signal, run: Simulation) -> Signal:
    """Return a signal of true values at true instants as the model's sensor, clock and frame show it."""
    clock = effects_of(run.arm, signal).clock(EXACT, float(run.time[0]))
    late = signal.replace(time=clock.stamps(run.time))
    return late.replace(values=predict(run, late))
