r"""Sensor readings near an equilibrium and their derivatives.

A reading h depends on where the arm is, on its velocities and accelerations, and on the torques of motors.
Along the columns of S = [N G] (tangent.py) its derivatives are central differences of the project's own
measurement functions, of all columns at once:

.. math:: h_q = [h(H \exp(\epsilon S_k)) - h(H \exp(-\epsilon S_k))]/(2 \epsilon)                    (1)

and likewise for velocities and accelerations, on which readings depend linearly or nearly so. Torques of
motors that hold an angle follow from equation (4) of tangent.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats
from flexarm.linear.tangent import Tangent
from flexarm.measurement.state_snapshots import StateSnapshots

DISPLACEMENT = 1e-5
"""Of the node that moves most [m, rad]: the error, of second order, is 1e-10 of the derivative."""


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Derivatives of readings, rows in the order of the sensors' channels."""

    at_rest: Floats
    """Readings of the equilibrium, shape (outputs,)."""
    position: Floats
    velocity: Floats
    acceleration: Floats
    """By the amplitudes of S and their two derivatives, shape (outputs, columns of S)."""
    torque: Floats
    """By the motors' torques, output side, shape (outputs, joints)."""


def derivatives(
    arm: Arm, system: _core.System, state: _core.State, tangent: Tangent, sensors: Sequence[Sensor]
) -> Derivatives:
    """Return readings and derivatives at an equilibrium; motors' torques are not part of the first three."""
    rate = 1e-3  # as `DISPLACEMENT` for velocities and accelerations [1/s, 1/s2]
    S, still = tangent.motions, np.zeros(len(tangent.M))
    size = np.abs(S).max(axis=0, initial=1e-300)
    displacements, rates = DISPLACEMENT / size, rate / size
    pairs = [(sign, column) for sign in (1.0, -1.0) for column in range(S.shape[1])]
    moved = [
        _core.displaced(system, state, sign * displacements[k] * S[:, k], still, still) for sign, k in pairs
    ]
    moving = [_core.displaced(system, state, still, sign * rates[k] * S[:, k], still) for sign, k in pairs]
    pushed = [_core.displaced(system, state, still, still, sign * rates[k] * S[:, k]) for sign, k in pairs]
    rest = StateSnapshots.of(arm, system, [state])

    def differences(states: list[_core.State], steps: Floats) -> Floats:
        if not states:
            return np.zeros((len(_readings(rest, sensors)[0]), 0))
        seen = StateSnapshots.of(arm, system, states)
        held = np.tile(rest.motor_torque, (len(states), 1))
        plus, minus = np.split(_readings(replace(seen, motor_torque=held), sensors), 2)
        return np.asarray((plus - minus).T / (2 * steps))  # eq. (1)

    return Derivatives(
        at_rest=_readings(rest, sensors)[0],
        position=differences(moved, displacements),
        velocity=differences(moving, rates),
        acceleration=differences(pushed, rates),
        torque=_by_torque(rest, sensors),
    )


def _readings(instants: StateSnapshots, sensors: Sequence[Sensor]) -> Floats:
    """Return all sensors' channels side by side: shape (states, outputs)."""
    found = [instants.readings(sensor) for sensor in sensors]
    return np.hstack(found) if found else np.zeros((len(instants.time), 0))


def _by_torque(rest: StateSnapshots, sensors: Sequence[Sensor]) -> Floats:
    """Return the derivatives with respect to the motors' torques, on which readings depend linearly."""
    base = _readings(rest, sensors)[0]
    found = np.zeros((len(base), len(rest.joints)))
    for j in range(len(rest.joints)):
        torque = rest.motor_torque.copy()
        step = max(1.0, float(np.abs(torque[0]).max()))
        torque[0, j] += step
        found[:, j] = (_readings(replace(rest, motor_torque=torque), sensors)[0] - base) / step
    return found
