r"""Values and intervals of everything that was fitted.

A fit of parameters p, those of effects and nuisance parameters together, weighs rows by the stated noise.
What it leaves has the covariance C of noise and discrepancy (`diagnosis.discrepancy`), so that p errs by

.. math:: V = H^{-1} (J^T C J + \Lambda) H^{-1}, \quad H = J^T J + \Lambda                              (1)

[White1980]. J are the derivatives of residuals over their noise, Lambda the weights of the priors.

Noise of encoders that drive the model is another error: smoothing leaves its slow part, which modes amplify.
With errors e_k of the residual for draws of that noise (`diagnosis.noise_model`, eq. (1)), V gains

.. math:: \frac{1}{K} \sum_k (H^{-1} J^T e_k)(H^{-1} J^T e_k)^T                                       (2)

No simulation is exact, and a fit hides from its own residual what the simulation errs in the direction of its
parameters. An error moves like what it is an error of, but out of phase with it: a surrogate [Theiler1992] of
the parameter's own column of J has the same spectrum with random phases, here as large as
`simulation_errors` of the noise where it is largest. With a = J H^-1 u_p, by which a parameter depends on
residuals, and transforms A and S of a and of that surrogate in a channel of n samples, it adds the variance

.. math:: \sum_\text{channels} \frac{1}{n^2} \sum_f |A_f|^2 |S_f|^2                                   (3)

Intervals are those of a normal distribution of p, mapped to the parameters' own scales.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.evidence import evidence_of, simulation_errors
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.generalised_least_squares import NormalEquations, joint_jacobian
from flexarm.diagnosis.problem import Problem
from flexarm.named_effects import NORMAL_90, Estimate, Nuisance, Refined


@dataclass(frozen=True, eq=False)
class Estimates:
    """Fitted values with their uncertainty.

    Attributes
    ----------
    effects : list of tuple of Estimate
        For each effect of the fit.
    nuisances : tuple of Nuisance
        Clocks and frames.
    refined : tuple of Refined
        Nominal values.
    """

    effects: list[tuple[Estimate, ...]]
    nuisances: tuple[Nuisance, ...]
    refined: tuple[Refined, ...]


def estimates(fit: Fit, problem: Problem, input_errors: Floats | None = None) -> Estimates:
    """Return values and intervals of a fit, by (1) to (3); input_errors: e of (2), shape (draws, n)."""
    return estimates_at(fit, deviations(fit, problem, input_errors=input_errors))


def estimates_at(fit: Fit, sigma: Floats) -> Estimates:
    """Return values of a fit, and intervals for standard deviations of z and x, shape (k + m,)."""
    k = len(fit.z)
    return Estimates(
        [_of_effect(fit, i, sigma[:k]) for i in range(len(fit.members))], *_of_unknowns(fit, sigma[k:])
    )


def deviations(
    fit: Fit, problem: Problem, errors: Floats | float | None = None, input_errors: Floats | None = None
) -> Floats:
    """Return standard deviations of z and x, shape (k + m,); `errors` of the simulation replace
    `simulation_errors`; `input_errors` are e of (2), shape (draws, n).
    """
    jacobian, _, prior = joint_jacobian(fit)
    inverse = NormalEquations.of(jacobian, prior).inverse()
    scatter = jacobian.T @ evidence_of(fit, problem).covariance_times(jacobian, problem) + np.diag(prior)
    variance = np.einsum("ij,jk,ki->i", inverse, scatter, inverse)  # eq. (1)
    if input_errors is not None and len(input_errors):
        variance += np.mean((input_errors @ jacobian @ inverse) ** 2, axis=0)  # eq. (2)
    errors = simulation_errors(problem, fit.non_smooth) if errors is None else errors
    size = np.broadcast_to(errors, len(problem))
    found: Floats = np.sqrt(variance + surrogates(problem, jacobian, inverse, size) ** 2)
    return found


def surrogates(problem: Problem, jacobian: Floats, inverse: Floats, size: Floats) -> Floats:
    """Root of (3) for errors of a size over the noise in each row, shape (k + m,); inverse: H^-1."""
    channels = [where for _, where in problem.channels()]
    largest = np.max([np.mean(jacobian[where] ** 2, axis=0) for where in channels], axis=0)
    shapes = size[:, None] * jacobian / np.sqrt(np.maximum(largest, 1e-300))
    depends = jacobian @ inverse
    variance = np.zeros(jacobian.shape[1])
    for where in channels:
        a, s = (np.abs(np.fft.fft(x[where], axis=0)) for x in (depends, shapes))
        variance += np.sum((a * s) ** 2, axis=0) / len(a) ** 2  # eq. (3)
    return np.sqrt(variance)


def _of_effect(fit: Fit, i: int, sigma: Floats) -> tuple[Estimate, ...]:
    member = fit.members[i]
    places = {c.name: j for j, c in enumerate(fit.parameters) if c.candidate == i}
    found = []
    for name, value, unit in member.parameters_in(fit.nuisance.arm):
        if name not in places:
            continue
        j = places[name]
        parameter, z = fit.parameters[j], float(fit.z[j])
        reach = max(parameter.bound, abs(z))
        ends = (float(np.clip(z + side * NORMAL_90 * sigma[j], -reach, reach)) for side in (-1, 1))
        low, high = sorted(parameter.value(end) for end in ends)
        own = parameter.prior.unit if unit == "SI" else unit  # that of the signal
        turns = whole_turns(value) if name == "phase" else 0.0
        std = (high - low) / (2 * NORMAL_90)
        found.append(
            Estimate(name, value - turns, std, min(low, value) - turns, max(high, value) - turns, own)
        )
    return tuple(found)


def whole_turns(phase: float) -> float:
    """Return what a phase is beyond half a turn either way [rad], in whole turns."""
    return 2 * pi * round(phase / (2 * pi))


def _of_unknowns(fit: Fit, sigma: Floats) -> tuple[tuple[Nuisance, ...], tuple[Refined, ...]]:
    best = fit.projection.solve(fit.residual)
    nuisances: dict[tuple[str, str], list[Estimate]] = {}
    refined = []
    for unknown, x, std in zip(fit.nuisance.parameters, best.tolist(), sigma.tolist(), strict=True):
        if unknown.kind == "start":
            continue
        value = unknown.centre + (x if unknown.kind == "base" else unknown.kept(x))
        if unknown.kind == "nominal":
            refined.append(Refined(unknown.key, value, std, unknown.centre, unknown.unit))
            continue
        name = f"angle.{unknown.key[-1]}" if unknown.kind == "base" else unknown.key.split(".", 3)[3]
        nuisances.setdefault(unknown.place, []).append(Estimate.normal(name, value, std, unknown.unit))
    return tuple(Nuisance(*place, tuple(each)) for place, each in nuisances.items()), tuple(refined)
