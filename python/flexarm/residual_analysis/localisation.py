"""Where simulation and measurement disagree: by signal, direction, band and state, against the noise.

No simulation is run here. Records are looked at together, each beside its own simulation after alignment
(`flexarm.comparison.aligned_record`), with the nominal model or any other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.errors import InvalidParameter
from flexarm.residual_analysis.cells import WHOLE, Cell, cells_of, dominant_cells
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
    """Where the gap is.

    Attributes
    ----------
    cells : tuple of Cell
        Every cell that holds samples: signal x direction x band x condition of a state.
    where : tuple of dict
        The few that say most, largest share first: signal, direction, when, band_hz, rms, noise_rms.
    follows : dict of str to CovariateDependence
        By signal: which state the gap follows.
    rotations : JointRotations or None
        The gap of positions as small rotations of the joints.
    gaps : dict of str to SignalResidual
        By signal: the gap itself, with the states at its samples.
    notes : tuple of str
        What a reader should know: aliasing, noise that was estimated.
    """

    cells: tuple[Cell, ...]
    where: tuple[Mapping[str, Any], ...]
    follows: Mapping[str, CovariateDependence]
    rotations: JointRotations | None
    gaps: Mapping[str, SignalResidual]
    notes: tuple[str, ...] = ()

    def cell(self, signal: str, direction: str, band: str, when: str = WHOLE) -> Cell:
        """One cell.

        Raises
        ------
        InvalidParameter
            If there is none of these names.
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
        """Tables that a person reads: parts of the gap, where it is, what it follows."""
        lines = [*self._part_table(), "", *self._where_table(), ""]
        lines.append(f"{'signal':<18}what the gap follows, by share")
        for name, found in self.follows.items():
            lines.append(f"{name:<18}{found}")
        if self.rotations is not None:
            lines += ["", self.rotations.summary()]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def _part_table(self) -> list[str]:
        """One line a signal, direction and band."""
        head = f"{'signal':<18}{'direction':<13}{'band':<27}{'Hz':>16}{'rms':>11}{'noise':>11}{'share':>8}"
        lines = [head]
        for cell in self.cells:
            if cell.state != "all":
                continue
            hz = f"{cell.band_hz[0]:.3g} to {cell.band_hz[1]:.3g}"
            rms, noise = (with_unit(value, cell.unit) for value in (cell.rms, cell.noise_rms))
            lines.append(
                f"{cell.signal:<18}{cell.direction:<13}{cell.band:<27}{hz:>16}{rms:>11}{noise:>11}"
                f"{100 * cell.share:7.1f}%{'' if cell.exceeds else '  noise'}"
            )
        return lines

    def _where_table(self) -> list[str]:
        """The entries of `where`."""
        lines = ["where the gap is"]
        for each in self.where:
            low, high = each["band_hz"]
            unit = self.gaps[each["signal"]].unit
            lines.append(
                f"  {each['signal']}, {each['direction']}, {each['when']}, {low:.3g} to {high:.3g} Hz: "
                f"{with_unit(each['rms'], unit)} rms, noise {with_unit(each['noise_rms'], unit, 2)}"
            )
        return lines if self.where else ["nowhere does the gap exceed the noise"]

    def plot(self, signal: str | None = None) -> Figure:
        """The gap of a signal against angle, rate, torque and time; default: the signal that holds most."""
        from flexarm.report.gap_figure import gap_figure

        return gap_figure(self, signal=signal)

    def __repr__(self) -> str:
        return self.summary()


def localise(pairs: Mapping[str, AlignedRecord] | AlignedRecord) -> Localisation:
    """Where the gap is, over all records together.

    Parameters
    ----------
    pairs : dict of str to AlignedRecord, or AlignedRecord
        Records by name, each beside its simulation, as `flexarm.comparison.aligned_record.simulate_record`
        gives it; all of one kind, motions or poses.

    Returns
    -------
    Localisation

    Raises
    ------
    InvalidParameter
        If there is nothing to look at.

    Examples
    --------
    >>> print(localise({"train_a": simulate_record(arm, record)}))  # doctest: +SKIP
    """
    beside = {"record": pairs} if isinstance(pairs, AlignedRecord) else dict(pairs)
    if not beside:
        raise InvalidParameter("needs at least one record beside its simulation, got none", where="pairs")
    _of_one_kind(beside)
    joints = moved_joints(list(beside.values()))
    shown = {pair.joint for pair in beside.values()}
    joint = shown.pop() if len(shown) == 1 else None
    names = list(dict.fromkeys(name for pair in beside.values() for name in pair.simulated.evidence))
    noise, notes = _noise(beside, names)
    waves = {name: MotorHarmonics(pair) for name, pair in beside.items()}
    found = {name: signal_residual(beside, waves, name, joints, joint, noise[name]) for name in names}
    gaps = {name: rows for name, rows in found.items() if rows is not None}
    modes_hz = [pair.modes_hz[0] for pair in beside.values() if pair.modes_hz]
    cells = cells_of(list(gaps.values()), min(modes_hz, default=None))
    notes += dict.fromkeys(note for rows in gaps.values() for note in rows.notes)
    return Localisation(
        cells,
        dominant_cells(list(gaps.values()), cells),
        {
            name: covariate_dependence(covariate_groups(rows.states, rows.time, rows.record), rows.whitened)
            for name, rows in gaps.items()
        },
        joint_rotations(beside),
        gaps,
        tuple(notes),
    )


def _of_one_kind(pairs: Mapping[str, AlignedRecord]) -> None:
    """Motions and poses have no bands in common."""
    kinds = {pair.record.kind: name for name, pair in pairs.items()}
    if len(kinds) > 1:
        raise InvalidParameter(
            f"must be all motions or all poses, but {kinds['static']!r} holds poses and "
            f"{kinds['motion']!r} holds a motion",
            where="pairs",
        )


def _noise(pairs: Mapping[str, AlignedRecord], names: list[str]) -> tuple[dict[str, float], list[str]]:
    """Noise of the signals that state none, from their gaps; 1 where a gap has no scatter at all."""
    found, notes = {}, []
    for name in names:
        pair = next(pair for pair in pairs.values() if name in pair.simulated.evidence)
        signal = pair.simulated.signals[name]
        found[name] = 1.0
        if not signal.noise_std:
            residual = pair.simulated.residual(signal, pair.aligned.placement)
            scatter = estimated_noise(pair, signal, residual)
            scale = float(np.sqrt(np.nanmean(residual**2))) if np.isfinite(residual).any() else 0.0
            found[name] = max(scatter or 0.0, 1e-6 * scale) or 1.0
            notes.append(f"no noise is stated for {name}: {found[name]:.2g} is taken, from the gap itself")
    return found, notes
