"""What the arm did at each sample: angle, rate, acceleration and torque of its joints, and time.

States are those of the simulation beside the record, which knows torques that nothing measured.

How states sort the samples of a gap: conditions for a table, and groups of what a gap may follow.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.residual_analysis.covariates import BINS, SAMPLES, Groups, intervals

Mask = NDArray[np.bool_]

STILL = 1e-3
"""Share of the greatest rate below which a joint counts as standing."""


@dataclass(frozen=True, eq=False)
class JointStates:
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


def joined_states(parts: Sequence[JointStates]) -> JointStates:
    """The samples of several records, one after the other."""
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS}
    return JointStates(parts[0].joint, **arrays, slides=parts[0].slides)


def moved_joints(pairs: Sequence[AlignedRecord]) -> list[str]:
    """Joints that at least one of the records moves; all uncertain_clock_and_frame ones if none does."""
    found: dict[str, None] = {}
    for pair in pairs:
        run = pair.simulated.simulation
        spans = np.ptp(np.asarray(run.drive_angle), axis=0)
        found |= dict.fromkeys(name for name, span in zip(run.joints, spans, strict=True) if span > 1e-9)
    uncertain_clock_and_frame = [joint.name for joint in pairs[0].simulated.arm.moving_joints]
    return [name for name in uncertain_clock_and_frame if name in found] or uncertain_clock_and_frame


def joint_states(pair: AlignedRecord, joint: str, instants: Floats) -> JointStates:
    """States of a joint at instants of the simulation."""
    run = pair.simulated.simulation
    time, j = np.asarray(run.time), run.joints.index(joint)
    rate = np.asarray(run.drive_rate)[:, j]
    torque = np.asarray(getattr(run, "joint_torque", run.motor_torque))[:, j]
    moving = pair.record.kind == "motion" and len(time) > 1

    def at(values: Floats) -> Floats:
        return np.interp(instants, time, values)

    never = np.full(len(instants), np.inf)
    return JointStates(
        joint,
        at(np.asarray(run.drive_angle)[:, j]),
        at(rate),
        at(np.gradient(rate, time)) if moving else np.zeros(len(instants)),
        at(torque),
        _since(time, rate, instants) if moving else never,
        _since(time, torque, instants) if moving else never,
        _last_sign(time, rate, instants),
        pair.simulated.arm.joint(joint).type == "prismatic",
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


ZONES = 5
"""Intervals of angle and of time in a table."""


def conditions(
    states: Sequence[JointStates], time: Floats, record: Groups, labels: Sequence[str], window: float
) -> Iterator[tuple[str, str, Mask]]:
    """State, wording and samples of every condition; those of one state share out all samples.

    Parameters
    ----------
    states : sequence of JointStates
        Of the joints that move.
    time : ndarray, shape (n,)
        Instants [s].
    record : ndarray of int, shape (n,)
        Number of the record of each sample.
    labels : sequence of str
        Names of the records.
    window : float
        How long after a reversal counts as one [s].
    """
    yield "all", "throughout", np.ones(len(time), dtype=bool)
    for each in states:
        yield from _of_joint(each, f" of {each.joint}" if len(states) > 1 else "", window)
    if any(each.moves for each in states):
        yield from _of_time(time, record, labels)
    elif len(labels) > 1:
        yield from ((("record", name, record == i)) for i, name in enumerate(labels))


def _of_joint(states: JointStates, of: str, window: float) -> Iterator[tuple[str, str, Mask]]:
    """Conditions of one joint."""
    zone, unit = intervals(states.angle, ZONES), states.units["angle"]
    width = np.ptp(states.angle) / ZONES
    for i in range(ZONES if width > 0 else 0):
        middle = states.angle.min() + (i + 0.5) * width
        yield f"angle{of}", f"near {middle:+.2g} {unit}{of}", zone == i
    if np.any(states.torque != 0):
        for sign, wording in ((-1, "negative"), (1, "positive")):
            yield f"torque sign{of}", f"torque{of} {wording}", np.where(states.torque > 0, 1, -1) == sign
    if not states.moves:
        return
    for wording, mask in (
        ("rising", ~states.stands & (states.rate > 0)),
        ("falling", ~states.stands & (states.rate < 0)),
        ("standing", states.stands),
    ):
        yield f"motion{of}", f"angle{of} {wording}", mask
    for kind, since in (("torque", states.since_torque), ("motion", states.since_motion)):
        yield f"{kind} reversal{of}", f"after {kind} reversal{of}", since < window
        yield f"{kind} reversal{of}", f"away from {kind} reversal{of}", ~(since < window)
    strong = np.abs(states.acceleration) > 0.5 * np.abs(states.acceleration).max()
    yield f"acceleration{of}", f"acceleration{of} strong", strong
    yield f"acceleration{of}", f"acceleration{of} weak", ~strong


def _of_time(time: Floats, record: Groups, labels: Sequence[str]) -> Iterator[tuple[str, str, Mask]]:
    """Intervals of time of each record."""
    for k, name in enumerate(labels):
        inside = record == k
        if not inside.any():
            continue
        edges = np.linspace(time[inside].min(), time[inside].max(), ZONES + 1)
        zone = np.clip(np.digitize(time, edges) - 1, 0, ZONES - 1)
        of = f" of {name}" if len(labels) > 1 else ""
        for i in range(ZONES):
            yield "time", f"{edges[i]:.3g} to {edges[i + 1]:.3g} s{of}", inside & (zone == i)


def covariate_groups(
    states: Sequence[JointStates], time: Floats, record: Groups
) -> Mapping[str, tuple[int, Groups]]:
    """What a gap may follow: by name how much it claims, and the groups of the samples."""
    n = len(time)
    found: dict[str, tuple[int, Groups]] = {}
    if record.max(initial=0) > 0:
        found["the record"] = (1, record)
    moving = [each for each in states if each.moves]
    bins = int(np.clip(n // SAMPLES, 2, BINS)) if moving else int(np.clip(n // 4, 2, BINS))
    for each in states:
        of = f" of {each.joint}" if len(states) > 1 else ""
        if np.any(each.torque > 0) and np.any(each.torque < 0):
            found[f"sign of torque{of}"] = (1, (each.torque > 0).astype(np.intp))
        kinds = ("angle", "rate", "torque", "acceleration") if each.moves else ("angle", "torque")
        curves = {kind: intervals(getattr(each, kind), bins) for kind in kinds}
        found |= {f"{kind}{of}": (2, groups) for kind, groups in curves.items()}
        if each.moves:
            found[f"sense of motion{of}"] = (1, each.sense + 1)
            for kind in ("angle", "torque"):
                two = 3 * intervals(getattr(each, kind), max(2, bins // 2)) + each.sense + 1
                found[f"{kind}{of}, by sense of motion"] = (3, two)
    if moving:
        found["time"] = (3, _slow_time(moving, time, record, bins))
    return found


def _slow_time(states: Sequence[JointStates], time: Floats, record: Groups, bins: int) -> Groups:
    """Intervals of time in which every joint's angle comes and goes at least once, by record."""
    groups, first = np.zeros(len(time), dtype=np.intp), 0
    for k in np.unique(record):
        inside = record == k
        turns = [int(np.count_nonzero(np.diff(each.sense[inside]))) for each in states if each.moves]
        count = int(np.clip(min((t for t in turns if t), default=0) // 2, 1, bins))
        groups[inside] = first + intervals(time[inside], count)
        first += count
    return groups
