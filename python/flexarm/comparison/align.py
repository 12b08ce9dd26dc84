"""Alignment of clocks and frames of a record with its simulation.

    sum over signals |(y - prediction(u))/sigma_y|^2 + sum_i ((u_i - c_i)/sigma_i)^2 -> min            (1)

u are the alignment parameters with priors (c_i, sigma_i), y the measured values with noise sigma_y. Effects
of the model on clocks and frames come on top of u. The simulation is not repeated: predictions are read from
it at shifted stamps. (1) is solved by Gauss-Newton steps, halved until (1) falls. Gross outliers
(`flexarm.measurement.outliers`, `pose_outliers`) are left out, those of `SMOOTH` quantities also from the
gap. A parameter that the data do not determine keeps its prior and is reported: its standard deviation is
then more than `KEPT` of the prior's, or infinite without a prior.

A gap much larger than the noise outweighs the priors. Any part of it that looks like a shift in time or space
is then aligned away. `compare(..., align=False)` shows the gap without that.

Whitened readings with the Jacobian J with respect to the alignment parameters, and their priors, determine
the parameter i by the share

    R_ii,   R = (J^T J + diag(1/sigma^2))^-1 J^T J                                                     (2)

which is 0 where its prior holds it and 1 where the readings do [MacKay1992]. With p the sum of (2) over the
parameters of one clock or frame, N readings that are noise leave sqrt(1 - p/N) of themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import (
    AlignmentParameter,
    alignment_parameters,
    has_noise,
    move_placement,
)
from flexarm.comparison.pose_outliers import pose_outliers
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.outliers import SMOOTH, outliers
from flexarm.record import Signal

KEPT = 0.9
"""Share of a prior's sigma that is left where the data say nothing."""
FIRM = 1e-12
"""Share of the greatest square below which the rows determine nothing."""


@dataclass(frozen=True)
class EffectiveParameters:
    """Hold the effective parameters of a clock or frame."""

    name: str
    """Of the clock or frame."""
    count: float
    """p of (2)."""
    readings: int
    """Values of its signals that counted."""
    signals: tuple[str, ...]

    @property
    def overfitted(self) -> bool:
        """Return True if so few readings were aligned that their residual says little of a model."""
        rounding = 1e-6  # of p
        # Readings for each aligned value below which that is said: a fifth of the noise is then aligned
        # away.
        few = 3.0
        return self.readings < few * self.count * (1 - rounding)

    def __str__(self) -> str:
        left = max(0.0, 1.0 - self.count / self.readings) ** 0.5 if self.readings else 0.0
        values = f"{self.count:.2g} value{'s' * (self.count > 1)}"
        return (
            f"{self.readings} readings of {', '.join(self.signals)} are few for the {values} of {self.name} "
            f"that were aligned to them: of noise {100 * left:.0f} % would be left, and a gap may be "
            "aligned away"
        )


@dataclass(frozen=True)
class Alignment:
    """Hold the result of an alignment."""

    placement: Placement
    """Clocks and frames after it."""
    parameters: tuple[AlignmentParameter, ...] = ()
    """Parameters that were estimated."""
    values: Floats | tuple[float, ...] = ()
    std: Floats | tuple[float, ...] = ()
    """Estimates and 1 sigma [s, m, rad], from noise and priors without errors of the model."""
    outliers: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)
    """Gross outliers by signal, of signals that have some, shape (n,)."""
    effective_parameters: tuple[EffectiveParameters, ...] = ()
    """Of each clock and frame."""

    @property
    def beyond_prior(self) -> list[str]:
        """Return parameters that moved beyond `far` sigma of their priors."""
        far = 5.0  # number of sigmas beyond which an alignment contradicts what the record states
        pairs = zip(self.parameters, self.values, strict=True)
        moves = [(u, abs(value - u.centre) / u.sigma) for u, value in pairs if np.isfinite(u.sigma)]
        return [f"{u} ({move:.0f} sigma)" for u, move in moves if move > far]

    @property
    def undetermined(self) -> list[str]:
        """Return parameters that the data do not determine, and that stay within their sigma."""
        return [
            str(u)
            for u, value, std in zip(self.parameters, self.values, self.std, strict=True)
            if is_left(value - u.centre, std, u.sigma)
        ]

    @property
    def overfitted(self) -> list[str]:
        """Report clocks and frames that were aligned to few readings."""
        return [str(place) for place in self.effective_parameters if place.overfitted]


def is_left(moved: float, std: float, sigma: float) -> bool:
    """Return True if a parameter with a prior of `sigma` is left where it was, for no data tell it."""
    return not std < (KEPT * sigma if np.isfinite(sigma) else np.inf) and abs(moved) <= sigma


def align(simulated: SimulatedRecord, start: Placement) -> Alignment:
    """Return clocks and frames that minimise (1), from a guess close for those without a prior."""
    iterations = 30
    parameters = alignment_parameters(simulated, start)
    places = {each.place for each in parameters}
    out = _gross_outliers(simulated, start, places)
    if not parameters:
        return Alignment(start, outliers=out)
    rows = _WeightedResiduals(simulated, start, parameters, out)
    values = np.array([each.centre for each in parameters])
    residual = rows(values)
    jacobian = _jacobian(rows, values, parameters, len(residual))
    for _ in range(iterations):
        change = _least_squares(jacobian, -residual, parameters)[0]
        values, residual, moved = _line_search(rows, values, residual, change)
        scaled = np.abs(moved) / [each.step for each in parameters]
        if scaled.max() < 1e-3:
            break
        jacobian = _jacobian(rows, values, parameters, len(residual))
    std = _least_squares(jacobian, residual, parameters)[1]
    found = move_placement(start, parameters, values)
    return Alignment(found, tuple(parameters), values, std, out, rows.effective_parameters(jacobian))


