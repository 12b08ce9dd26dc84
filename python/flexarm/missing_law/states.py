"""States of a joint along a run: what a latent motion may be a function of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.missing_law.latent import Latent
from flexarm.missing_law.policy import LawPolicy

if TYPE_CHECKING:
    from flexarm.simulation import Simulation

STATES = ("torque", "angle", "rate", "motor_angle")
"""Names of the states; the motor's angle is that within a turn."""


@dataclass(frozen=True, eq=False)
class States:
    """States of a joint along its runs."""

    record: np.ndarray
    """Number of the record, shape (m,)."""
    time: Floats
    """Instants [s], shape (m,)."""
    values: dict[str, Floats]
    """Each state, shape (m,)."""

    @property
    def rising(self) -> np.ndarray:
        """Where the link's angle rises."""
        return np.asarray(self.values["rate"] >= 0)


def states_of(run: Simulation, joint: str, time: Floats, gear_ratio: float | None) -> dict[str, Floats]:
    """Return the states of a joint at instants."""
    k = [each.name for each in run.arm.moving_joints].index(joint)

    def at(values: Floats) -> Floats:
        return np.interp(time, run.time, values[:, k])

    found = {"torque": at(run.joint_torque), "angle": at(run.joint_angle), "rate": at(run.joint_rate)}
    if gear_ratio is not None:
        turn = at(run.drive_angle) * gear_ratio
        step = np.abs(np.diff(turn))
        if np.ptp(turn) > 4 * np.pi and float(np.quantile(step, 0.9)) < np.pi / 4:
            found["motor_angle"] = np.mod(turn, 2 * np.pi)
    return found


def joint_states(latent: Latent, policy: LawPolicy) -> States:
    """Return the states of the joint along the runs with its latent motion, at the `fine` instants."""
    response = latent.response
    assert response is not None
    joint = response.arm.joint(latent.at)
    parts = response.parts(latent.mean)
    found: dict[str, list[Floats]] = {}
    times = [basis.fine(policy) for basis in response.bases.values()]
    for (name, basis), time in zip(response.bases.items(), times, strict=True):
        run = response.run(name, parts[name]).simulation
        followed = states_of(run, latent.at, basis.places, joint.gear_ratio)
        for key, values in states_of(run, latent.at, time, joint.gear_ratio).items():
            if key in followed:
                found.setdefault(key, []).append(values)
    count = len(response.bases)
    return States(
        np.repeat(np.arange(count), [len(time) for time in times]),
        np.concatenate(times),
        {key: np.concatenate(each) for key, each in found.items() if len(each) == count},
    )
