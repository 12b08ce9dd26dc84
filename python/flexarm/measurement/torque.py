"""Torque and voltage of a motor.

The torque at the motor's shaft accelerates the rotor and overcomes the motor's friction; times the ratio it
is the torque at the output, T_output = ratio x T_motor. The simulation holds the output-referred value.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.measurement.sampling import CannotMeasure, Described, joint_index, sample, stored


def gear_ratio(arm: Any, joint: str) -> float:
    """Return the gear ratio of a joint: that of a gear with this output, else the joint's own."""
    for gear in arm.gears:
        if gear.output == joint:
            return float(gear.ratio)
    return float(arm.joint(joint).gear_ratio)


def motor_torque(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the torque at the motor's shaft, or at the output side [N m or N], shape (n, 1)."""
    j = joint_index(simulation, what)
    torque = stored(simulation, "motor_torque", what)[:, [j]]
    ratio = 1.0 if what.side == "output" else gear_ratio(simulation.arm, simulation.joints[j])
    return sample(simulation.time, torque, instants) / ratio


def motor_voltage(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the voltage of the motor [V], shape (n, 1); only of a run that has a motor."""
    j = joint_index(simulation, what)
    voltage = stored(simulation, "motor_voltage", what)[:, [j]]
    if not np.isfinite(voltage).all():
        raise CannotMeasure(f"signal {what.name!r}: the joint {what.joint!r} has no motor in this simulation")
    return sample(simulation.time, voltage, instants)
