"""Stuck inputs, and the cross-check of drives by places.

A motor slows down before it stops, and the arm with it. A drive that stops from one reading to the next is
stuck if the residual of a place or angle

    e = measured - predicted                                                                           (1)

then drifts further than usual in as long a time. The drift is the range of the means of thirds of that time,
in which vibration averages out.

A drive is confirmed if places that it moves follow the model. Its angle is then in radians, however far it
turns.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.record import Record, Signal
from flexarm.record.workspace import span_by
from flexarm.validation.channel import QUASI_STATIC, Channel
from flexarm.validation.drive_hypotheses import is_disturbed, is_moved_by
from flexarm.validation.finding import ChannelFinding, DriveFault
from flexarm.validation.policy import POLICY
from flexarm.validation.saturation import Run, constant_runs


def stuck_drive(arm: Arm, record: Record, found: Sequence[ChannelFinding]) -> DriveFault | None:
    """Return a drive at rest although the arm moves, for a while or as the only drive, or None."""
    for signal, time, angle in _drives(record):
        noise = signal.noise_std or 0.0
        channels = [
            each.channel for each in found if is_moved_by(arm, str(signal.joint), each.channel.signal)
        ]
        channels = [channel for channel in channels if channel.signal.quantity in QUASI_STATIC]
        rests = _constant_spans(time, angle, noise)
        if any(last - first > POLICY.whole_standstill * len(angle) for first, last in rests):
            alone = channels if len(record.drive) == 1 else []
            witness = next((c.label for c in alone if _moves_alone(c)), None)
            if witness is not None:
                return _dead_drive(signal, angle, witness)
            continue
        abrupt = [(i, j) for i, j in rests if _is_abrupt(angle, i, j, noise)]
        times = [(float(time[i]), float(time[j - 1])) for i, j in abrupt]
        witness = next((c.label for c in channels if times and _drifts_far(c, times)), None)
        if witness is not None:
            return _stopped_drive(signal, time, angle, abrupt, witness)
    return None


def constant_drive(arm: Arm, record: Record, found: Sequence[ChannelFinding]) -> DriveFault | None:
    """Return a drive that shows one value without noise where its signals are disturbed, or None."""
    for signal, _, angle in _drives(record):
        still = float(np.ptp(angle)) == 0 and bool(signal.noise_std)
        if still and is_disturbed(arm, str(signal.joint), found):
            odd = next(
                each.channel.label
                for each in found
                if (each.name or each.unexplained)
                and is_moved_by(arm, str(signal.joint), each.channel.signal)
            )
            return _dead_drive(signal, angle, odd)
    return None


def _drives(record: Record) -> list[tuple[Signal, Floats, Floats]]:
    """Return drives of motions, with the times and values of their valid rows."""
    found = []
    for name in record.drive:
        signal = record.signals[name]
        keep = np.isfinite(signal.values[:, 0])
        if signal.pose is None and signal.quantity == "joint_angle" and keep.sum() >= 10:
            found.append((signal, signal.time[keep], signal.values[keep, 0]))
    return found


def _constant_spans(time: Floats, angle: Floats, noise: float) -> list[Run]:
    """Return runs of readings that agree, exactly or else to within the noise."""
    least = POLICY.min_standstill * float(time[-1] - time[0])
    for width in (0.0, 8 * noise):
        found = [(i, j) for i, j in constant_runs(angle, width) if time[j - 1] - time[i] >= least]
        if found:
            break
    return found


def _is_abrupt(angle: Floats, first: int, last: int, noise: float) -> bool:
    """Return True if a drive stops or starts within a sample."""
    steps = np.abs(np.diff(angle))
    beside = [steps[k] for k in (first - 2, last) if 0 <= k < len(steps)]
    return bool(beside) and max(beside) > max(20 * noise, 0.02 * float(np.max(steps)))


def _drifts_far(channel: Channel, times: Sequence[tuple[float, float]]) -> bool:
    """Return True if the residual (1) drifts far while the drive is at rest, and seldom as far elsewhere."""
    residual = channel.measured - channel.predicted
    farthest = max(_drift(channel, residual, begin, end) for begin, end in times)
    length = max(end - begin for begin, end in times)
    starts = np.arange(channel.time[0], channel.time[-1] - length, length / 2)
    free = [t for t in starts if all(t > end or t + length < begin for begin, end in times)]
    usual = [_drift(channel, residual, t, t + length) for t in free]
    limit = max(
        20 * channel.noise,
        0.3 * channel.model_error,
        POLICY.unusual_ratio * float(np.median(usual)) if usual else 0.0,
    )
    return farthest > limit


def _moves_alone(channel: Channel) -> bool:
    """Return True if a channel moves by `min_swing`, and its prediction by much less."""
    first, last = channel.time[0], channel.time[-1]
    measured = _drift(channel, channel.measured, first, last)
    predicted = _drift(channel, channel.predicted, first, last)
    swing = max(measured, float(np.std(channel.measured)))
    return swing > POLICY.min_swing * channel.length_scale and measured > 3 * predicted


def _drift(channel: Channel, values: Floats, begin: float, end: float) -> float:
    """Return the range of the means of thirds of the values between two times."""
    part = values[(channel.time >= begin) & (channel.time <= end)]
    if len(part) < 3:
        return 0.0
    thirds = [float(np.mean(each)) for each in np.array_split(part, 3)]
    return max(thirds) - min(thirds)


def _dead_drive(signal: Signal, angle: Floats, witness: str) -> DriveFault:
    """Return a dead drive with its constant value and the channel that contradicts it."""
    value = float(np.median(angle))
    std = (signal.noise_std or 0.0) / np.sqrt(len(angle))
    sentence = (
        f"the drive {signal.name} stays at {value:.5g} {signal.unit} all the time, "
        f"and {witness} does not follow"
    )
    return _drive_fault(signal, "dead_channel", "value", (value, float(std)), sentence)


def _stopped_drive(
    signal: Signal, time: Floats, angle: Floats, rests: Sequence[Run], witness: str
) -> DriveFault:
    """Return a saturated drive if it rests at the ends of its range only, else a frozen one."""
    noise = signal.noise_std or 0.0
    rows = sum(last - first for first, last in rests)
    levels = np.array([float(np.median(angle[first:last])) for first, last in rests])
    ends = np.array([np.max(angle), np.min(angle)])
    at_end = np.abs(levels[:, None] - ends) <= 8 * noise
    back = all(last < len(angle) for _, last in rests) or len(rests) > 1
    std = max(noise, 1e-9 * float(np.max(np.abs(levels)))) / np.sqrt(rows)
    begin = f"the drive {signal.name} stops within a sample at"
    if at_end.any(axis=1).all() and back:
        limits = ends[at_end.any(axis=0)]
        places = " and ".join(f"{limit:.5g} {signal.unit}" for limit in limits)
        sentence = (
            f"{begin} {places}, the end of its range, for {rows} samples in all while {witness} moves on"
        )
        limit = float(np.max(np.abs(limits)))
        return _drive_fault(signal, "saturation", "limit", (limit, float(std)), sentence)
    often = f" in {len(rests)} rests" if len(rests) > 1 else ""
    since = f"{levels[0]:.5g} {signal.unit} from t = {time[rests[0][0]]:.4g} s on"
    sentence = f"{begin} {since} for {rows} samples{often} while {witness} moves on"
    return _drive_fault(signal, "dead_channel", "value", (float(levels[0]), float(std)), sentence)


def _drive_fault(
    signal: Signal, name: str, key: str, value: tuple[float, float], sentence: str
) -> DriveFault:
    """Return a fault of one drive with one parameter and its standard deviation."""
    return DriveFault({signal.name: {key: (*value, signal.unit)}}, name, POLICY.stuck_log_odds, sentence)


def confirmed_inputs(arm: Arm, record: Record, found: Sequence[ChannelFinding]) -> set[str]:
    """Return the drives that a place confirms, if no channel is at fault or unexplained."""
    if any(each.name or each.unexplained for each in found):
        return set()
    places = [each.channel for each in found if each.channel.signal.quantity == "position"]
    fits = [(channel, channel.fit()) for channel in places]
    firm = [
        channel
        for channel, fit in fits
        if fit.gain > POLICY.min_sigmas * fit.std and fit.unexplained_share < POLICY.max_unexplained
    ]
    return {
        name
        for name in record.drive
        if any(
            span_by(record, arm, name, str(c.signal.point)) > POLICY.min_motion * c.length_scale for c in firm
        )
    }
