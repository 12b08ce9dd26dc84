r"""Cells: how much of a gap lies where, by signal, direction, band and state, against the noise.

A cell holds the samples i of one part r of a gap (one direction, one band) in which a condition is met:

    rms^2 = mean r_i^2,    ratio = rms/noise_rms,    share = sum (r_i/sigma_i)^2 / sum over the whole    (1)

sigma_i is the noise of a full sample, so shares of signals in metres and newton metres compare. White noise
leaves noise_rms^2 = sigma^2 k/n in a part with k freedoms at n samples, and in a cell with m of them a
chi-square with m k/n freedoms, about. A cell exceeds the noise if noise alone would reach it in one table out
of a thousand.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.diagnosis.gap.conditions import conditions
from flexarm.diagnosis.gap.gap_parts import Part
from flexarm.diagnosis.gap.gap_rows import GapRows

Mask = NDArray[np.bool_]

ALARM = 1e-3
"""Probability that any cell of a table exceeds white noise by chance."""
WHOLE = "throughout"
REVERSAL_PERIODS = 1.0
"""How long after a reversal, in periods of the first mode."""


@dataclass(frozen=True)
class Cell:
    """How much of the gap lies in one place.

    Attributes
    ----------
    signal, direction, band : str
        Which part of the gap.
    state, when : str
        What sorts the samples, and which of them: "torque sign", "torque positive"; cells of one state share
        out all samples. "all", "throughout": all of them.
    band_hz : tuple of float
        Edges of the band [Hz].
    unit : str
        Of rms.
    rms, noise_rms, ratio, share
        Eq. (1).
    samples : int
        How many.
    exceeds : bool
        Whether it is more than noise.
    """

    signal: str
    direction: str
    band: str
    state: str
    when: str
    band_hz: tuple[float, float]
    unit: str
    rms: float
    noise_rms: float
    ratio: float
    share: float
    samples: int
    exceeds: bool


def cells_of(gaps: Sequence[GapRows], first_mode: float | None) -> tuple[Cell, ...]:
    """All cells that hold samples."""
    total = sum(float(np.sum(rows.whitened**2)) for rows in gaps)
    sorted_ = [
        (rows, direction, part, state, when, mask)
        for rows in gaps
        for state, when, mask in _conditions(rows, first_mode)
        if mask.any()
        for direction, parts in rows.parts.items()
        for part in parts
    ]
    return tuple(_cell(*each, total, ALARM / len(sorted_)) for each in sorted_)


def reversal_window(rows: GapRows, first_mode: float | None) -> float:
    """How long after a reversal counts as one [s]: a period of the first mode, or three samples."""
    steps = np.diff(rows.time)
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    return max(REVERSAL_PERIODS / first_mode if first_mode else 0.0, 3 * step)


def _conditions(rows: GapRows, first_mode: float | None) -> Iterator[tuple[str, str, Mask]]:
    window = reversal_window(rows, first_mode)
    return conditions(rows.states, rows.time, rows.record, rows.labels, window)


def _cell(
    rows: GapRows, direction: str, part: Part, state: str, when: str, mask: Mask, total: float, alarm: float
) -> Cell:
    """Measures (1) of one cell."""
    values, sigma, m = part.values[mask], rows.noise[direction][mask], int(mask.sum())
    square, noise = float(np.mean(values**2)), float(np.mean(part.noise[mask] ** 2))
    whitened = float(np.sum((values / sigma) ** 2))
    return Cell(
        rows.signal,
        direction,
        part.band,
        state,
        when,
        part.band_hz,
        rows.unit,
        float(np.sqrt(square)),
        float(np.sqrt(noise)),
        float(np.sqrt(square / noise)) if noise > 0 else 0.0,
        whitened / total if total > 0 else 0.0,
        m,
        exceeds_noise(whitened, float(np.sum((part.noise[mask] / sigma) ** 2)), alarm),
    )


def exceeds_noise(squares: float, freedoms: float, alarm: float) -> bool:
    """Whether a sum of squares, over their variance, is more than chi-square at a false-alarm probability."""
    from scipy.special import chdtri

    # less than one freedom spreads no wider than one whose variance is that much smaller
    scale = min(freedoms, 1.0)
    return bool(scale > 0 and squares / scale > chdtri(max(freedoms, 1.0), alarm))
