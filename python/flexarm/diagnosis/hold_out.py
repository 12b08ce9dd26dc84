"""What is held out of a diagnosis, and how far it lies from what is fitted.

Without a record of its own, whole blocks of every record are held back: every fifth twentieth of its time
(every fifth pose of a static record). The motion is continuous and its drive is known throughout, so that
only evidence is taken from one part and left in the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.comparison.poses import is_input

if TYPE_CHECKING:
    from flexarm.record import Record, Signal

BLOCKS, EVERY = 20, 5
"""Blocks of a record, of which every so-many-th is held back."""
SAME = 0.05
"""Relative difference within which two motions or payloads count as the same."""


def hold_back(record: Record) -> tuple[Record, Record]:
    """A record without the blocks that are held back, and one with nothing else."""
    first, last = _span(record)
    fitted, held = dict(record.signals), dict(record.signals)
    for name, signal in record.signals.items():
        if name in record.drive or (record.kind == "static" and is_input(record, signal)):
            continue
        back = _held(record, signal, first, last)
        fitted[name] = _without(signal, back)
        held[name] = _without(signal, ~back)
    return replace(record, signals=fitted), replace(record, signals=held)


def hold_out_kind(training: Mapping[str, Record], held_out: Record) -> str:
    """How far a held-out record lies from the training.

    Returns
    -------
    {"repetition", "interpolation", "extrapolation"}
        By payload, range and rates of the drives, and how far links were drawn out: as in one of the records
        of training, between them, or beyond.
    """
    asked = _features(held_out)
    alike = [
        _features(record)
        for record in training.values()
        if len(record.drive) == len(held_out.drive) and record.links.keys() == held_out.links.keys()
    ]
    if not alike:
        return "extrapolation"
    known = np.array(alike)
    size = np.maximum(np.abs(np.vstack([known, asked])).max(axis=0), 1e-12)
    if (np.abs(known - asked) <= SAME * size).all(axis=1).any():
        return "repetition"
    low, high = known.min(axis=0) - SAME * size, known.max(axis=0) + SAME * size
    return "interpolation" if ((asked >= low) & (asked <= high)).all() else "extrapolation"


def _features(record: Record) -> NDArray[np.float64]:
    """Range and rms rate of each drive, lengths of links, and the mass that was weighed (-1: nominal)."""
    found = [record.links[name].length for name in sorted(record.links)]
    for name in record.drive:
        signal = record.signals[name]
        values = signal.values[np.isfinite(signal.values[:, 0]), 0]
        found += [float(values.min()), float(values.max())] if len(values) else [0.0, 0.0]
        found.append(_rate(signal))
    weighed = [float(load.mass) for load in record.payloads.values() if load.mass is not None]
    return np.array([*found, sum(weighed) if weighed else -1.0])


def _rate(signal: Signal) -> float:
    """Rms rate of a drive over tenths of a second, so that noise does not count; 0 for poses."""
    if signal.pose is not None or len(signal.time) < 3:
        return 0.0
    step = max(1, round(0.1 / float(np.median(np.diff(signal.time)))))
    values, time = signal.values[::step, 0], signal.time[::step]
    rate = np.diff(values) / np.diff(time)
    return float(np.sqrt(np.nanmean(rate**2))) if len(rate) else 0.0


def _span(record: Record) -> tuple[float, float]:
    times = [s.time for s in record.signals.values() if s.pose is None and len(s.time)]
    return (min(t[0] for t in times), max(t[-1] for t in times)) if times else (0.0, 1.0)


def _held(record: Record, signal: Signal, first: float, last: float) -> NDArray[np.bool_]:
    """Rows that are held back."""
    if signal.pose is not None:
        number = {pose: k for k, pose in enumerate(dict.fromkeys(signal.pose.tolist()))}
        return np.array([number[pose] % EVERY == EVERY - 1 for pose in signal.pose.tolist()], dtype=bool)
    block = np.minimum((BLOCKS * (signal.time - first) / max(last - first, 1e-12)).astype(int), BLOCKS - 1)
    found: NDArray[np.bool_] = block % EVERY == EVERY - 1
    return found


def _without(signal: Signal, rows: NDArray[np.bool_]) -> Signal:
    return replace(signal, values=np.where(rows[:, None], np.nan, signal.values))
