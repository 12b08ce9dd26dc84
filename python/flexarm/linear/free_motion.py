r"""Free vibration about the loaded equilibrium, motors held: what sensors see of each state.

The lowest modes z = X s of `flexarm.linear.modal_form` ring as

.. math:: s(t) = e^{A t} s_0 = V e^{\Lambda t} V^{-1} s_0                                            (1)

and move nodes and joints by N X s, N X A s and N X A^2 s. Arrays that sensors read follow in proportion,

.. math:: a(t) = a_0 + \frac{da}{ds} s(t)                                                          (2)

with da/ds from central differences of the arm's own snapshots, and of the torques that hold the motors from
(4) of tangent.py. Friction has no part, as in `flexarm.modes`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.assembly import assemble, joint_values
from flexarm.linear.modal_form import Mechanics, modal_form
from flexarm.linear.outputs import DISPLACEMENT
from flexarm.linear.ports import ports
from flexarm.linear.tangent import tangent
from flexarm.measurement.state_snapshots import StateSnapshots

MOVING = (
    "position",
    "velocity",
    "orientation",
    "angular_rate",
    "acceleration",
    "joint_angle",
    "joint_rate",
    "section_forces",
)
"""Arrays of a snapshot that follow a free vibration."""


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """Free vibration of an arm in its lowest modes."""

    A: Floats
    """Of (1); states are amplitudes of the modes [kg^0.5 m] and their rates, shape (state, state)."""
    rest: StateSnapshots
    """The equilibrium, one state."""
    slopes: Mapping[str, Floats]
    """da/ds of (2), by array, shape (..., state)."""

    def states(self, initial: Floats, elapsed: Floats) -> Floats:
        """Return (1) at times after the start [s], shape (n, state)."""
        values, V = np.linalg.eig(self.A)
        weights = np.linalg.solve(V, initial.astype(complex))
        found: Floats = np.real(np.exp(np.outer(elapsed, values)) * weights @ V.T)
        return found

    def along(self, states: Floats, time: Floats) -> StateSnapshots:
        """Return the arrays (2) of given states, shape (n, state), at some times [s]."""
        arrays: dict[str, Any] = {
            name: getattr(self.rest, name)[0] + np.moveaxis(slope @ states.T, -1, 0)
            for name, slope in self.slopes.items()
        }
        for name in ("drive_angle", "drive_rate"):
            arrays[name] = np.repeat(getattr(self.rest, name), len(time), axis=0)
        return replace(self.rest, time=time, **arrays)

    def run(self, initial: Floats, time: Floats) -> StateSnapshots:
        """Return the same of the vibration that has an initial state at the first of some times [s]."""
        return self.along(self.states(initial, time - time[0]), time)


def free_motion(arm: Arm, joints: Mapping[str, float], count: int) -> FreeMotion:
    """Return the free vibration of an arm with its drives held [rad, m; default 0], of `count` modes at most.

    Raise NotConverged if there is no stable equilibrium.
    """
    driven = sorted(ports(arm, {}, joints)[1])
    held = assemble(arm, driven={*joints, *driven})
    values = joint_values(arm, joints)
    at = _core.static_equilibrium(held, values, _core.Loads(gravity=np.array(arm.gravity)))
    system = assemble(arm, {joint.name: _core.DriveKind.torque for joint in arm.moving_joints})
    equilibrium = _core.released(held, at, system)
    rows = dict(zip((joint.name for joint in arm.joints), _core.joint_coordinates(system), strict=True))
    motion = tangent(system, equilibrium, [rows[name][1] for name in driven])
    M, C, K = (motion.N.T @ X @ motion.N for X in (motion.M, motion.C, motion.K))
    form = modal_form(Mechanics(M, C, K, np.zeros((3, len(M), 0))), count)
    moves = [motion.N @ form.z.X, motion.N @ form.z.X @ form.A, motion.N @ form.z.X @ form.A @ form.A]
    steps = DISPLACEMENT / np.max([np.abs(move).max(axis=0, initial=1e-300) for move in moves[:2]], axis=0)
    states = [
        _core.displaced(system, equilibrium.state, *(sign * steps[k] * move[:, k] for move in moves))
        for sign in (1.0, -1.0)
        for k in range(len(steps))
    ]
    rest, n = StateSnapshots.of(arm, system, [equilibrium.state]), len(steps)
    rest = replace(rest, motor_torque=np.asarray(_core.motor_torques(held, at.state, False))[None])
    slopes = {name: np.zeros((*getattr(rest, name).shape[1:], n)) for name in (*MOVING, "motor_torque")}
    if n:
        seen = StateSnapshots.of(arm, system, states)
        for name in MOVING:
            array = getattr(seen, name)
            slopes[name] = np.moveaxis(array[:n] - array[n:], 0, -1) / (2 * steps)
        forces = sum(X @ move for X, move in zip((motion.K, motion.C, motion.M), moves, strict=True))
        joints_of = [joint.name for joint in arm.joints]
        slopes["motor_torque"][[joints_of.index(name) for name in driven]] = motion.G.T @ forces
    return FreeMotion(form.A, rest, slopes)
