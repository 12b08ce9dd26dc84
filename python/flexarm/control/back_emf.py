r"""The back-EMF of motors on a voltage, which the finite elements carry as friction of their rotors.

The integrator solves for the torque a u of `actuator`, eq. (1), with c as viscous friction, so what it
gives for the motor is a u. The motor's own torque is less by c φ', its work and what is damped less by

    W(t) = ∫ c φ'² dt                                                                                 (1)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import read_only
from flexarm.effects import MotorFriction
from flexarm.simulation.simulation import Simulation


def with_losses(arm: Arm, losses: Mapping[str, float]) -> Arm:
    """Return the arm with the losses as viscous friction of its motors."""
    for name, coefficient in losses.items():
        if coefficient == 0:
            continue
        own = next((e for e in arm.effects_at(name) if isinstance(e, MotorFriction)), MotorFriction(at=name))
        arm = arm.with_effect(own.replace(viscous=own.viscous + coefficient))
    return arm


def without_losses(run: Simulation, losses: Mapping[str, float]) -> Simulation:
    """Remove the losses from motor torques and energies, eq. (1)."""
    torque, lost = run.motor_torque.copy(), np.zeros(len(run.time))
    for name, coefficient in losses.items():
        j = run.joints.index(name)
        rate = run.drive_rate[:, j]
        torque[:, j] -= coefficient * rate
        work = 0.5 * coefficient * np.diff(run.drive_angle[:, j]) * (rate[1:] + rate[:-1])
        lost[1:] += np.cumsum(work)
    damped, given = read_only(run.damped - lost), read_only(run.work - lost)
    return replace(
        run, motor_torque=read_only(torque), energy_record=replace(run.energies, damped=damped, work=given)
    )
