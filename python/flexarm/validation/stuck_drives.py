"""Drives that stand although the arm moves: a dead encoder, a frozen one, one at the end of its range.

A motor slows down before it stands, and the arm with it. A drive that stops within a sample, from one reading
to the next, while the gap of a place or an angle

    e = measured - predicted                                                                           (1)

then goes further than it does in as long a time elsewhere, was not the motor that stopped. How far a gap goes
is the range of the means of its thirds: vibration averages out.

Drives whose angles are borne out: places follow the model that they move, however far they turn.

A crane that slews three times round goes as far as a swing in degrees. Driven by the latter, places would go
round 57 times too often; a place that such a drive alone moves, and that follows the model, says otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.record.workspace import span_by
from flexarm.validation.channel import Channel
from flexarm.validation.drive_faults import DriveFinding
from flexarm.validation.drive_hypotheses import disturbed, moves
from flexarm.validation.finding import Finding
from flexarm.validation.gain_faults import CERTAIN, FOLLOWS
from flexarm.validation.saturation import SLOW, runs

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record, Signal


Run = tuple[int, int]

SHORTEST = 0.01
"""Share of a record that a run of equal readings lasts at least."""
WHOLE = 0.95
"""Share from which on a drive stands all the time."""
FURTHER = 3.0
"""How many times further than usual the gap (1) must go."""
FAR_OFF = 0.05
"""Motion beside a drive that stands all the time, as a share of the reach or an angle [rad]."""
SURE = 20.0
"""Logarithm of the odds that are given to a drive that stands."""


def standing_drive(arm: Arm, record: Record, found: Sequence[Finding]) -> DriveFinding | None:
    """A drive that stands for a while, or all the time where nothing else drives, although the arm moves."""
    for signal, time, angle in _drives(record):
        noise = signal.noise_std or 0.0
        channels = [each.channel for each in found if moves(arm, str(signal.joint), each.channel.signal)]
        channels = [channel for channel in channels if channel.signal.quantity in SLOW]
        standing = _standing(time, angle, noise)
        if any(last - first > WHOLE * len(angle) for first, last in standing):
            who = next((c.label for c in channels if _swings(c)), None) if len(record.drive) == 1 else None
            if who is not None:
                return _dead(signal, angle, who)
            continue
        abrupt = [(i, j) for i, j in standing if _abrupt(angle, i, j, noise)]
        times = [(float(time[i]), float(time[j - 1])) for i, j in abrupt]
        who = next((c.label for c in channels if times and _goes_further(c, times)), None)
        if who is not None:
            return _stopped(signal, time, angle, abrupt, who)
    return None


def constant_drive(arm: Arm, record: Record, found: Sequence[Finding]) -> DriveFinding | None:
    """One of several drives that shows one value without its noise, where what it moves is disturbed."""
    for signal, _, angle in _drives(record):
        still = float(np.ptp(angle)) == 0 and bool(signal.noise_std)
        if still and disturbed(arm, str(signal.joint), found):
            odd = next(each.channel.label for each in found if each.name or each.strange)
            return _dead(signal, angle, odd)
    return None


def _drives(record: Record) -> list[tuple[Signal, Floats, Floats]]:
    """Drives of motions, with the times and values of their valid rows."""
    found = []
    for name in record.drive:
        signal = record.signals[name]
        keep = np.isfinite(signal.values[:, 0])
        if signal.pose is None and signal.quantity == "joint_angle" and keep.sum() >= 10:
            found.append((signal, signal.time[keep], signal.values[keep, 0]))
    return found


def _standing(time: Floats, angle: Floats, noise: float) -> list[Run]:
    """Runs of readings that agree, exactly or else to within the noise."""
    least = SHORTEST * float(time[-1] - time[0])
    for width in (0.0, 8 * noise):
        found = [(each.first, each.last) for each in runs(angle, width)]
        found = [(i, j) for i, j in found if time[j - 1] - time[i] >= least]
        if found:
            break
    return found


def _abrupt(angle: Floats, first: int, last: int, noise: float) -> bool:
    """Whether a drive stops or starts within a sample."""
    steps = np.abs(np.diff(angle))
    beside = [steps[k] for k in (first - 2, last) if 0 <= k < len(steps)]
    return bool(beside) and max(beside) > max(20 * noise, 0.02 * float(np.max(steps)))


def _goes_further(channel: Channel, times: Sequence[tuple[float, float]]) -> bool:
    """Whether the gap (1) goes far while the drive stands, and seldom as far elsewhere."""
    gap = channel.measured - channel.predicted
    lengths = [end - begin for begin, end in times]
    far = max((_travel(channel, gap, begin, end) for begin, end in times), default=0.0)
    length = float(np.max(lengths))
    starts = np.arange(channel.time[0], channel.time[-1] - length, length / 2)
    free = [t for t in starts if all(t > end or t + length < begin for begin, end in times)]
    usual = [_travel(channel, gap, t, t + length) for t in free]
    limit = max(20 * channel.noise, 0.3 * channel.floor, FURTHER * float(np.median(usual)) if usual else 0.0)
    return far > limit


def _swings(channel: Channel) -> bool:
    """Whether a channel moves by `FAR_OFF`, and the model by much less."""
    first, last = channel.time[0], channel.time[-1]
    seen = _travel(channel, channel.measured, first, last)
    said = _travel(channel, channel.predicted, first, last)
    return max(seen, float(np.std(channel.measured))) > FAR_OFF * channel.size and seen > 3 * said


def _travel(channel: Channel, values: Floats, begin: float, end: float) -> float:
    """How far values go between two times: range of the means of thirds."""
    part = values[(channel.time >= begin) & (channel.time <= end)]
    if len(part) < 3:
        return 0.0
    thirds = [float(np.mean(each)) for each in np.array_split(part, 3)]
    return max(thirds) - min(thirds)


def _dead(signal: Signal, angle: Floats, who: str) -> DriveFinding:
    value = float(np.median(angle))
    std = (signal.noise_std or 0.0) / np.sqrt(len(angle))
    sentence = (
        f"the drive {signal.name} stays at {value:.5g} {signal.unit} all the time, and {who} does not follow"
    )
    return _finding(signal, "dead_channel", "value", (value, float(std)), sentence)


def _stopped(signal: Signal, time: Floats, angle: Floats, stands: Sequence[Run], who: str) -> DriveFinding:
    """Cut off if it stands at the ends of its range only, else frozen."""
    noise = signal.noise_std or 0.0
    rows = sum(last - first for first, last in stands)
    levels = np.array([float(np.median(angle[first:last])) for first, last in stands])
    ends = np.array([np.max(angle), np.min(angle)])
    at_ends = bool(np.all(np.min(np.abs(levels[:, None] - ends), axis=1) <= 8 * noise))
    back = all(last < len(angle) for _, last in stands) or len(stands) > 1
    std = max(noise, 1e-9 * float(np.max(np.abs(levels)))) / np.sqrt(rows)
    begin = f"the drive {signal.name} stops within a sample at {levels[0]:.5g} {signal.unit}"
    if at_ends and back:
        sentence = f"{begin}, the end of its range, for {rows} samples in all while {who} moves on"
        return _finding(signal, "saturation", "limit", (float(np.mean(np.abs(levels))), float(std)), sentence)
    sentence = f"{begin} from t = {time[stands[0][0]]:.4g} s on for {rows} samples while {who} moves on"
    return _finding(signal, "dead_channel", "value", (float(levels[0]), float(std)), sentence)


def _finding(signal: Signal, name: str, key: str, value: tuple[float, float], sentence: str) -> DriveFinding:
    """A fault of one drive with one parameter and its standard deviation."""
    return DriveFinding({signal.name: {key: (*value, signal.unit)}}, name, SURE, sentence)


MUCH = 0.1
"""Part of the reach over which a drive alone must move a place."""


def borne_out(arm: Arm, record: Record, found: Sequence[Finding]) -> set[str]:
    """Drives that a place follows which they move, and beside which no channel is at fault or strange."""
    if any(each.name or each.strange for each in found):
        return set()
    firm = [each.channel for each in found if each.channel.signal.quantity == "position" and _follows(each)]
    return {
        name
        for name in record.drive
        if any(span_by(record, arm, name, str(c.signal.point)) > MUCH * c.size for c in firm)
    }


def _follows(found: Finding) -> bool:
    fit = found.channel.fit()
    return fit.slope > CERTAIN * fit.std and fit.missed < FOLLOWS
