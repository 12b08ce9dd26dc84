r"""Cells: how much of a gap lies where, by signal, direction, band and state, against the noise.

A cell holds the samples i of one part r of a gap (one direction, one band) in which a condition is met:

    rms^2 = mean r_i^2,    ratio = rms/noise_rms,    share = sum (r_i/sigma_i)^2 / sum over the whole    (1)

sigma_i is the noise of a full sample, so shares of signals in metres and newton metres compare. White noise
leaves noise_rms^2 = sigma^2 k/n in a part with k freedoms at n samples, and in a cell with m of them a
chi-square with m k/n freedoms, about. A cell exceeds the noise if noise alone would reach it in one table out
of a thousand.

The few cells that say most of where a gap is.

For each part of the gap (signal, direction, band) one line. When it occurs is said by

    a reversal    if the gap jumps with the sign of a joint's torque or rate: the mean on either side
                  explains most of it, and about as much as a curve over the state; of all bands
                  together, for a jump is in all of them, or of this one, if others ring;
    a condition   if its squares crowd in it: s of the squares in p of the samples, and
                  s ln(s/p) + (1 - s) ln((1 - s)/(1 - p)) >= `CROWDED`                                (1)
    throughout    else, with the state that it follows, if it follows one.

(1) is the information [Kullback1951] that the condition gives on where the squares are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.residual_analysis.covariates import CONSTANT, CovariateDependence, covariate_dependence
from flexarm.residual_analysis.motion_states import conditions, covariate_groups
from flexarm.residual_analysis.residual_parts import ResidualPart, SignalResidual

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


def cells_of(gaps: Sequence[SignalResidual], first_mode: float | None) -> tuple[Cell, ...]:
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


def reversal_window(rows: SignalResidual, first_mode: float | None) -> float:
    """How long after a reversal counts as one [s]: a period of the first mode, or three samples."""
    steps = np.diff(rows.time)
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    return max(REVERSAL_PERIODS / first_mode if first_mode else 0.0, 3 * step)


def _conditions(rows: SignalResidual, first_mode: float | None) -> Iterator[tuple[str, str, Mask]]:
    window = reversal_window(rows, first_mode)
    return conditions(rows.states, rows.time, rows.record, rows.labels, window)


def _cell(
    rows: SignalResidual,
    direction: str,
    part: ResidualPart,
    state: str,
    when: str,
    mask: Mask,
    total: float,
    alarm: float,
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


CROWDED = 0.15
FOLLOWS = 0.5
"""Share of what is not constant that a state must explain to be named."""
SMALL = 0.02
"""Share of its signal's squared gap below which a part is not listed."""
BESIDE = 0.1
"""Share of a signal's largest part in a band below which its other directions are not listed."""
LINES = 8
"""Most lines; the largest part of every signal comes before the second of another."""
JUMPS = {"sign of torque": "torque", "sense of motion": "motion"}
"""States that jump, and what reverses then."""


def dominant_cells(gaps: Sequence[SignalResidual], cells: Iterable[Cell]) -> tuple[Mapping[str, Any], ...]:
    """The entries `where` of a report: signal, direction, when, band_hz, rms, noise_rms; largest first."""
    by_part: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in cells:
        by_part.setdefault((cell.signal, cell.direction, cell.band), []).append(cell)
    rows = {each.signal: each for each in gaps}
    listed = _listed([next(cell for cell in found if cell.when == WHOLE) for found in by_part.values()])
    return tuple(
        _line(rows[cell.signal], cell, by_part[cell.signal, cell.direction, cell.band]) for cell in listed
    )


def _listed(parts: Sequence[Cell]) -> list[Cell]:
    """The parts that are worth a line, largest share first."""
    ranks: dict[str, int] = {}
    found = []
    for cell in sorted(parts, key=lambda cell: -cell.share):
        own = [other for other in parts if other.signal == cell.signal]
        total = sum(other.share for other in own)
        largest = max(other.share for other in own if other.band == cell.band)
        if cell.exceeds and cell.share >= max(SMALL * total, BESIDE * largest):
            found.append((ranks.setdefault(cell.signal, 0), cell))
            ranks[cell.signal] += 1
    kept = sorted(found, key=lambda item: (item[0] > 0, -item[1].share))[:LINES]
    return sorted((cell for _, cell in kept), key=lambda cell: -cell.share)


def _line(rows: SignalResidual, whole: Cell, cells: Sequence[Cell]) -> Mapping[str, Any]:
    """One entry."""
    part = next(each for each in rows.parts[whole.direction] if each.band == whole.band)
    groups, noise = covariate_groups(rows.states, rows.time, rows.record), rows.noise[whole.direction]
    jumps = covariate_dependence(groups, (rows.directions[whole.direction] / noise)[:, None])
    said, cell = _when(jumps, covariate_dependence(groups, (part.values / noise)[:, None]), whole, cells)
    return {
        "signal": cell.signal,
        "direction": cell.direction,
        "when": said,
        "band_hz": [cell.band_hz[0], cell.band_hz[1]],
        "rms": cell.rms,
        "noise_rms": cell.noise_rms,
    }


def _when(
    jumps: CovariateDependence, follows: CovariateDependence, whole: Cell, cells: Sequence[Cell]
) -> tuple[str, Cell]:
    """Wording, and the cell whose measures go with it."""
    for kind, state in JUMPS.items():
        for each in (jumps, follows):
            if each.best.startswith(kind) and each.beyond[each.best] >= FOLLOWS:
                return f"{state} reversal{each.best.removeprefix(kind)}", whole
    crowded = max(cells, key=lambda cell: concentration(cell, whole))
    if concentration(crowded, whole) >= CROWDED and crowded.exceeds:
        return crowded.when, crowded
    if follows.best != CONSTANT and follows.beyond[follows.best] >= FOLLOWS:
        return f"{WHOLE}, follows {follows.best}", whole
    return f"{WHOLE}, constant" if follows.constant >= FOLLOWS else WHOLE, whole


def concentration(cell: Cell, whole: Cell) -> float:
    """Information (1) of a condition; 0 where the squares are fewer than the samples."""
    if cell.state == "all" or whole.share <= 0:
        return 0.0
    s, p = cell.share / whole.share, cell.samples / whole.samples
    if s <= p or p >= 1:
        return 0.0
    rest = (1 - s) * np.log((1 - s) / (1 - p)) if s < 1 else 0.0
    return float(s * np.log(s / p) + rest)  # eq. (1)
