r"""Statistics of the chosen fit: how well it fits, what is correlated, and what the records cover.

For a channel of n rows with residuals r over their stated noise,

.. math:: \chi^2/n = \frac{1}{n} \sum_i r_i^2, \quad \rho_1 = \sum_i r_i r_{i+1} / \sum_i r_i^2          (1)

White noise of the stated size has 1 and 0, within sqrt(2/n) and 1/sqrt(n). Correlations of
parameters are those of the inverse Hessian of `diagnosis.uncertainty`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import effect_class
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.diagnosis.candidate_places import places_of
from flexarm.diagnosis.discrepancy import TimeDiscrepancy
from flexarm.diagnosis.evidence import evidence_of
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.generalised_least_squares import NormalEquations, joint_jacobian
from flexarm.diagnosis.hold_out import rms_rate
from flexarm.diagnosis.problem import Problem
from flexarm.fit_statistics import ChannelStatistics, Correlation, FitStatistics, Motion, PlausibleRange
from flexarm.wording import place_words

STRONGEST = 12
"""Correlations that are told."""


def fit_statistics(fit: Fit, problem: Problem) -> FitStatistics:
    """Return the statistics of a fit to the records of a problem."""
    return FitStatistics(
        tuple(_channels(fit, problem)),
        _correlations(fit),
        tuple(_motions(problem)),
        tuple(_priors(fit)),
        unseen_effects(problem, fit.nuisance.arm),
    )


def _channels(fit: Fit, problem: Problem) -> Iterator[ChannelStatistics]:
    evidence = evidence_of(fit, problem)
    for (each, where), process in zip(problem.channels(), evidence.discrepancies, strict=True):
        left = evidence.left[where]
        square, n = float(left @ left), len(left)
        autocorrelation, length = None, None
        if isinstance(process, TimeDiscrepancy):
            autocorrelation = float(left[1:] @ left[:-1]) / square if square > 0 else 0.0
            interval = float(np.median(np.diff(each.time))) if n > 1 else 0.0
            length = process.length * interval if process.size > 0 else None
            size = process.size
        else:
            size = float(np.mean(process.variances) - np.min(process.variances))
        yield ChannelStatistics(
            each.record, each.signal, each.channel, n, square / n, autocorrelation, size**0.5, length
        )


def _priors(fit: Fit) -> Iterator[PlausibleRange]:
    for parameter in fit.parameters:
        name, at = fit.members[parameter.candidate].place
        prior = parameter.prior
        yield PlausibleRange(
            name,
            at,
            parameter.name,
            prior.low,
            prior.typical,
            prior.high,
            prior.unit,
            prior.scale == "uniform",
            prior.source,
        )


def _correlations(fit: Fit) -> tuple[Correlation, ...]:
    jacobian, _, prior = joint_jacobian(fit)
    names = [
        *(f"{p.name} of {place_words(*fit.members[p.candidate].place)}" for p in fit.parameters),
        *(unknown.words for unknown in fit.nuisance.parameters),
    ]
    if not names:
        return ()
    covariance = NormalEquations.of(jacobian, prior).inverse()
    std = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    matrix = covariance / np.outer(std, std)
    rows, columns = np.triu_indices(len(names), 1)
    pairs = [
        Correlation((names[i], names[j]), float(matrix[i, j]))
        for i, j in zip(rows.tolist(), columns.tolist(), strict=True)
    ]
    return tuple(sorted(pairs, key=lambda each: -abs(each.value))[:STRONGEST])


def _motions(problem: Problem) -> Iterator[Motion]:
    for name, record in problem.records.items():
        for drive in record.drive:
            signal = record.signals[drive]
            values = signal.values[:, 0]
            known = np.isfinite(values)
            if signal.quantity not in ("joint_angle", "joint_command") or not known.any():
                continue
            rate = rms_rate(signal) if record.kind == "motion" else None
            lowest, highest = float(values[known].min()), float(values[known].max())
            yield Motion(name, signal.joint or drive, signal.unit, lowest, highest, rate)


def unseen_effects(problem: Problem, arm: Arm) -> tuple[str, ...]:
    """Return the effects of the vocabulary that have no place in these records and this model."""
    poses = all(record.kind == "static" for record in problem.records.values())
    kinds = [kind for kind in map(effect_class, KNOWN_EFFECTS) if kind.competes]
    return tuple(
        kind.name
        for kind in kinds
        if (poses and kind.only_in_motion()) or not list(places_of(kind, problem, arm))
    )
