"""Remarks on records: too few poses for outliers, signals not compared, missing channels, implausible values.

The gain does not show a channel that keeps an absurd distance from its prediction but follows its motion.
Signals with stamps in another unit have hardly a reading to compare. No sensor can be judged with such
values.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.sizes import implausible_sizes
from flexarm.comparison.pose_outliers import LEAST_POSES
from flexarm.comparison.poses import is_input
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.record import Record, Signal
from flexarm.record.compatibility import implausible_values
from flexarm.record.plausibility import INPUTS, unit_problems
from flexarm.record.time_unit import mismatched_durations
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
            kept[signal.name] = _part(signal, there)
            lost = ", ".join(axis for axis, seen in zip(signal.axes, there, strict=True) if not seen)
            notes.append(f"{name}: {signal.name} holds no value along {lost}; the rest of it is compared")
    return record.replace(signals=kept) if notes else record, notes


def _part(signal: Signal, wanted: list[bool]) -> Signal:
    """Return a signal with some of its axes."""

    def of(names: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(name for name, keep in zip(names, wanted, strict=False) if keep)

    return signal.replace(axes=of(signal.axes), channels=of(signal.channels), values=signal.values[:, wanted])
