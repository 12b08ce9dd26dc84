r"""Cells of a residual: its size by signal, direction, band and state of the motion, against the noise.

A cell holds the samples i of one part r of a residual (one direction, one band) for which a condition holds:

    rms^2 = mean r_i^2,    ratio = rms/noise_rms,    share = sum (r_i/sigma_i)^2 / sum over the whole    (1)

sigma_i is the noise of a full sample, so shares of signals in metres and newton metres compare. White noise
leaves noise_rms^2 = sigma^2 k/n in a part with k degrees of freedom at n samples. In a cell of m samples it
leaves, approximately, a chi-square with m k/n degrees of freedom. A cell exceeds the noise if noise alone
would reach it in one table out of a thousand.

The dominant cells say when a part occurs:

    a reversal    if the residual jumps with the sign of a joint's torque or rate: the mean on either side
                  explains most of it, and about as much as a curve over the state; of all bands together,
                  for a jump is in all of them, or of this band, if others ring;
    a condition   if its squares concentrate there: a share s of the squares in a share p of the samples with
                  s ln(s/p) + (1 - s) ln((1 - s)/(1 - p)) >= `concentration`                            (2)
    throughout    else, with the covariate that it follows, if it follows one.

(2) is the relative entropy [Kullback1951] of the squares given the condition.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexarm.residual_analysis.covariates import CONSTANT, covariate_dependence
from flexarm.residual_analysis.motion_states import conditions, covariate_groups
from flexarm.residual_analysis.noise import exceeds_noise
from flexarm.residual_analysis.policy import POLICY
from flexarm.residual_analysis.residual_parts import SignalResidual

WHOLE = "throughout"
JUMPS = {"sign of torque": "torque", "sense of motion": "motion"}
"""Covariates that jump, and what reverses then."""


@dataclass(frozen=True)
class Cell:
    """Size of a residual in one place."""

    signal: str
    direction: str
    band: str
    """Part of the residual."""
    state: str
    when: str
    """State that sorts the samples, and the condition: "torque sign", "torque positive"; the cells of one
    state share out all samples. "all", "throughout": all of them."""
    band_hz: tuple[float, float]
    """Edges of the band [Hz]."""
    unit: str
    """Of rms."""
    rms: float
    noise_rms: float
    ratio: float
    share: float
    """Eq. (1)."""
    samples: int
    exceeds: bool
    """True if it is more than noise."""


def cell_table(residuals: Sequence[SignalResidual], first_mode: float | None) -> tuple[Cell, ...]:
    """Return all cells that hold samples, given the frequency of the first mode [Hz]."""
    total = sum(float(np.sum(rows.whitened**2)) for rows in residuals)
    places = [
        (rows, direction, part, state, when, mask)
        for rows in residuals
        for state, when, mask in conditions(rows.states, rows.time, rows.record, rows.labels, first_mode)
        if mask.any()
        for direction, parts in rows.parts.items()
        for part in parts
    ]
    found = []
    for rows, direction, part, state, when, mask in places:
        values, noise, sigma = part.values[mask], part.noise[mask], rows.noise[direction][mask]
        square, noise_square = float(np.mean(values**2)), float(np.mean(noise**2))
        whitened, freedoms = float(np.sum((values / sigma) ** 2)), float(np.sum((noise / sigma) ** 2))
        found.append(
            Cell(
                rows.signal,
                direction,
                part.band,
                state,
                when,
                part.band_hz,
                rows.unit,
                float(np.sqrt(square)),
                float(np.sqrt(noise_square)),
                float(np.sqrt(square / noise_square)) if noise_square > 0 else 0.0,
                whitened / total if total > 0 else 0.0,
                int(mask.sum()),
                exceeds_noise(whitened, freedoms, POLICY.false_alarm / len(places)),
            )
        )
    return tuple(found)


def dominant_cells(
    residuals: Iterable[SignalResidual], cells: Iterable[Cell]
) -> tuple[Mapping[str, Any], ...]:
    """Return the entries `where` of a report: one for each part that is listed, largest share first."""
    by_part: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in cells:
        by_part.setdefault((cell.signal, cell.direction, cell.band), []).append(cell)
    rows = {each.signal: each for each in residuals}
    entries = []
    for whole in _listed([next(cell for cell in own if cell.when == WHOLE) for own in by_part.values()]):
        said, cell = _occurrence(
            rows[whole.signal], whole, by_part[whole.signal, whole.direction, whole.band]
        )
        entries.append(
            {
                "signal": cell.signal,
                "direction": cell.direction,
                "when": said,
                "band_hz": [cell.band_hz[0], cell.band_hz[1]],
                "rms": cell.rms,
                "noise_rms": cell.noise_rms,
            }
        )
    return tuple(entries)


def _listed(parts: Sequence[Cell], most: int = 8) -> list[Cell]:
    """Return the parts to list; the largest of every signal comes before the second of another."""
    ranks: dict[str, int] = {}
    found = []
    for cell in sorted(parts, key=lambda cell: -cell.share):
        own = [other for other in parts if other.signal == cell.signal]
        total = sum(other.share for other in own)
        largest = max(other.share for other in own if other.band == cell.band)
        least = max(POLICY.listed_share * total, POLICY.minor_share * largest)
        if cell.exceeds and cell.share >= least:
            found.append((ranks.setdefault(cell.signal, 0), cell))
            ranks[cell.signal] += 1
    kept = sorted(found, key=lambda item: (item[0] > 0, -item[1].share))[:most]
    return sorted((cell for _, cell in kept), key=lambda cell: -cell.share)


def _occurrence(rows: SignalResidual, whole: Cell, cells: Sequence[Cell]) -> tuple[str, Cell]:
    """Return the wording of when a part occurs, and the cell whose size goes with it."""
    part = next(each for each in rows.parts[whole.direction] if each.band == whole.band)
    covariates, noise = covariate_groups(rows.states, rows.time, rows.record), rows.noise[whole.direction]
    of_all = covariate_dependence(covariates, (rows.directions[whole.direction] / noise)[:, None])
    of_part = covariate_dependence(covariates, (part.values / noise)[:, None])
    explained = POLICY.explained_share
    for kind, state in JUMPS.items():
        for each in (of_all, of_part):
            if each.best.startswith(kind) and each.adjusted[each.best] >= explained:
                return f"{state} reversal{each.best.removeprefix(kind)}", whole
    densest = max(cells, key=lambda cell: concentration(cell, whole))
    if concentration(densest, whole) >= POLICY.concentration and densest.exceeds:
        return densest.when, densest
    if of_part.best != CONSTANT and of_part.adjusted[of_part.best] >= explained:
        return f"{WHOLE}, follows {of_part.best}", whole
    return f"{WHOLE}, constant" if of_part.constant >= explained else WHOLE, whole


def concentration(cell: Cell, whole: Cell) -> float:
    """Return the relative entropy (2) of a condition; 0 where the squares are fewer than the samples."""
    if cell.state == "all" or whole.share <= 0:
        return 0.0
    s, p = cell.share / whole.share, cell.samples / whole.samples
    if s <= p or p >= 1:
        return 0.0
    rest = (1 - s) * np.log((1 - s) / (1 - p)) if s < 1 else 0.0
    return float(s * np.log(s / p) + rest)  # eq. (2)
