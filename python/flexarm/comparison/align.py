"""Alignment: offsets of clocks and registrations of frames that bring a record closest to a simulation.

    sum over signals |(y - prediction(u))/sigma_y|^2 + sum_i ((u_i - c_i)/sigma_i)^2 -> min            (1)

u are the unknowns with priors (c_i, sigma_i), y the measured values with noise sigma_y. Effects of the model
on clocks and frames come on top of u, which so counts from them. The simulation is not repeated: predictions
are read from it at shifted stamps. (1) is solved by Gauss-Newton; a step that does not lower (1) is halved.
Gross outliers (see `flexarm.measurement.outliers`, and `pose_outliers` of poses) are left out, and those of
`SMOOTH` quantities of the gap too, whether their clock and frame move or not; else squares count, not a
robust loss. What the data do not determine keeps its prior, and is said: the standard deviation after
alignment is then that of the prior (more than `KEPT` of it), or, without a prior, infinite.

A gap of the model much larger than the noise outweighs the priors: whatever of it looks like a shift in time
or space is then aligned away, in measurement and in the report alike. `compare(..., align=False)` shows the
gap without that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_place import AlignedPlace
from flexarm.comparison.pose_outliers import pose_outliers
from flexarm.comparison.subject import Placement, Subject
from flexarm.comparison.unknowns import Unknown, noise_is_stated, placed, unknowns
from flexarm.measurement.outliers import SMOOTH, outliers

if TYPE_CHECKING:
    from flexarm.record import Signal

KEPT = 0.9
"""Share of a prior's sigma that is left where the data say nothing."""
FAR = 5.0
"""Number of sigmas beyond which an alignment contradicts what the record states."""
ITERATIONS = 30
FIRM = 1e-12
"""Share of the greatest square below which the rows determine nothing."""


@dataclass(frozen=True)
class Aligned:
    """Outcome of an alignment.

    Attributes
    ----------
    placement : Placement
        Clocks and frames after it.
    unknowns : tuple of Unknown
        What was allowed to move.
    values, std : ndarray
        Where it ended and 1 sigma [s, m, rad]; the sigma counts noise and priors, not an error of the model.
    outliers : dict of str to ndarray of bool, shape (n,)
        Rows that were taken for gross outliers, by signal; of signals that have some.
    places : tuple of AlignedPlace
        How many values of each clock and frame were aligned to how many readings.
    """

    placement: Placement
    unknowns: tuple[Unknown, ...] = ()
    values: Floats | tuple[float, ...] = ()
    std: Floats | tuple[float, ...] = ()
    outliers: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)
    places: tuple[AlignedPlace, ...] = ()

    @property
    def far(self) -> list[str]:
        """What moved further than the record's sigma allows for."""
        pairs = zip(self.unknowns, self.values, strict=True)
        moves = [(u, abs(value - u.centre) / u.sigma) for u, value in pairs if np.isfinite(u.sigma)]
        return [f"{u} ({move:.0f} sigma)" for u, move in moves if move > FAR]

    @property
    def undetermined(self) -> list[str]:
        """What the data say nothing about."""
        return [
            str(u)
            for u, std in zip(self.unknowns, self.std, strict=True)
            if not std < (KEPT * u.sigma if np.isfinite(u.sigma) else np.inf)
        ]

    @property
    def crowded(self) -> list[str]:
        """Sentences on clocks and frames that were aligned to few readings."""
        return [str(place) for place in self.places if place.few]


def align(subject: Subject, start: Placement) -> Aligned:
    """Clocks and frames that minimise (1).

    Parameters
    ----------
    subject : Subject
        Simulation and record.
    start : Placement
        Where to start; clocks and frames without a prior must be near already.
    """
    unknown = unknowns(subject, start)
    places = {each.place for each in unknown}
    out = _gross_outliers(subject, start, places)
    if not unknown:
        return Aligned(start, outliers=out)
    rows = _Rows(subject, start, unknown, out)
    values = np.array([each.centre for each in unknown])
    residual, jacobian = rows(values), _jacobian(rows, values, unknown)
    for _ in range(ITERATIONS):
        change = _least_norm(jacobian, -residual, unknown)[0]
        values, residual, moved = _descend(rows, values, residual, change)
        scaled = np.abs(moved) / [each.step for each in unknown]
        if scaled.max() < 1e-3:
            break
        jacobian = _jacobian(rows, values, unknown)
    std = _least_norm(jacobian, residual, unknown)[1]
    found = placed(start, unknown, values)
    return Aligned(found, tuple(unknown), values, std, out, rows.aligned_places(jacobian))


def _gross_outliers(subject: Subject, start: Placement, places: set[str]) -> dict[str, NDArray[np.bool_]]:
    """Rows that are gross outliers, of signals that are aligned or cannot jump.

    A stated noise tells those of motions, the other poses those of poses.
    """
    wanted = {
        name: signal
        for name, signal in subject.evidence.items()
        if signal.quantity in SMOOTH or _moves(signal, places)
    }
    if subject.record.kind == "static":
        far = pose_outliers(subject, start)
        return {name: far[name].rows for name in wanted if name in far}
    found = {
        name: outliers(subject.residual(signal, start, hold=True), subject.noise(signal))
        for name, signal in wanted.items()
        if noise_is_stated(signal.noise_std)
    }
    return {name: rows for name, rows in found.items() if rows.any()}


