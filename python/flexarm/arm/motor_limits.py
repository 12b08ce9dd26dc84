r"""Limits of a joint's motor, and priors of friction within them.

A motor at its greatest voltage or torque gives, on the output side, at most

.. math:: T_0 = |n| \min(\eta \, k_m u_{max}/R, \; T_{max})                                            (1)

and, as its back-EMF grows with the rate, falls to nothing with the slope

.. math:: c_0 = \eta \, (k_m n)^2/R                                                                    (2)

Dry friction beyond T_0 lets a joint stand still for ever; viscous friction beyond c_0 takes more than half of
the motor's rate without load. Priors are stated for the joints of robots. Where the model states a motor that
is too small for them, they are those of a joint as much smaller as its motor is.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from flexarm.arm.joint import motor_ratio

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.motor import Motor
    from flexarm.arm.prior import Prior


def stall_torque(arm: Arm, joint: str) -> float:
    """T_0 of (1) [N m]; infinite where the model states no motor, or no limit of it."""
    motor = _motor(arm, joint)
    if motor is None:
        return inf
    volts, per_volt = motor.voltage_limit or inf, motor.efficiency * motor.torque_constant / motor.resistance
    return abs(motor_ratio(arm, joint)) * min(per_volt * volts, motor.torque_limit or inf)


def back_emf_damping(arm: Arm, joint: str) -> float:
    """c_0 of (2) [N m s/rad]; infinite where the model states no motor."""
    motor = _motor(arm, joint)
    if motor is None:
        return inf
    return motor.efficiency * (motor.torque_constant * motor_ratio(arm, joint)) ** 2 / motor.resistance


def within(most: float, prior: Prior) -> Prior:
    """Return a prior for a joint whose motor overcomes no more than `most`, which the prior's unit is of."""
    if not 0 < most < prior.high:
        return prior
    scale = most / prior.high
    source = f"{prior.source}; {scale:.2g} of these, as the motor overcomes {most:.3g} {prior.unit}"
    return replace(prior, low=scale * prior.low, typical=scale * prior.typical, high=most, source=source)


def _motor(arm: Arm, joint: str) -> Motor | None:
    return next((motor for motor in arm.motors if motor.joint == joint), None)
