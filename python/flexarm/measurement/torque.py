"""Torque and voltage of a motor.

The torque at the motor's shaft accelerates the rotor and overcomes the motor's friction; times the ratio it
is the torque at the output, T_output = ratio x T_motor. The simulation holds the output-referred value.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.arm.joint import motor_ratio
from flexarm.arrays import Floats
from flexarm.measurement.sampling import CannotMeasure, Described, joint_index, sample, stored


def _geared_rates(arm: Any, joint: str) -> dict[str, float]:
    """Return the rates of all joints that gears couple to one, over its own."""
    found = {joint: 1.0}
    for _ in arm.gears:
        for gear in arm.gears:
            if gear.output in found:
                found.setdefault(gear.input, gear.ratio * found[gear.output])
            if gear.input in found:
                found.setdefault(gear.output, found[gear.input] / gear.ratio)
    return found


def motor_torque(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the torque at the motor's shaft, or at the output side [N m or N], shape (n, 1).

    Motors of joints that gears couple are one: their torques count at this joint by virtual work.
    """
    joint = simulation.joints[joint_index(simulation, what)]
    every, rates = stored(simulation, "motor_torque", what), _geared_rates(simulation.arm, joint)
    parts = [every[:, [simulation.joints.index(name)]] * rate for name, rate in rates.items()]
    torque = np.sum(parts, axis=0)
    ratio = 1.0 if what.side == "output" else motor_ratio(simulation.arm, joint)
    return sample(simulation.time, torque, instants) / ratio


def motor_voltage(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the voltage of the motor [V], shape (n, 1); only of a run that has a motor."""
    j = joint_index(simulation, what)
    voltage = stored(simulation, "motor_voltage", what)[:, [j]]
    if not np.isfinite(voltage).all():
        raise CannotMeasure(f"signal {what.name!r}: the joint {what.joint!r} has no motor in this simulation")
    return sample(simulation.time, voltage, instants)
