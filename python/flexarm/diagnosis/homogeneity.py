r"""Parameter homogeneity: a test of equal values in all records (Cochran's Q).

Each record alone determines the fitted parameters, to first order about the fit of all,

.. math:: p_r = p - (J_r^T J_r + \Lambda)^{-1} (J_r^T r_r + \Lambda (p - c))                           (1)

with the priors c, Lambda of clocks, frames and nominal values. If they estimate one number with variances
s_r^2, Cochran's Q = sum (p_r - mean)^2/s_r^2 is chi-squared with one degree of freedom less than there are
records [Cochran1954]. Residuals and derivatives are whitened by noise and
discrepancy (`diagnosis.discrepancy`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexarm.diagnosis.evidence import evidence_of
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.generalised_least_squares import NormalEquations, joint_jacobian
from flexarm.diagnosis.problem import Problem


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
    """Return the steps and standard deviations of the parameters from one record, eq. (1)."""
    jacobian, residual, prior = joint_jacobian(fit)
    best = np.concatenate([np.zeros(len(fit.z)), fit.projection.solve(fit.residual)])
    evidence = evidence_of(fit, problem)
    white = evidence.whitened(np.column_stack([jacobian, residual]), problem)
    own = np.concatenate([np.arange(w.start, w.stop) for e, w in problem.channels() if e.record == name])
    jacobian, residual = white[own, :-1], white[own, -1]
    prior = prior.copy()
    prior[: len(fit.z)] = 1e-4  # the record alone shall say it
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
