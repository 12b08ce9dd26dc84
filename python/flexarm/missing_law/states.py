"""States of a joint along a run, of which a latent motion may be a function."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.joint import motor_ratio
from flexarm.arrays import Floats
from flexarm.missing_law.latent import Latent
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.windup import driven_joints

if TYPE_CHECKING:
    from flexarm.comparison.pose_sequence import PoseSequence
    from flexarm.simulation import Simulation

ANGLE_OF = "angle of "
"""Prefix of the angles of other joints."""
ARRAYS = {"torque": "joint_torque", "angle": "joint_angle", "rate": "joint_rate"}
"""Arrays of a run that states are read from, by name; one more is the motor's angle within a turn."""


@dataclass(frozen=True, eq=False)
class States:
    """States of a joint along its runs."""

    record: np.ndarray
    """Number of the record, shape (m,)."""
    time: Floats
    """Instants [s] or numbers of poses, shape (m,)."""
    values: dict[str, Floats]
    """Each state that changes, shape (m,); poses have no rate, joints that no drive turns only a torque."""

    @classmethod
    def over(cls, times: Sequence[Floats], values: dict[str, Floats]) -> States:
        """Return the states at the instants of several records, one after the other."""
        numbers = np.repeat(np.arange(len(times)), [len(time) for time in times])
        return cls(numbers, np.concatenate(times), values)

    @property
    def rising(self) -> np.ndarray:
        """Where the link's angle rises."""
        return np.asarray(self.values["rate"] >= 0)


def states_of(
    run: Simulation | PoseSequence, joint: str, time: Floats, policy: LawPolicy
) -> dict[str, Floats]:
    """Return the states of a joint at instants."""
    k = [each.name for each in run.arm.moving_joints].index(joint)

    def at(values: Floats) -> Floats:
        return np.interp(time, run.time, values[:, k])

    found = {state: at(getattr(run, array)) for state, array in ARRAYS.items()}
    turn = at(run.drive_angle) * motor_ratio(run.arm, joint)
    step = float(np.quantile(np.abs(np.diff(turn)), 0.9))
    if np.ptp(turn) > 2 * np.pi * policy.least_turns and step < 2 * np.pi * policy.turn_step:
        found["motor_angle"] = np.mod(turn, 2 * np.pi)
    return found


def angles_of(run: Simulation | PoseSequence, joints: Iterable[str], time: Floats) -> dict[str, Floats]:
    """Return the angles of joints at instants, as the states `angle of NAME`."""
    column = {joint.name: k for k, joint in enumerate(run.arm.moving_joints)}
    return {ANGLE_OF + name: np.interp(time, run.time, run.joint_angle[:, column[name]]) for name in joints}


def other_angles(latent: Latent, policy: LawPolicy) -> States:
    """Return the angles of the other joints that drives turn, as `joint_states` does those of its own."""
    response = latent.response
    assert response is not None
    problem, parts = response.problem, response.parts(latent.mean)
    driven = [driven_joints(problem, response.arm, name) for name in response.bases]
    joints = sorted(set.intersection(*map(set, driven)) - {response.joint})
    times = [basis.fine(policy) for basis in response.bases.values()]
    each = [
        angles_of(response.run(name, parts[name]).simulation, joints, time)
        for name, time in zip(response.bases, times, strict=True)
    ]
    joined = {key: np.concatenate([found[key] for found in each]) for key in each[0]}
    return States.over(
        times, {key: v for key, v in joined.items() if np.ptp(v) > policy.least_range * np.abs(v).max()}
    )


def joint_states(latent: Latent, policy: LawPolicy) -> States:
    """Return the states of the joint along the runs with its latent motion, at the `fine` instants."""
    response = latent.response
    assert response is not None
    joint = response.arm.joint(response.joint)
    parts = response.parts(latent.mean)
    found: dict[str, list[Floats]] = {}
    greatest = dict.fromkeys(ARRAYS, 0.0)
    drive: list[Floats] = []
    k = [each.name for each in response.arm.moving_joints].index(joint.name)
    times = [basis.fine(policy) for basis in response.bases.values()]
    for (name, basis), time in zip(response.bases.items(), times, strict=True):
        run = response.run(name, parts[name]).simulation
        at_places = states_of(run, joint.name, basis.places, policy)
        drive.append(response.problem.simulations.run(name, response.arm).simulation.drive_angle[:, k])
        for key, array in ARRAYS.items():
            greatest[key] = max(greatest[key], float(np.abs(getattr(run, array)).max()))
        for key, values in states_of(run, joint.name, time, policy).items():
            if key in at_places:
                found.setdefault(key, []).append(values)
    count = len(response.bases)
    joined = {key: np.concatenate(each) for key, each in found.items() if len(each) == count}
    least = {key: policy.least_range * value for key, value in greatest.items()}
    if np.ptp(np.concatenate(drive)) <= least["angle"]:  # the link's angle is the windup itself
        joined = {key: each for key, each in joined.items() if key == "torque"}
    return States.over(
        times, {key: each for key, each in joined.items() if np.ptp(each) > least.get(key, 0.0)}
    )
