"""Channels that hold no value at all, such as an axis that is not wired: the others count without them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.record.doubts import INPUTS

if TYPE_CHECKING:
    from flexarm.record import Record, Signal


def without_lost_channels(name: str, record: Record) -> tuple[Record, list[str]]:
    """The record without the empty axes of vectors that are evidence, and a remark on each such signal."""
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
    """Some axes of a signal."""

    def of(names: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(name for name, keep in zip(names, wanted, strict=False) if keep)

    return signal.replace(axes=of(signal.axes), channels=of(signal.channels), values=signal.values[:, wanted])
