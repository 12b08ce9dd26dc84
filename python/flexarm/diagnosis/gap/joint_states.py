"""What the arm did at each sample: angle, rate, acceleration and torque of its joints, and time.

States are those of the simulation beside the record, which knows torques that nothing measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.beside import Beside

Mask = NDArray[np.bool_]

STILL = 1e-3
"""Share of the greatest rate below which a joint counts as standing."""


@dataclass(frozen=True, eq=False)
class States:
    """States of one joint at the samples, each of shape (n,).

    Attributes
    ----------
    joint : str
        Its name.
    angle, rate, acceleration, torque : ndarray
        Of the drive; torque on the child, output side [rad or m, N m or N].
    since_motion, since_torque : ndarray
        Time since rate and torque last changed sign [s]; infinite before that.
    sense : ndarray of int
        1 or -1: which way it moved last, as friction remembers it; 0 before it moved.
    slides : bool
        Whether it is prismatic.
    """

    joint: str
    angle: Floats
    rate: Floats
    acceleration: Floats
    torque: Floats
    since_motion: Floats
    since_torque: Floats
    sense: NDArray[np.intp]
    slides: bool = False

    @property
    def units(self) -> dict[str, str]:
        """By state."""
        length, force = ("m", "N") if self.slides else ("rad", "N m")
        return {
            "angle": length,
            "rate": f"{length}/s",
            "acceleration": f"{length}/s2",
            "torque": force,
        }

    def label(self, state: str) -> str:
        """Of an axis: the state as a joint that turns or slides has it, with its unit."""
        word = {"angle": "position", "torque": "force"}.get(state, state) if self.slides else state
        return f"{word} of {self.joint} [{self.units[state]}]"

    @property
    def stands(self) -> Mask:
        """Where it does not move."""
        return np.asarray(np.abs(self.rate) <= STILL * np.abs(self.rate).max(initial=0.0))

    @property
    def moves(self) -> bool:
        """Whether it moves in time, as in no record of poses."""
        return bool(np.any(self.rate != 0))


_ARRAYS = ("angle", "rate", "acceleration", "torque", "since_motion", "since_torque", "sense")


def joined(parts: Sequence[States]) -> States:
    """The samples of several records, one after the other."""
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS}
    return States(parts[0].joint, **arrays, slides=parts[0].slides)


def moved_joints(pairs: Sequence[Beside]) -> list[str]:
    """Joints that at least one of the records moves; all movable ones if none does."""
    found: dict[str, None] = {}
    for pair in pairs:
        run = pair.subject.simulation
        spans = np.ptp(np.asarray(run.drive_angle), axis=0)
        found |= dict.fromkeys(name for name, span in zip(run.joints, spans, strict=True) if span > 1e-9)
    movable = [joint.name for joint in pairs[0].subject.arm.moving_joints]
    return [name for name in movable if name in found] or movable


def states_of(pair: Beside, joint: str, instants: Floats) -> States:
    """States of a joint at instants of the simulation."""
    run = pair.subject.simulation
    time, j = np.asarray(run.time), run.joints.index(joint)
    rate = np.asarray(run.drive_rate)[:, j]
    torque = np.asarray(getattr(run, "joint_torque", run.motor_torque))[:, j]
    moving = pair.record.kind == "motion" and len(time) > 1

    def at(values: Floats) -> Floats:
        return np.interp(instants, time, values)

    never = np.full(len(instants), np.inf)
    return States(
        joint,
        at(np.asarray(run.drive_angle)[:, j]),
        at(rate),
        at(np.gradient(rate, time)) if moving else np.zeros(len(instants)),
        at(torque),
        _since(time, rate, instants) if moving else never,
        _since(time, torque, instants) if moving else never,
        _last_sign(time, rate, instants),
        pair.subject.arm.joint(joint).type == "prismatic",
    )


def _signs(values: Floats) -> Floats:
    """Signs of values; what is below `STILL` of the greatest has none."""
    return np.sign(np.where(np.abs(values) > STILL * np.abs(values).max(initial=0.0), values, 0.0))


def _last_sign(time: Floats, values: Floats, instants: Floats) -> NDArray[np.intp]:
    """The sign that values had last; 0 before they had one."""
    sign = _signs(values)
    known = np.flatnonzero(sign)
    last = np.searchsorted(time[known], instants, side="right")
    return np.concatenate([[0.0], sign[known]])[last].astype(np.intp)


def _since(time: Floats, values: Floats, instants: Floats) -> Floats:
    """Time since values last changed sign."""
    sign = _signs(values)
    known = np.flatnonzero(sign)
    turns = time[known[1:]][np.diff(sign[known]) != 0]
    last = np.searchsorted(turns, instants, side="right")
    return np.where(last > 0, instants - np.concatenate([[-np.inf], turns])[last], np.inf)
