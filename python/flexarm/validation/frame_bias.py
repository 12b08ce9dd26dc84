"""Frame bias: positions with a constant offset, frames that moved between records, poses that do not repeat.

With the gap g = measured - predicted and the prediction p in base axes, an error of the arm turns with the
arm. An offset that does not is that of a frame which is not stated:

    |mean g| std(p) > unusual_ratio std(g) |p|                                                         (1)

Records share the frames of one name. If a frame moved between two records, the step

    D = mean g in one record - mean g in another                                                       (2)

is the same for all its signals. It is reported beyond `min_sigmas` of the stated registration where two or
more signals agree on it to `shift_agreement`. Rows of one pose disagree if they scatter by `min_noises` times
the noise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np

from flexarm.arm.sizes import reach
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.record import Record, Signal
from flexarm.validation.initial_alignment import initial_alignment
from flexarm.validation.policy import POLICY
from flexarm.wording import with_unit


def remarks_on_unstated_frames(simulations: Mapping[str, SimulatedRecord]) -> Iterator[str]:
    """Report positions without a frame for which (1) holds."""
    for name, simulated in simulations.items():
        for signal in simulated.evidence.values():
            if signal.quantity == "position" and signal.frame == "base":
                yield from (f"{name}: {what}" for what in _shift(simulated, signal))


def _shift(simulated: SimulatedRecord, signal: Signal) -> Iterator[str]:
    placement = initial_alignment(simulated)
    gap = simulated.residual(signal, placement, hold=True)
    known = np.isfinite(gap).all(axis=1)
    if known.sum() < 3:
        return
    gap, place = gap[known], simulated.predicted(signal, placement, hold=True)[known]
    off, far = np.mean(gap, axis=0), float(np.sqrt(np.mean(np.sum(place**2, axis=1))))
    size, left, turned = float(np.linalg.norm(off)), _scatter(gap), _scatter(place) / (far or 1.0)
    least = max(
        POLICY.min_shift * reach(simulated.arm), POLICY.min_noises * float(np.max(simulated.noise(signal)))
    )
    if turned > POLICY.min_motion and size > least and size * turned > POLICY.unusual_ratio * left:  # eq. (1)
        along = ", ".join(
            f"{with_unit(float(value), 'm')} along {axis}"
            for axis, value in zip(signal.axes, off, strict=True)
            if abs(value) > POLICY.min_shift_part * size
        )
        yield (
            f"{signal.name} is off by {along}, wherever the arm stands, to within {with_unit(left, 'm', 2)}, "
            "and no frame is stated for it: if it does not count from the base, give it one in [frames] with "
            "its sigma; else a diagnosis takes that for the arm's"
        )


def _scatter(values: np.ndarray) -> float:
    """Return the root mean square distance from the mean."""
    return float(np.sqrt(np.mean(np.sum((values - np.mean(values, axis=0)) ** 2, axis=1))))


def remarks_on_frames(simulations: Mapping[str, SimulatedRecord]) -> list[str]:
    """Report frames that moved between one record and the next, by (2)."""
    gaps = {name: _mean_gaps(simulated) for name, simulated in simulations.items()}
    return [
        remark
        for one, other in pairwise(simulations)
        for frame in dict.fromkeys(frame for frame, _, _ in gaps[one])
        for axis in "xyz"
        for remark in _moved(simulations[one].record, frame, axis, one, other, gaps)
    ]


def _mean_gaps(simulated: SimulatedRecord) -> dict[tuple[str, str, str], float]:
    """Return the mean gap of every position, by frame, signal and axis."""
    placement = initial_alignment(simulated)
    found = {}
    for signal in simulated.evidence.values():
        if signal.quantity == "position" and not simulated.record.frame_of(signal).unknown:
            means = np.nanmean(simulated.residual(signal, placement, hold=True), axis=0)
            for axis, mean in zip(signal.axes, means, strict=True):
                found[signal.frame, signal.name, axis] = float(mean)
    return found


def _moved(
    record: Record,
    frame: str,
    axis: str,
    one: str,
    other: str,
    gaps: Mapping[str, Mapping[tuple[str, str, str], float]],
) -> list[str]:
    """Report a step (2) that is large and alike for all signals of the frame."""
    keys = [key for key in gaps[one] if key[0] == frame and key[2] == axis and key in gaps[other]]
    if len(keys) < 2 or frame not in record.frames:
        return []
    steps = np.array([gaps[other][key] - gaps[one][key] for key in keys])  # eq. (2)
    middle = float(np.median(steps))
    sigma = float(np.max(record.frames[frame].translation))
    if abs(middle) <= POLICY.min_sigmas * max(sigma, 1e-6) or np.ptp(steps) > POLICY.shift_agreement * abs(
        middle
    ):
        return []
    return [
        f"{one} and {other} contradict each other: {', '.join(key[1] for key in keys)} lie {middle:.3g} m "
        f"apart along {axis}, as if the frame {frame} had moved between them"
    ]


def remarks_on_poses(records: Mapping[str, Record]) -> Iterator[str]:
    """Report poses whose rows do not repeat."""
    signals = ((name, signal) for name, record in records.items() for signal in record.signals.values())
    for name, signal in signals:
        if signal.pose is None or not signal.noise_std:
            continue
        for pose in dict.fromkeys(map(str, signal.pose)):
            rows = signal.values[(signal.pose == pose) & signal.valid]
            scatter = float(np.max(np.std(rows, axis=0, ddof=1))) if len(rows) > 1 else 0.0
            if scatter > POLICY.min_noises * signal.noise_std:
                yield (
                    f"{name}: {len(rows)} rows of {signal.name} in the pose {pose!r} "
                    f"scatter by {scatter:.2g} {signal.unit}, the stated noise is {signal.noise_std:.2g}"
                )
