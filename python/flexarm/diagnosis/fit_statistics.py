r"""Statistics of the chosen fit: goodness of fit, correlations, coverage, and parameter homogeneity.

For a channel of n rows with residuals r over their stated noise,

.. math:: \chi^2/n = \frac{1}{n} \sum_i r_i^2, \quad \rho_1 = \sum_i r_i r_{i+1} / \sum_i r_i^2          (1)

White noise of the stated size has 1 and 0, within sqrt(2/n) and 1/sqrt(n). Correlations of parameters are
those of the inverse Hessian of `diagnosis.uncertainty`.

**Parameter homogeneity** is a test of equal values in all records (Cochran's Q). Each record alone determines
the fitted parameters, to first order about the fit of all,

.. math:: p_r = p - (J_r^T J_r + \Lambda)^{-1} (J_r^T r_r + \Lambda (p - c))                           (2)

with the priors c, Lambda of clocks, frames and nominal values. If they estimate one number with variances
s_r^2, Cochran's Q = sum (p_r - mean)^2/s_r^2 is chi-squared with one degree of freedom less than there are
records [Cochran1954]. Residuals and derivatives are whitened by noise and discrepancy
(`diagnosis.discrepancy`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import effect_class
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.diagnosis.candidates import places_of
from flexarm.diagnosis.discrepancy import TimeDiscrepancy
from flexarm.diagnosis.evidence import evidence_of, whitened
from flexarm.diagnosis.fit import Fit, NormalEquations, joint_jacobian
from flexarm.diagnosis.hold_out import rms_rate
from flexarm.diagnosis.problem import Problem
from flexarm.fit_statistics import ChannelStatistics, Correlation, FitStatistics, Motion, PlausibleRange
from flexarm.quantities import channel_names
from flexarm.wording import place_words

STRONGEST = 12
"""Most correlations that are listed."""


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
        signal = problem.records[each.record].signals[each.signal]
        vector = signal.quantity == "orientation"  # of small turns about x, y, z
        axis = ("xyz" if vector else channel_names(signal.quantity, signal.axes))[each.channel]
        yield ChannelStatistics(
            each.record, each.signal, each.channel, n, square / n, autocorrelation, size**0.5, length, axis
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
    kinds = [kind for kind in kinds if not kind.stated_only]
    kinds = [kind for kind in kinds if arm.closures or not kind.pins_of_loops_only]
    return tuple(
        kind.name
        for kind in kinds
        if (poses and kind.only_in_motion()) or not list(places_of(kind, problem, arm))
    )


def constancy(fit: Fit, problem: Problem) -> list[dict[str, Any]]:
    """Each effect's parameters by record; keys as `Diagnosis.constancy` says. Empty for one record."""
    names = list(problem.records)
    if len(names) < 2 or not len(fit.z):
        return []
    from scipy.special import chdtrc  # chi2.sf is this; all of scipy.stats takes half a second to import

    alone = {name: _alone(fit, problem, name) for name in names}
    found = []
    for j, parameter in enumerate(fit.parameters):
        prior = parameter.prior
        if prior.scale == "uniform":
            continue
        steps = {name: (moved[j], std[j]) for name, (moved, std) in alone.items()}
        known = {name: pair for name, pair in steps.items() if pair[1] < 1.0 and abs(pair[0]) < 20.0}
        if len(known) < 2:
            continue
        weights = np.array([1 / std**2 for _, std in known.values()])
        moved = np.array([each for each, _ in known.values()])
        mean = float(weights @ moved / weights.sum())
        q = float(weights @ (moved - mean) ** 2)
        z = float(fit.z[j])
        values = {
            name: (parameter.value(z + a), abs(parameter.slope(z + a)) * s) for name, (a, s) in known.items()
        }
        spread = max(v for v, _ in values.values()) - min(v for v, _ in values.values())
        p = float(chdtrc(len(known) - 1, q))
        size = abs(parameter.value(z))
        member = fit.members[parameter.candidate]
        constant = p > problem.policy.chance or spread < problem.policy.alike * size
        found.append(
            {
                "effect": member.name,
                "at": member.at,
                "parameter": parameter.name,
                "unit": prior.unit,
                "values": values,
                "q": q,
                "p_value": p,
                "constant": constant,
                "moves_with": "" if constant else moves_with(problem, values),
            }
        )
    return found


def _alone(fit: Fit, problem: Problem, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the steps and standard deviations of the parameters from one record, eq. (2)."""
    jacobian, residual, prior = joint_jacobian(fit)
    best = np.concatenate([np.zeros(len(fit.z)), fit.projection.solve(fit.residual)])
    discrepancies = evidence_of(fit, problem).discrepancies
    white = whitened(np.column_stack([jacobian, residual]), problem, discrepancies)
    own = np.concatenate([np.arange(w.start, w.stop) for e, w in problem.channels() if e.record == name])
    jacobian, residual = white[own, :-1], white[own, -1]
    prior = prior.copy()
    prior[: len(fit.z)] = 1e-4  # weak: the record alone determines effects
    inverse = NormalEquations.of(jacobian, prior).inverse()
    gradient = jacobian.T @ residual + prior * best
    return -inverse @ gradient, np.sqrt(np.diag(inverse))


def moves_with(problem: Problem, values: Mapping[str, tuple[float, float]]) -> str:
    """Return what differs between the records among which a parameter moves."""
    records = [problem.records[name] for name in values]
    loads = {tuple((k, v.mass) for k, v in record.payloads.items()) for record in records}
    if len(loads) > 1:
        return "payload"
    if len({tuple((k, v.length) for k, v in record.links.items()) for record in records}) > 1:
        return "length"
    rates, middles = [], []
    for record in records:
        signals = [record.signals[name] for name in record.drive if record.signals[name].pose is None]
        if signals:
            angle = [s.values[np.isfinite(s.values[:, 0]), 0] for s in signals]
            rates.append(max(float(np.ptp(a)) / max(len(a), 1) for a in angle))
            middles.append([float(a.mean()) for a in angle])
    if rates and max(rates) > 1.3 * min(rates):
        return "speed"
    return "pose" if middles and np.ptp(np.array(middles), axis=0).max() > 0.1 else "record"
