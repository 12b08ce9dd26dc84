"""The most probable values of all parameters: several starts, and restarts from lower points of a valley.

A family is fitted with one shared size first, from the best of a grid. All parameters follow, first as if the
model's discrepancy were white: at a false optimum a lasting one could stand for the gap. Where the profile of
the posterior (`calibration.valley`) has a lower point, the optimum was a false one, and the estimate goes on
from there. Where it leaves a gap, the best draws from the prior are other starts.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.calibration.estimation import REST, Estimation, Posterior, Tell, estimate
from flexarm.calibration.valley import valley_of
from flexarm.diagnosis.fit import FIT_ERRORS, Projection
from flexarm.diagnosis.noise_model import SEED


def posterior_of(estimation: Estimation, tell: Tell) -> Posterior:
    """Return the posterior about the most probable values.

    Raise NotConverged or InvalidParameter if the first start cannot be simulated.
    """
    u, policy = estimation.centre, estimation.policy
    white = replace(estimation, white=True, policy=replace(policy, tolerance=policy.tolerance_first))
    if any(family.hierarchy.has_mean for family in estimation.families):
        u = multi_start(estimation, u, tell)
        brief = replace(white, policy=replace(white.policy, iterations=policy.iterations_first))
        basis = estimation.shared_columns()
        u = estimate(brief, u, lambda what: tell(f"shared sizes, {what}"), basis).point.u
    u = estimate(white, u, lambda what: tell(f"white discrepancy, {what}")).point.u
    found = _refined(estimation, u, tell)
    for k, start in enumerate(_other_starts(found), 2):
        if not found.leaves_gap or not allows(REST):
            break
        with suppress(*FIT_ERRORS):
            tell(f"start {k}")
            u = estimate(white, start, tell).point.u
            if found.objective(u) < found.objective(found.point.u) - found.negligible:
                found = _refined(estimation, u, tell)
    return found


def _refined(estimation: Estimation, u: Floats, tell: Tell) -> Posterior:
    """Return the posterior at an optimum from which no valley leads further down."""
    for _ in range(estimation.policy.restarts):
        found = estimate(estimation, u, tell)
        if not allows(REST):
            break
        found = replace(found, valley=valley_of(found))
        lower = None if found.valley is None else found.valley.lower(found.negligible)
        if lower is None:
            break
        tell("the valley has a lower point")
        u = lower
    return found


def _other_starts(found: Posterior) -> Iterator[Floats]:
    """Yield draws from the prior of parameters of the model, of some those that fit best."""
    estimation = found.estimation
    policy = estimation.policy
    own = [k for k, each in enumerate(estimation.parameters) if each.kind in ("family", "nominal")]
    rng = np.random.default_rng(SEED)
    drawn = rng.multivariate_normal(estimation.centre, np.linalg.inv(estimation.precision()), policy.draws)
    tried = []
    for each in drawn:
        u = found.point.u.copy()
        u[own] = each[own]
        with suppress(*FIT_ERRORS):
            tried.append((found.objective(u), u))
    for _, u in sorted(tried, key=lambda each: each[0])[: policy.starts]:
        yield u


def multi_start(estimation: Estimation, u: Floats, tell: Tell) -> Floats:
    """Return u with the shared size of each family in turn at the best of a grid.

    All else is fitted along to first order.
    """
    policy = estimation.policy
    for family in (family for family in estimation.families if family.hierarchy.has_mean):
        tell(f"sizes of {family.effect}")
        columns = estimation.columns(family)
        others = [k for k in range(len(u)) if k not in columns]
        jacobian = estimation.linearised(u).jacobian
        sigma = np.array([estimation.parameters[k].sigma for k in others])
        projection = Projection(jacobian[:, others], sigma)
        prior = family.hierarchy.prior
        low, high = prior.low / policy.range_factor, prior.high * policy.range_factor
        tried = [(np.inf, u)]
        for size in np.log(np.geomspace(low, high, policy.sizes)):
            start = u.copy()
            start[columns] = size
            with suppress(*FIT_ERRORS):
                rest = projection.project(estimation.residual(start, jacobian))
                tried.append((float(rest @ rest), start))
        u = min(tried, key=lambda each: each[0])[1]
    return u
