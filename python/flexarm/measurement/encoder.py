"""Encoders and tachometers at a joint, before the reducer or after it.

The motor's side gives phi, the motor's angle over the ratio; the output side gives theta, the link's angle
relative to its parent. An encoder of finite resolution gives the nearest multiple of its step, an error of at
most step/2 and, over many steps, of step/sqrt(12) rms.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from flexarm.arm.drive_effect import lags_between
from flexarm.arrays import Floats
from flexarm.measurement.sampling import CannotMeasure, Described, joint_index, sample, stored


def joint_angle(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return phi (motor side) or theta (output side) [rad or m], shape (n, 1)."""
    j = joint_index(simulation, what)
    angle, rate = ("joint_angle", "joint_rate") if what.side == "output" else ("drive_angle", "drive_rate")
    return sample(
        simulation.time,
        stored(simulation, angle, what)[:, [j]],
        instants,
        stored(simulation, rate, what)[:, [j]],
    )


def joint_rate(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the rate of phi (motor side) or theta (output side) [rad/s or m/s], shape (n, 1)."""
    j = joint_index(simulation, what)
    rate = "joint_rate" if what.side == "output" else "drive_rate"
    return sample(simulation.time, stored(simulation, rate, what)[:, [j]], instants)


def joint_command(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the command of the controller [rad or m], shape (n, 1); only of a run that has one."""
    j = joint_index(simulation, what)
    command = stored(simulation, "joint_command", what)[:, [j]]
    if not np.isfinite(command).all():
        raise CannotMeasure(f"signal {what.name!r}: the joint {what.joint!r} has no controller here")
    return sample(simulation.time, command, instants)


def told(simulation: Any, what: Any, drives: Collection[str]) -> Any:
    """Return a signal or sensor, as a command where it drives a joint that lags behind its drive."""
    late = what.name in drives and follows_late(simulation, what.joint)
    return what.replace(quantity="joint_command", side=None) if late else what


def follows_late(simulation: Any, joint: str | None) -> bool:
    """Return True if a joint lags behind its drive, which is then the command that the run holds."""
    told = getattr(simulation, "joint_command", None)
    if told is None or joint is None or not lags_between(simulation.arm, joint):
        return False
    return bool(np.isfinite(told[:, simulation.joints.index(joint)]).all())


def quantised(values: Floats, step: float) -> Floats:
    """Return the nearest multiples of `step`; 0 leaves the values as they are."""
    return np.round(values / step) * step if step > 0 else values