def _moves(signal: Signal, places: set[str]) -> bool:
    """Whether its clock or frame is among those that may move."""
    return signal.clock in places or signal.frame in places


class _Rows:
    """Whitened residuals and priors of (1) as one vector; rows without a value, and outliers, are zero."""

    def __init__(
        self,
        subject: Subject,
        start: Placement,
        unknown: list[Unknown],
        gross: Mapping[str, NDArray[np.bool_]],
    ) -> None:
        self.subject, self.start, self.unknown = subject, start, unknown
        places = {each.place for each in unknown}
        self.signals = [
            signal
            for signal in subject.evidence.values()
            if noise_is_stated(signal.noise_std) and _moves(signal, places)
        ]
        self.centre = np.array([each.centre for each in unknown])
        self.sigma = np.array([each.sigma for each in unknown])
        self.out = [self._expected(signal) | gross.get(signal.name, False) for signal in self.signals]

    def _expected(self, signal: Signal) -> NDArray[np.bool_]:
        """Rows that an effect `outliers` of the model explains."""
        return self.subject.outliers(signal, self.subject.residual(signal, self.start, hold=True))

    def __call__(self, values: Floats) -> Floats:
        placement = placed(self.start, self.unknown, values)
        parts = [(values - self.centre) / self.sigma]
        for signal, out in zip(self.signals, self.out, strict=True):
            # held beyond its end: no row may escape from (1) by leaving the run
            residual = self.subject.residual(signal, placement, hold=True) / self.subject.noise(signal)
            parts.append(np.where(out[:, None], 0.0, residual).ravel())
        found: Floats = np.nan_to_num(np.concatenate(parts))
        return found

    def aligned_places(self, jacobian: Floats) -> tuple[AlignedPlace, ...]:
        """How many values were aligned to how many readings, by place; the first rows are priors."""
        of_readings = jacobian[len(self.sigma) :] * _sizes(self.unknown)
        square = of_readings.T @ of_readings
        prior = np.diag((_sizes(self.unknown) / self.sigma) ** 2)
        share = np.diag(np.linalg.pinv(square + prior, rcond=FIRM, hermitian=True) @ square)
        found = []
        for place in dict.fromkeys(each.place for each in self.unknown):
            values = float(sum(share[k] for k, each in enumerate(self.unknown) if each.place == place))
            of = [(s, out) for s, out in zip(self.signals, self.out, strict=True) if _moves(s, {place})]
            readings = sum(self._readings(signal, out) for signal, out in of)
            found.append(AlignedPlace(place, values, readings, tuple(signal.name for signal, _ in of)))
        return tuple(found)

    def _readings(self, signal: Signal, out: NDArray[np.bool_]) -> int:
        """Number of values that count."""
        residual = self.subject.residual(signal, self.start, hold=True)
        return int(np.isfinite(residual[~out]).sum())


def _jacobian(rows: _Rows, values: Floats, unknown: list[Unknown]) -> Floats:
    """Central differences of the rows by the unknowns."""
    columns = []
    for i, each in enumerate(unknown):
        step = np.zeros(len(unknown))
        step[i] = each.step
        columns.append((rows(values + step) - rows(values - step)) / (2 * each.step))
    found: Floats = np.stack(columns, axis=1)
    return found


def _least_norm(jacobian: Floats, right: Floats, unknown: list[Unknown]) -> tuple[Floats, Floats]:
    """Return the least-squares step and standard deviations; what the data leave open keeps its prior's."""
    scale = _sizes(unknown)
    scaled = jacobian * scale
    squares, axes = np.linalg.eigh(scaled.T @ scaled)
    firm = squares > FIRM * squares[-1]
    step = axes[:, firm] @ ((axes[:, firm].T @ (scaled.T @ right)) / squares[firm])
    variance = np.sum(axes[:, firm] ** 2 / squares[firm], axis=1)
    loose = np.sum(axes[:, ~firm] ** 2, axis=1) > 1e-3
    prior = np.array([each.sigma for each in unknown])
    return step * scale, np.where(loose, prior, np.sqrt(variance) * scale)


def _sizes(unknown: list[Unknown]) -> Floats:
    """What unknowns are measured in: sigmas of their priors, or so many steps where there is none."""
    return np.array([each.sigma if np.isfinite(each.sigma) else 100 * each.step for each in unknown])


def _descend(rows: _Rows, values: Floats, residual: Floats, change: Floats) -> tuple[Floats, Floats, Floats]:
    """A step along `change`, halved until (1) falls; none if it never does."""
    cost = residual @ residual
    for _ in range(12):
        there = rows(values + change)
        if there @ there <= cost:
            return values + change, there, change
        change = change / 2
    return values, residual, np.zeros_like(change)