def _gross_outliers(
    simulated: SimulatedRecord, start: Placement, places: set[str]
) -> dict[str, NDArray[np.bool_]]:
    """Return gross outliers of signals that are aligned or cannot jump."""
    wanted = {
        name: signal
        for name, signal in simulated.evidence.items()
        if signal.quantity in SMOOTH or _depends_on(signal, places)
    }
    if simulated.record.kind == "static":
        far = pose_outliers(simulated, start)
        return {name: far[name].rows for name in wanted if name in far}
    found = {
        name: outliers(simulated.residual(signal, start, hold=True), simulated.noise(signal))
        for name, signal in wanted.items()
        if has_noise(signal.noise_std)
    }
    return {name: rows for name, rows in found.items() if rows.any()}


def _depends_on(signal: Signal, places: set[str]) -> bool:
    """Return True if the clock or frame of a signal is among those aligned."""
    return signal.clock in places or signal.frame in places


class _WeightedResiduals:
    """Compute whitened priors and residuals of (1) as one vector, zero for outliers and missing values."""

    def __init__(
        self,
        simulated: SimulatedRecord,
        start: Placement,
        parameters: list[AlignmentParameter],
        gross: Mapping[str, NDArray[np.bool_]],
    ) -> None:
        self.simulated = simulated
        self.start, self.parameters = start, parameters
        places = {each.place for each in parameters}
        self.signals = [
            signal
            for signal in simulated.evidence.values()
            if has_noise(signal.noise_std) and _depends_on(signal, places)
        ]
        self.centre = np.array([each.centre for each in parameters])
        self.sigma = np.array([each.sigma for each in parameters])
        self.out = [
            simulated.outliers(signal, self._at_start(signal)) | gross.get(signal.name, False)
            for signal in self.signals
        ]

    def _at_start(self, signal: Signal) -> Floats:
        """Return the residual of a signal at the initial guess."""
        return self.simulated.residual(signal, self.start, hold=True)

    def __call__(self, values: Floats) -> Floats:
        placement = move_placement(self.start, self.parameters, values)
        parts = [(values - self.centre) / self.sigma]
        for signal, out in zip(self.signals, self.out, strict=True):
            # held beyond its end: no row may escape from (1) by leaving the run
            residual = self.simulated.residual(signal, placement, hold=True)
            residual /= self.simulated.noise(signal)
            residual[out] = 0.0
            parts.append(residual.ravel())
        found: Floats = np.concatenate(parts)
        found[np.isnan(found)] = 0.0
        return found

    def effective_parameters(self, jacobian: Floats) -> tuple[EffectiveParameters, ...]:
        """Return the effective parameters of each clock and frame; the first rows are priors."""
        of_readings, scale = jacobian[len(self.sigma) :], _scales(self.parameters)
        square = (of_readings.T @ of_readings) * np.outer(scale, scale)
        prior = np.diag((scale / self.sigma) ** 2)
        share = np.diag(np.linalg.pinv(square + prior, rcond=FIRM, hermitian=True) @ square)
        found = []
        for place in dict.fromkeys(each.place for each in self.parameters):
            values = float(sum(share[k] for k, each in enumerate(self.parameters) if each.place == place))
            of = [(s, out) for s, out in zip(self.signals, self.out, strict=True) if _depends_on(s, {place})]
            readings = sum(int(np.isfinite(self._at_start(s)[~out]).sum()) for s, out in of)
            found.append(EffectiveParameters(place, values, readings, tuple(signal.name for signal, _ in of)))
        return tuple(found)


def _jacobian(
    rows: _WeightedResiduals, values: Floats, parameters: list[AlignmentParameter], count: int
) -> Floats:
    """Return central differences of `count` residuals with respect to the parameters, column by column."""
    found = np.empty((len(parameters), count))
    for i, each in enumerate(parameters):
        step = np.zeros(len(parameters))
        step[i] = each.step
        np.subtract(rows(values + step), rows(values - step), out=found[i])
        found[i] /= 2 * each.step
    return found.T


def _least_squares(
    jacobian: Floats, right: Floats, parameters: list[AlignmentParameter]
) -> tuple[Floats, Floats]:
    """Return the least-squares step and standard deviations; undetermined parameters keep their priors'."""
    scale = _scales(parameters)
    squares, axes = np.linalg.eigh((jacobian.T @ jacobian) * np.outer(scale, scale))
    firm = squares > FIRM * squares[-1]
    step = axes[:, firm] @ ((axes[:, firm].T @ (scale * (jacobian.T @ right))) / squares[firm])
    variance = np.sum(axes[:, firm] ** 2 / squares[firm], axis=1)
    loose = np.sum(axes[:, ~firm] ** 2, axis=1) > 1e-3
    prior = np.array([each.sigma for each in parameters])
    return step * scale, np.where(loose, prior, np.sqrt(variance) * scale)


def _scales(parameters: list[AlignmentParameter]) -> Floats:
    """Return scales of the parameters: sigmas of their priors, or 100 steps without a prior."""
    return np.array([each.sigma if np.isfinite(each.sigma) else 100 * each.step for each in parameters])


def _line_search(
    rows: _WeightedResiduals, values: Floats, residual: Floats, change: Floats
) -> tuple[Floats, Floats, Floats]:
    """Take a step along `change`, halved until (1) falls; none if it never does."""
    cost = residual @ residual
    for _ in range(12):
        there = rows(values + change)
        if there @ there <= cost:
            return values + change, there, change
        change = change / 2
    return values, residual, np.zeros_like(change)
