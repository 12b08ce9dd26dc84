r"""Localisation of the residual: by signal, direction, band and state of the motion, against the noise.

Localisation runs no simulation. It analyses all records together, each with its own simulation after
alignment (`flexarm.comparison.aligned_record`), of the nominal model or any other.

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
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.comparison.aligned_record import AlignedRecord, by_name
from flexarm.errors import InvalidParameter
from flexarm.pictures import Summarised
from flexarm.report.state_figures import gap_figure
from flexarm.residual_analysis.joint_rotations import JointRotations, joint_rotations
from flexarm.residual_analysis.motion_states import (
    CONSTANT,
    CovariateDependence,
    conditions,
    covariate_dependence,
    covariate_groups,
    moved_joints,
)
from flexarm.residual_analysis.noise_floor import estimated_noise, exceeds_noise
from flexarm.residual_analysis.policy import POLICY
from flexarm.residual_analysis.residual_parts import SignalResidual, signal_residual
from flexarm.residual_analysis.spectrum import MotorHarmonics
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


def _listed(parts: Sequence[Cell]) -> list[Cell]:
    """Return the parts to list, at most eight; the largest of every signal before the second of another."""
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
    kept = sorted(found, key=lambda item: (item[0] > 0, -item[1].share))[:8]
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


@dataclass(frozen=True, eq=False, repr=False)
class Localisation(Summarised):
    """Where the residual lies."""

    cells: tuple[Cell, ...]
    """Every cell that holds samples: signal x direction x band x condition of a state."""
    where: tuple[Mapping[str, Any], ...]
    """The dominant cells, largest share first: signal, direction, when, band_hz, rms, noise_rms."""
    dependence: Mapping[str, CovariateDependence]
    """By signal: the state that the residual follows."""
    rotations: JointRotations | None
    """The residual of positions as small rotations of the joints."""
    gaps: Mapping[str, SignalResidual]
    """By signal: the residual itself, with the states at its samples."""
    notes: tuple[str, ...] = ()
    """Notes for the reader: aliasing, noise that was estimated."""

    def cell(self, signal: str, direction: str, band: str, when: str = WHOLE) -> Cell:
        """Return one cell.

        Raise InvalidParameter if there is none of these names.
        """
        for each in self.cells:
            if (each.signal, each.direction, each.band, each.when) == (signal, direction, band, when):
                return each
        raise InvalidParameter(
            f"there is no cell {signal!r}, {direction!r}, {band!r}, {when!r}; signals are "
            f"{', '.join(self.gaps)}, bands of {signal!r} "
            f"{', '.join(dict.fromkeys(c.band for c in self.cells if c.signal == signal)) or 'none'}"
        )

    def summary(self) -> str:
        """Return tables that a person reads: parts of the residual, where it lies, which state it follows."""
        lines = [f"{'signal':<18}{'direction':<13}{'band':<27}{'Hz':>16}{'rms':>11}{'noise':>11}{'share':>8}"]
        for cell in (cell for cell in self.cells if cell.state == "all"):
            hz = f"{cell.band_hz[0]:.3g} to {cell.band_hz[1]:.3g}"
            rms, noise = (with_unit(value, cell.unit) for value in (cell.rms, cell.noise_rms))
            lines.append(
                f"{cell.signal:<18}{cell.direction:<13}{cell.band:<27}{hz:>16}{rms:>11}{noise:>11}"
                f"{100 * cell.share:7.1f}%{'' if cell.exceeds else '  noise'}"
            )
        lines += ["", "where the gap is" if self.where else "nowhere does the gap exceed the noise"]
        for each in self.where:
            low, high = each["band_hz"]
            unit = self.gaps[each["signal"]].unit
            lines.append(
                f"  {each['signal']}, {each['direction']}, {each['when']}, {low:.3g} to {high:.3g} Hz: "
                f"{with_unit(each['rms'], unit)} rms, noise {with_unit(each['noise_rms'], unit, 2)}"
            )
        lines += ["", f"{'signal':<18}what the gap follows, by share"]
        lines += [f"{name:<18}{found}" for name, found in self.dependence.items()]
        if self.rotations is not None:
            lines += ["", self.rotations.summary()]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def plot(self, signal: str | None = None) -> Figure:
        """Draw the residual of a signal (default: the largest) against angle, rate, torque and time."""
        return gap_figure(self, signal=signal)


def localise(pairs: Mapping[str, AlignedRecord] | AlignedRecord) -> Localisation:
    """Return where the residual lies, over all records together: by name all motions, or all poses.

    Raise InvalidParameter if there is no record, or motions and poses are mixed: they have no bands in
    common.

    >>> print(localise({"train_a": simulate_record(arm, record)}))  # doctest: +SKIP
    """
    records = by_name(pairs)
    kinds = {pair.record.kind: name for name, pair in records.items()}
    if len(kinds) > 1:
        raise InvalidParameter(
            f"must be all motions or all poses, but {kinds['static']!r} holds poses and "
            f"{kinds['motion']!r} holds a motion",
            where="pairs",
        )
    joints = moved_joints(list(records.values()))
    shown = {pair.joint for pair in records.values()}
    joint = shown.pop() if len(shown) == 1 else None
    waves = {name: MotorHarmonics(pair) for name, pair in records.items()}
    gaps, notes = {}, []
    for name in dict.fromkeys(name for pair in records.values() for name in pair.simulated.evidence):
        noise = _noise_where_none_is_stated(records, name)
        if noise is not None:
            notes.append(f"no noise is stated for {name}: {noise:.2g} is taken, from the gap itself")
        rows = signal_residual(records, waves, name, joints, joint, 1.0 if noise is None else noise)
        if rows is not None:
            gaps[name] = rows
    modes_hz = [pair.modes_hz[0] for pair in records.values() if pair.modes_hz]
    cells = cell_table(list(gaps.values()), min(modes_hz, default=None))
    return Localisation(
        cells,
        dominant_cells(gaps.values(), cells),
        {
            name: covariate_dependence(covariate_groups(rows.states, rows.time, rows.record), rows.whitened)
            for name, rows in gaps.items()
        },
        joint_rotations(records),
        gaps,
        (*notes, *dict.fromkeys(note for rows in gaps.values() for note in rows.notes)),
    )


def _noise_where_none_is_stated(pairs: Mapping[str, AlignedRecord], name: str) -> float | None:
    """Return 1 sigma from the residual of a signal, 1 without scatter; None where noise is stated."""
    pair = next(pair for pair in pairs.values() if name in pair.simulated.evidence)
    signal = pair.simulated.signals[name]
    if signal.noise_std:
        return None
    residual = pair.simulated.residual(signal, pair.aligned.placement)
    scatter = estimated_noise(pair, signal, residual)
    scale = float(np.sqrt(np.nanmean(residual**2))) if np.isfinite(residual).any() else 0.0
    return max(scatter or 0.0, 1e-6 * scale) or 1.0
