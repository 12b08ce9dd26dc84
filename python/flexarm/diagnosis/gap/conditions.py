"""How states sort the samples of a gap: conditions for a table, and groups of what a gap may follow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.gap.curves import BINS, SAMPLES, Groups, intervals
from flexarm.diagnosis.gap.joint_states import States

Mask = NDArray[np.bool_]

ZONES = 5
"""Intervals of angle and of time in a table."""


def conditions(
    states: Sequence[States], time: Floats, record: Groups, labels: Sequence[str], window: float
) -> Iterator[tuple[str, str, Mask]]:
    """State, wording and samples of every condition; those of one state share out all samples.

    Parameters
    ----------
    states : sequence of States
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


def _of_joint(states: States, of: str, window: float) -> Iterator[tuple[str, str, Mask]]:
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


def tiers(states: Sequence[States], time: Floats, record: Groups) -> Mapping[str, tuple[int, Groups]]:
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


def _slow_time(states: Sequence[States], time: Floats, record: Groups, bins: int) -> Groups:
    """Intervals of time in which every joint's angle comes and goes at least once, by record."""
    groups, first = np.zeros(len(time), dtype=np.intp), 0
    for k in np.unique(record):
        inside = record == k
        turns = [int(np.count_nonzero(np.diff(each.sense[inside]))) for each in states if each.moves]
        count = int(np.clip(min((t for t in turns if t), default=0) // 2, 1, bins))
        groups[inside] = first + intervals(time[inside], count)
        first += count
    return groups
