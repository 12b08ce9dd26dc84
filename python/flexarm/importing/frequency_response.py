"""Frequency responses from logs: real and imaginary part in SI, from what the columns hold."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.importing.map_file import SignalMap
from flexarm.importing.source import Array, Samples, Unreadable, as_numbers
from flexarm.record.consistency import response_unit
from flexarm.record.signal import Signal

HZ = {"Hz": 1.0, "kHz": 1e3, "rad/s": 1 / (2 * pi)}
"""Unit of frequencies -> factor to Hz."""


def check_frequencies(column: Array, place: Callable[[int], str]) -> None:
    """Refuse frequencies that are negative or do not rise.

    Raise Unreadable with the place of the first one.
    """
    found = as_numbers(column, place, "the column of frequencies", "frequency")
    wrong = np.flatnonzero(~(np.diff(found, prepend=-1e-300) > 0) | ~(found >= 0))
    if len(wrong):
        row = int(wrong[0])
        what = f"{place(row)}: frequencies must be at least 0 and rise, got {found[row]:.9g}"
        raise Unreadable("frequency", what)


def response_of(table: SignalMap, samples: Samples, signals: Sequence[SignalMap], clock: str) -> Signal:
    """Return a response in SI, output per input, or the input without values.

    Raise Unreadable if complex numbers stand where the map says none, or none where it says them.
    """
    where = {**table.located, "clock": clock}
    if table.input is None:
        return Signal(
            name=table.name,
            quantity=table.quantity,
            values=samples.values,
            unit=table.si[0],
            frequency=np.empty(0),
            **where,
        )
    unit, factor = response_unit(table, next(s for s in signals if s.name == table.input))
    frequency, *coherence = (
        column.astype(float) for column in samples.others[: 1 + (table.coherence is not None)]
    )
    return Signal(
        name=table.name,
        quantity=table.quantity,
        values=_parts(table, samples.values) * factor,
        unit=unit,
        frequency=frequency * HZ[table.frequency_unit],
        input=table.input,
        coherence=coherence[0] if coherence else None,
        averages=table.averages,
        noise_std=table.noise_std,
        jitter_std=table.jitter_std,
        file=f"{Path(table.source).stem}.csv",
        **where,
    )


def _parts(table: SignalMap, values: Floats) -> Floats:
    """Return real and imaginary parts, times the scale, (n, 2 channels)."""
    count = len(table.columns) * (2 if table.response == "complex" else 1)
    if values.shape[1] != count:
        kind = "complex" if values.shape[1] > len(table.columns) else "real"
        raise Unreadable("response", f"is {table.response!r}, but the columns hold {kind} numbers")
    each = count // len(table.scale) if len(table.scale) > 1 else count
    scale = np.repeat(np.array(table.scale), each)
    if table.response in ("real-imaginary", "complex"):
        return np.asarray(values * scale)
    size, phase = values[:, ::2], values[:, 1::2]
    size = 10 ** (size / 20) if table.response == "decibel-phase" else size
    turned = scale[::2] * size * np.exp(1j * (np.radians(phase) if table.phase_unit == "deg" else phase))
    return np.stack([turned.real, turned.imag], axis=2).reshape(values.shape)
