"""Localisation of the residual: by signal, direction, band and state of the motion, against the noise.

Localisation runs no simulation. It analyses all records together, each with its own simulation after
alignment (`flexarm.comparison.aligned_record`), of the nominal model or any other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.errors import InvalidParameter
from flexarm.residual_analysis.cells import WHOLE, Cell, cell_table, dominant_cells
from flexarm.residual_analysis.covariates import CovariateDependence, covariate_dependence
from flexarm.residual_analysis.joint_rotations import JointRotations, joint_rotations
from flexarm.residual_analysis.motion_states import covariate_groups, moved_joints
from flexarm.residual_analysis.noise import estimated_noise
from flexarm.residual_analysis.order_tracking import MotorHarmonics
from flexarm.residual_analysis.residual_parts import SignalResidual, signal_residual
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Localisation:
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
        from flexarm.report.state_figures import gap_figure

        return gap_figure(self, signal=signal)

    def __repr__(self) -> str:
        return self.summary()


def localise(pairs: Mapping[str, AlignedRecord] | AlignedRecord) -> Localisation:
    """Return where the residual lies, over all records together: by name all motions, or all poses.

    Raise InvalidParameter if there is no record, or motions and poses are mixed: they have no bands in
    common.

    >>> print(localise({"train_a": simulate_record(arm, record)}))  # doctest: +SKIP
    """
    records = {"record": pairs} if isinstance(pairs, AlignedRecord) else dict(pairs)
    if not records:
        raise InvalidParameter("needs at least one record beside its simulation, got none", where="pairs")
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
