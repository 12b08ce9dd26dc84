r"""Uncertainty and identifiability of fitted values.

A fit of parameters p, those of effects and nuisance parameters together, weights rows by the stated noise.
What it leaves has the covariance C of noise and discrepancy (`diagnosis.discrepancy`), so that p errs by

.. math:: V = H^{-1} (J^T C J + \Lambda) H^{-1}, \quad H = J^T J + \Lambda                              (1)

[White1980]. J are the derivatives of residuals over their noise, Lambda the weights of the priors. A
calibration weights its rows: there W J stands for J but for one of H (`calibration.estimation`).

Noise of encoders that drive the model is another error: smoothing leaves its slow part, which modes amplify.
With errors e_k of the residual for draws of that noise (`diagnosis.noise_model`, eq. (1)), V gains

.. math:: \frac{1}{K} \sum_k (H^{-1} J^T e_k)(H^{-1} J^T e_k)^T                                       (2)

No simulation is exact, and a fit hides from its own residual what the simulation errs in the direction of its
parameters. The error of a motion has its spectrum, but another phase: a surrogate [Theiler1992] of
the parameter's own column of J has the same spectrum with random phases, here as large as
`simulation_errors` of the noise where it is largest. With a = J H^-1 u_p, by which a parameter depends on
residuals, and transforms A and S of a and of that surrogate in a channel of n samples, it adds the variance

.. math:: \sum_\text{channels} \frac{1}{n^2} \sum_f |A_f|^2 |S_f|^2                                   (3)

Intervals are those of a normal distribution of p, mapped to the parameters' own scales. The logarithm of a
size that may be none has no lower end, and its curvature there tells nothing of the upper one. Residuals
depend on the size itself linearly. Where its normal distribution by data, without its own prior, holds none,
the upper end of that one holds.

**Refined values.** Nominal values move by

    moved = value - nominal,    pull = moved/sigma                                                   (4)

with the model's stated sigma. A value is determined by the data if they leave less than `KEPT` of its sigma.

**Practically unidentifiable values** move along with others. They go back to their nominal values, all
together, unless the gap on the training grows by it: of five lengths of which only the sum shows, each is
unidentifiable. So does the zero of a sensor that lies within its standard deviation of the nominal one.

**Estimates at bounds.** Bounds of a fit lie far beyond what is plausible (`diagnosis.candidate`). An estimate
at its bound is no size: the limit of the law fits best. Only a payload may vanish.

**Implausible sizes**, beyond `FAR` sigmas of a prior, are believed where they explain nearly all
(`diagnosis.acceptance`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.parameter import stated_sigma, with_value
from flexarm.arrays import Floats
from flexarm.comparison.align import is_left
from flexarm.diagnosis.candidate import TransformedParameter
from flexarm.diagnosis.evidence import evidence_of, simulation_errors
from flexarm.diagnosis.fit import Fit, NormalEquations, joint_jacobian
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.result import Refinement
from flexarm.diagnosis.sensor_zeros import is_zero
from flexarm.named_effects import NORMAL_90, Estimate, Nuisance, Refined
from flexarm.wording import listed, place_words, with_unit

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison


@dataclass(frozen=True, eq=False)
class Estimates:
    """Fitted values with their uncertainty."""

    effects: list[tuple[Estimate, ...]]
    """For each effect of the fit."""
    nuisances: tuple[Nuisance, ...]
    """Clocks and frames."""
    refined: tuple[Refined, ...]
    """Nominal values."""


def estimates(fit: Fit, problem: Problem, input_errors: Floats | None = None) -> Estimates:
    """Return values and intervals of a fit, by (1) to (3); input_errors: e of (2), shape (draws, n)."""
    sigma = deviations(fit, problem, input_errors=input_errors)
    return estimates_at(fit, sigma, data_deviations(fit, problem))


def estimates_at(fit: Fit, sigma: Floats, by_data: Floats | None = None) -> Estimates:
    """Return values of a fit, and intervals for standard deviations of z and x, shape (k + m,).

    `by_data` are those of z without their own priors, shape (k,).
    """
    k = len(fit.z)
    by_data = np.full(k, np.inf) if by_data is None else by_data
    effects = [_of_effect(fit, i, sigma[:k], by_data) for i in range(len(fit.members))]
    return Estimates(effects, *_of_unknowns(fit, sigma[k:]))


def data_deviations(fit: Fit, problem: Problem) -> Floats:
    """Return the standard deviations that data leave of each z without its own prior, shape (k,)."""
    jacobian, _, prior = joint_jacobian(fit)
    variance = np.diag(NormalEquations.of(jacobian, prior).inverse())
    scattered = evidence_of(fit, problem).covariance_times(jacobian, problem)
    wider = np.sum(jacobian * scattered, axis=0) / np.maximum(np.sum(jacobian**2, axis=0), 1e-300)
    told = np.maximum(1.0 - prior * variance, 1e-12)
    return np.asarray(np.sqrt(wider * variance / told)[: len(fit.z)])


def deviations(
    fit: Fit, problem: Problem, errors: Floats | float | None = None, input_errors: Floats | None = None
) -> Floats:
    """Return standard deviations of z and x, shape (k + m,); `errors` of the simulation replace
    `simulation_errors`; `input_errors` are e of (2), shape (draws, n).
    """
    jacobian, _, prior = joint_jacobian(fit)
    inverse = NormalEquations.of(jacobian, prior).inverse()
    scattered = evidence_of(fit, problem).covariance_times(jacobian, problem)
    variance = np.diag(robust_covariance(jacobian, scattered, np.diag(prior), inverse, input_errors))
    errors = simulation_errors(problem, fit.non_smooth) if errors is None else errors
    size = np.broadcast_to(errors, len(problem))
    return np.sqrt(variance + surrogates(problem, jacobian, jacobian @ inverse, size) ** 2)


def robust_covariance(
    weighted: Floats, scattered: Floats, prior: Floats, inverse: Floats, input_errors: Floats | None
) -> Floats:
    """Return V of (1) with (2) from W J, C W J, Lambda, H^-1 and e; W is one of a diagnosis."""
    scatter = weighted.T @ scattered + prior
    if input_errors is not None and len(input_errors):
        along = input_errors @ weighted
        scatter = scatter + along.T @ along / len(input_errors)  # eq. (2)
    return inverse @ scatter @ inverse  # eq. (1)


def surrogates(problem: Problem, jacobian: Floats, depends: Floats, size: Floats) -> Floats:
    """Root of (3) for errors of a size over the noise in each row, shape (k + m,); depends: W J H^-1."""
    channels = [where for _, where in problem.channels()]
    largest = np.max([np.mean(jacobian[where] ** 2, axis=0) for where in channels], axis=0)
    shapes = size[:, None] * jacobian / np.sqrt(np.maximum(largest, 1e-300))
    variance = np.zeros(jacobian.shape[1])
    for where in channels:
        a, s = (np.abs(np.fft.fft(x[where], axis=0)) for x in (depends, shapes))
        variance += np.sum((a * s) ** 2, axis=0) / len(a) ** 2  # eq. (3)
    return np.sqrt(variance)


def _of_effect(fit: Fit, i: int, sigma: Floats, by_data: Floats) -> tuple[Estimate, ...]:
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
        either_way = NORMAL_90 * abs(parameter.slope(z)) * float(by_data[j])
        if parameter.prior.scale == "log" and member.vanishes_with(name) and either_way > value:
            high = min(high, value + either_way)
        own = parameter.prior.unit if unit == "SI" else unit  # the unit of the signal
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
    left_open: set[tuple[str, str, str]] = set()
    refined = []
    for unknown, x, std in zip(fit.nuisance.parameters, best.tolist(), sigma.tolist(), strict=True):
        if unknown.kind == "start":
            continue
        value = unknown.centre + (x if unknown.kind == "base" else unknown.limited(x))
        if unknown.kind == "nominal":
            refined.append(Refined(unknown.key, value, std, unknown.centre, unknown.unit))
            continue
        name = f"angle.{unknown.key[-1]}" if unknown.kind == "base" else unknown.key.split(".", 3)[3]
        nuisances.setdefault(unknown.place, []).append(Estimate.normal(name, value, std, unknown.unit))
        if is_left(value - unknown.centre, std, unknown.sigma):
            left_open.add((*unknown.place, name))
    found = (
        Nuisance(*place, tuple(each), tuple(e.name for e in each if (*place, e.name) in left_open))
        for place, each in nuisances.items()
    )
    return tuple(found), tuple(refined)


GROWTH = 0.01
"""Growth of the rms gap of a signal, over the larger of gap and noise, that counts as none."""


def restore_unidentifiable(
    arm: Arm,
    updated: Arm,
    refined: tuple[Refined, ...],
    gaps: Callable[[Arm], Mapping[str, Comparison]],
) -> tuple[Arm, tuple[Refined, ...]]:
    """Return the updated model and its refined values, unidentifiable ones restored to nominal values.

    `gaps` returns the gap of a model by training record.
    """
    open_ones = []
    for each in refined:
        idle_zero = is_zero(each.parameter) and abs(each.value - each.nominal) < each.std
        if idle_zero or not Refinement(each, stated_sigma(arm, each.parameter)).determined:
            open_ones.append(each)
    if updated is arm or not open_ones:
        return updated, refined
    back = updated
    for each in open_ones:
        back = with_value(back, each.parameter, each.nominal)
    if _grows(gaps(updated), gaps(back)):
        return updated, refined
    return back, tuple(replace(each, value=each.nominal) if each in open_ones else each for each in refined)


def _grows(before: Mapping[str, Comparison], after: Mapping[str, Comparison]) -> bool:
    """Return True if any signal of any record is missed by more."""
    for name, comparison in before.items():
        for signal, gap in comparison.evidence.items():
            other = after[name].evidence.get(signal)
            old, new = gap.rms["total"], None if other is None else other.rms["total"]
            if old is not None and (new is None or new - old > GROWTH * max(old, gap.noise_rms or 0.0)):
                return True
    return False


NEAR = 0.98
"""Part of its bound at which a parameter rests there."""
FAR = 4.0
"""Sigmas of a logarithmic prior beyond which a size is one of some ten thousand."""


def sizes(fit: Fit) -> Iterator[tuple[int, TransformedParameter, float]]:
    """Return number, coordinate and z of what sizes each effect, unless it is an angle or a load that is
    none.
    """
    for k, (parameter, z) in enumerate(zip(fit.parameters, fit.z, strict=True)):
        member = fit.members[parameter.candidate]
        is_size = member.is_size(parameter.name) and parameter.prior.scale != "uniform"
        if is_size and not (z < 0 and member.effect.may_vanish):
            yield k, parameter, float(z)


def has_implausible_size(fit: Fit) -> bool:
    """Return True if the size of an effect is beyond `FAR` sigmas of a logarithmic prior."""
    return any(each.prior.scale == "log" and abs(z) > FAR for _, each, z in sizes(fit))


def sizes_at_bounds(fit: Fit) -> list[tuple[int, TransformedParameter, float]]:
    """Return those `sizes` that are where fits end."""
    return [each for each in sizes(fit) if abs(each[2]) > NEAR * each[1].bound]


def estimates_at_bounds(fit: Fit) -> list[str]:
    """Words on each effect of which the size is where fits end."""
    found = []
    for k, parameter, z in sizes_at_bounds(fit):
        effect, at, name = fit.key(k)
        prior = parameter.prior
        value, low, high = (
            with_unit(each, prior.unit) for each in (parameter.value(z), prior.low, prior.high)
        )
        found.append(
            f"{name} of {place_words(effect, at)} rests where fits end, at {value} (95 % of machines "
            f"have {low} to {high})"
        )
    return found


def bound_sentence(fit: Fit) -> str:
    """Return the same as a sentence of what remains; empty where no effect is at an end."""
    found = estimates_at_bounds(fit)
    return f"What fits best has a value that no machine has: {listed(found)}." if found else ""
