"""Remarks on records: stamps, few poses, signals not compared, missing channels, plausibility.

The gain does not show a channel that keeps an absurd distance from its prediction but follows its motion.
Signals with stamps in another unit have hardly a reading to compare. No sensor can be judged with such
values.

A pause is an interval above `pause_ratio` usual ones. Drop-outs are reported from `lost_share` of the rows
on. The stated noise of angles is compared with `flexarm.measurement.drive_noise`.

Rows of one pose disagree if they scatter by `min_noises` times the noise.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from itertools import compress

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.sizes import implausible_sizes
from flexarm.comparison.drive_outliers import blank_rows
from flexarm.comparison.pose_outliers import LEAST_POSES
from flexarm.comparison.poses import is_input
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.measurement.drive_noise import drive_noise
from flexarm.measurement.outliers import row_list
from flexarm.record import Record, Signal
from flexarm.record.compatibility import implausible_values
from flexarm.record.plausibility import INPUTS, unit_problems
from flexarm.record.time_unit import mismatched_durations
from flexarm.validation.policy import POLICY
from flexarm.wording import listed


def remarks_on_few_poses(simulations: Mapping[str, SimulatedRecord]) -> Iterator[str]:
    """Report signals of static records with values in too few poses."""
    for name, simulated in simulations.items():
        for signal in simulated.evidence.values():
            if signal.pose is None:
                continue
            count = len(np.unique(signal.pose[signal.valid]))
            if count < LEAST_POSES:
                many = f"{name}: {signal.name} holds {count} pose{'s' * (count > 1)}"
                yield f"{many}; outliers are looked for among {LEAST_POSES} or more"


def remarks_on_poses(records: Mapping[str, Record]) -> Iterator[str]:
    """Report poses whose rows do not repeat."""
    signals = ((name, signal) for name, record in records.items() for signal in record.signals.values())
    for name, signal in signals:
        if signal.pose is None or not signal.noise_std:
            continue
        for pose in dict.fromkeys(map(str, signal.pose)):
            rows = signal.values[(signal.pose == pose) & signal.valid]
            # a quaternion and its negative are one attitude
            if signal.quantity == "orientation" and len(rows):
                rows = rows * np.where(rows @ rows[0] < 0, -1.0, 1.0)[:, None]
            scatter = float(np.max(np.std(rows, axis=0, ddof=1))) if len(rows) > 1 else 0.0
            if scatter > POLICY.min_noises * signal.noise_std:
                yield (
                    f"{name}: {len(rows)} rows of {signal.name} in the pose {pose!r} "
                    f"scatter by {scatter:.2g} {signal.unit}, the stated noise is {signal.noise_std:.2g}"
                )


def remarks_on_skipped(simulations: Mapping[str, SimulatedRecord]) -> Iterator[str]:
    """Report signals that are not compared, with the records and the reason."""
    found: dict[tuple[str, str], list[str]] = {}
    for name, simulated in simulations.items():
        record = simulated.record
        for signal, why in simulated.skipped.items():
            if record.kind == "motion" or not is_input(record, record.signals[signal]):
                found.setdefault((signal, why), []).append(name)
    for (signal, why), names in found.items():
        reason = why.removeprefix(f"signal {signal!r}: ").removeprefix(f"signal {signal!r} ")
        yield f"{listed(names)}: {signal} is not compared: {reason}"


def plausibility_doubts(
    arm: Arm, records: Mapping[str, Record], confirmed: Mapping[str, Collection[str]] | None = None
) -> tuple[str, ...]:
    """Report implausible values of the model and of each record.

    `confirmed` has by record the drives whose angles places confirm, however far they turn.
    """
    found = [f"model: {problem}" for problem in implausible_sizes(arm)]
    for name, record in records.items():
        sure = {f"signals.{drive}" for drive in (confirmed or {}).get(name, ())}
        units = [problem for problem in unit_problems(record, arm) if problem.where not in sure]
        problems = [*units, *mismatched_durations(record), *implausible_values(record, arm)]
        found += [f"{name}: {problem}" for problem in problems]
    return tuple(found)


def drop_missing_channels(name: str, record: Record) -> tuple[Record, list[str]]:
    """Return the record without empty axes of vectors that are evidence, and a remark on each."""
    kept, notes = dict(record.signals), []
    for signal in record.signals.values():
        there = [bool(np.isfinite(column).any()) for column in signal.values.T]
        vector = signal.spec.channels is None and signal.quantity not in INPUTS
        if vector and any(there) and not all(there):
            kept[signal.name] = signal.replace(
                axes=tuple(compress(signal.axes, there)),
                channels=tuple(compress(signal.channels, there)),
                values=signal.values[:, there],
            )
            lost = ", ".join(axis for axis, seen in zip(signal.axes, there, strict=True) if not seen)
            notes.append(f"{name}: {signal.name} holds no value along {lost}; the rest of it is compared")
    return record.replace(signals=kept) if notes else record, notes


def drop_zero_rows(name: str, record: Record) -> tuple[Record, list[str]]:
    """Return the record without rows of zeros of trackers that lost their target, and a remark on each.

    Zeros in all axes are a place where the point comes near, within two of its greatest steps.
    """
    notes = []
    for signal in record.of_quantity("position").values():
        zero = (signal.values == 0).all(axis=1)
        seen = signal.values[signal.valid & ~zero]
        if record.kind == "static" or len(signal.axes) < 2 or not zero.any() or len(seen) < 2:
            continue
        steps = np.linalg.norm(np.diff(seen, axis=0), axis=1)
        if np.linalg.norm(seen, axis=1).min() > 2 * steps.max():
            record = blank_rows(record, signal.name, zero)
            rows = row_list(np.flatnonzero(zero).tolist())
            notes.append(f"{name}: {signal.name} holds zeros in all axes, removed: {rows}")
    return record, notes


def remarks_on_stamps(records: Mapping[str, Record]) -> list[str]:
    """Report pauses, drop-outs and unexpected noise of all signals."""
    return [
        f"{name}: {remark}"
        for name, record in records.items()
        for signal in record.signals.values()
        for remark in _remarks(signal)
    ]


def _remarks(signal: Signal) -> list[str]:
    found = []
    lost = 1.0 - float(np.mean(signal.valid)) if len(signal) else 1.0
    if POLICY.lost_share < lost < 1:  # empty signals are reported as not compared
        found.append(f"{signal.name} holds no value in {lost:.0%} of its {len(signal)} rows")
    if len(signal.time) > 2:
        steps = np.diff(signal.time)
        worst = int(np.argmax(steps))
        if steps[worst] > POLICY.pause_ratio * np.median(steps):
            found.append(
                f"{signal.name} pauses for {steps[worst]:.3g} s after t = {signal.time[worst]:.6g} s; "
                f"its samples are usually {np.median(steps):.3g} s apart"
            )
    if signal.quantity == "joint_angle" and signal.noise_std and signal.rate_hz >= POLICY.smooth_rate_hz:
        noise, stated = drive_noise(signal.time, signal.values[:, 0]), signal.noise_std
        if noise and not stated / POLICY.unusual_ratio < noise < stated * POLICY.unusual_ratio:
            found.append(
                f"the noise of {signal.name} is about {noise:.2g} {signal.unit}, stated is {stated:.2g}"
            )
    return found
