"""Refinement of fits: joint Gauss-Newton steps, Hooke-Jeeves search, multi-start, derivatives taken anew.

Clocks, frames and nominal values are eliminated to first order about the model that a fit starts from
(`diagnosis.fit`), and so is its discretisation error. About the model that it found both are better known.

**Joint steps.** A fit moves z through the full simulation and the nuisance parameters x to first order about
an earlier model. Where both act alike, as the stiffness of a link and its modulus do, repeated fits creep and
stop percents short. With r, J_z = dr/dz and J_x = dr/dx of one and the same model,

    min over dz of  C(r + J_z dz) + sum_i ln(1 + (z_i + dz_i)^2/9),                                    (1)

where C eliminates x with J_x. z is then fitted about the model at z + dz and x + dx, with J_x of that one.

**Hooke-Jeeves.** For non-smooth laws C of `diagnosis.fit` has ripples. Steps of some percent of a gap, a
torque or a width, along one parameter at a time and smaller where none descends, pass over them [Hooke1961].

**Multi-start.** Along the gap of a backlash each ripple is a minimum. Gaps of a geometric series about the
fitted one are tried, all else as it is, and the best one starts another fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from math import inf

import numpy as np

from flexarm.arrays import Floats
from flexarm.budget import allows, current
from flexarm.diagnosis.acceptance import conflict
from flexarm.diagnosis.candidate import Candidate, TransformedParameter, members_at, prior_rows
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import above_noise
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.errors import InvalidParameter, NotConverged


def linearised(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit with all derivatives of one model, as (1) needs it, and the estimator about that."""
    if estimator.members != fit.members:
        estimator = estimator.about(fit)
    elif fit.projection is estimator.eliminated(fit.members)[1]:
        return fit, estimator
    return estimator.linearised(fit.members), estimator


def gauss_newton_step(
    fit: Fit, estimator: Estimator, anew: bool = True, part: float = 1.0, limit: float = inf
) -> tuple[Fit, Estimator]:
    """Return the fit after a step of (1), or a part of it, and its estimator.

    Derivatives with respect to nuisance parameters are computed `anew`, or kept where they predict the step.
    A fit that would stay above the limit is terminated early.

    Raise NotConverged or InvalidParameter if there is no such model.
    """
    dz = _least(fit)
    members = members_at(fit.members, fit.parameters, fit.z + part * dz)
    ahead = replace(fit, members=members, residual=fit.residual + fit.jacobian @ dz)  # determines x after dz
    about = estimator.about(ahead, part) if anew else estimator.towards(ahead, part)
    return about.fit(members, limit=limit, nearby=fit), about


def predicted_decrease(fit: Fit) -> float:
    """Return the predicted fall of the objective of a fit in a step, to first order."""
    dz = _least(fit)
    rest = fit.projection.project(fit.residual + fit.jacobian @ dz)
    ahead = float(rest @ rest) + float(np.sum(prior_rows(fit.parameters, fit.z + dz)[0] ** 2))
    return objective(fit) - ahead


def objective(fit: Fit) -> float:
    """Return the objective of (1)."""
    return fit.cost + float(np.sum(prior_rows(fit.parameters, fit.z)[0] ** 2))


def _least(fit: Fit) -> Floats:
    """Return dz of (1), cut where z would leave its bounds."""
    rows, jacobian = prior_rows(fit.parameters, fit.z)
    found = np.linalg.lstsq(
        np.vstack([fit.projection.project(fit.jacobian), np.diag(jacobian)]),
        -np.concatenate([fit.projection.project(fit.residual), rows]),
        rcond=None,
    )[0]
    bounds = np.array([c.bound for c in fit.parameters])
    return np.asarray(np.clip(fit.z + found, -bounds, bounds) - fit.z)


def hooke_jeeves(fit: Fit, estimator: Estimator) -> tuple[Candidate, ...]:
    """Return the effects of a fit after Hooke-Jeeves steps along its non-smooth laws."""
    cornered = [j for j, c in enumerate(fit.parameters) if not c.smooth]
    if not cornered:
        return fit.members
    solver = estimator.solver(fit.members)

    def height(z: Floats) -> float:
        return float(np.sum(solver.objective_rows(z) ** 2))

    z, least = fit.z, height(fit.z)
    for part in FIT.search_steps:
        for _ in range(FIT.search_moves):
            tried = [
                z + step * np.eye(len(z))[j]
                for j in cornered
                for step in _steps(part, fit.parameters[j], float(z[j]))
            ]
            estimator.problem.prepare(estimator.with_effects(solver.members_at(there)) for there in tried)
            heights = [height(there) for there in tried]
            if min(heights, default=least) >= least:
                break
            least = min(heights)
            z = tried[heights.index(least)]
    return solver.members_at(z)


def _steps(part: float, parameter: TransformedParameter, z: float) -> list[float]:
    """Return the steps of z by such parts of the parameter, up and down, within its bounds."""
    step = abs(part * parameter.value(z) / parameter.slope(z))
    both = [sign * k * step for k in range(1, FIT.search_ahead + 1) for sign in (1, -1)]
    return [each for each in both if abs(z + each) <= parameter.bound]


TIMES = tuple(np.geomspace(0.4, 2.5, 12).tolist())
"""Values of a gap over the one that was found; the series steps over it, as it is known."""


def multi_start(fit: Fit, estimator: Estimator) -> Fit | None:
    """Return a fit from the best of several starts in the parameter whose misfit has several minima.

    None if the model has no such parameter, or no value is better than its own.
    """
    k = next((i for i, member in enumerate(fit.members) if member.effect.multistart), None)
    if k is None:
        return None
    key = str(fit.members[k].effect.multistart)
    value = fit.members[k].value_of(key)
    before, member, after = fit.members[:k], fit.members[k], fit.members[k + 1 :]
    tried = [(*before, member.with_parameters({key: times * value}), *after) for times in TIMES]
    estimator.problem.prepare(estimator.with_effects(members) for members in tried)
    best = min(tried, key=lambda members: _left(members, estimator))
    if _left(best, estimator) >= fit.cost:
        return None
    return estimator.fit(best)


def _left(members: Sequence[Candidate], estimator: Estimator) -> float:
    """Return C; infinite where nothing can be simulated."""
    try:
        rest = estimator.eliminated(members)[1].project(estimator.residual(members))
    except (InvalidParameter, NotConverged):
        return np.inf
    return float(rest @ rest)


def fitted_null(start: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return the model without effects about its own optimum, as fits with effects are, and its estimator.

    The search itself starts with nominal clocks and frames, since effects may replace them.
    """
    best, there = start, estimator
    for _ in range(FIT.null_rounds):
        fit, at = relinearised(best, there)
        before, (best, there) = best, (fit, at) if fit.cost < best.cost else (best, there)
        if fit.cost > FIT.better_share * before.cost:
            break
    return best, there


def relinearised(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit with derivatives about itself, and its estimator; unchanged if it cannot be simulated."""
    try:
        about = estimator.about(fit)
        return about.fit(fit.members, nearby=fit), about
    except FIT_ERRORS:
        return fit, estimator


def estimator_about(fit: Fit, estimator: Estimator) -> Estimator:
    """Return the estimator about a fit, or the same if that cannot be simulated."""
    try:
        return estimator.about(fit)
    except FIT_ERRORS:
        return estimator


def refined_while_better(fit: Fit, about: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit refined while its cost falls, and its estimator."""
    best, there, idle = fit, about, 0
    with suppress(*FIT_ERRORS):
        while idle < FIT.idle_rounds and not (_is_below_noise(best, about) or current().spent):
            ahead, at = refinement_step(best, there, anew=False)
            fell = objective(best) - objective(ahead)
            if fell < FIT.least_fall * sigma_squared(best):
                break
            idle = 0 if fell > (1 - FIT.better_share) * objective(best) else idle + 1
            best, there = ahead, at
    return best, there


def _is_below_noise(fit: Fit, about: Estimator) -> bool:
    """Return True if the residual is well below the noise, without prior-data conflict."""
    left, policy = above_noise(fit.projected, about.problem, fit.non_smooth), about.problem.policy
    return max(left.values()) < FIT.quiet and conflict(fit, policy) < policy.conflict


def converged(fit: Fit, about: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit refined until it converges, and its estimator.

    The search ends with a gap below the noise. Values that act alike may then still be off by several sigma,
    and unconverged alternatives seem distinguishable. All derivatives are of one model, or values that act
    alike would seem known apart. A non-smooth model, or one without effects, stays as it is if its own
    linearisation is clearly better.
    """
    here, at = fit, about
    with suppress(*FIT_ERRORS):
        here, at = linearised(fit, about)
        for _ in range(FIT.converging_steps if fit.members else 0):
            if not allows("all fits had come to rest"):
                break
            ahead, there = linearised(*refinement_step(here, at))
            fell = objective(here) - objective(ahead)
            if fell > 0:
                here, at = ahead, there
            if fell < FIT.converged_fall * sigma_squared(here):
                break
    rests = objective(here) < objective(fit) + FIT.least_fall * sigma_squared(fit)
    smooth = fit.members and not is_non_smooth(about.with_effects(fit.members))
    return (here, at) if rests or smooth else (fit, about)


def refinement_step(fit: Fit, about: Estimator, anew: bool = True) -> tuple[Fit, Estimator]:
    """Return a fit after a Gauss-Newton step or a part of it; if none descends, after a Hooke-Jeeves search.

    The objective never rises. Derivatives with respect to nuisance parameters are computed `anew` after the
    step, or where they did not predict it.

    Raise NotConverged, InvalidParameter or LinAlgError if nothing can be simulated near the fit.
    """
    here, at = linearised(fit, about)
    far = predicted_decrease(here) > sigma_squared(here)
    for part in FIT.backtracking if far else FIT.backtracking[:1]:
        with suppress(*FIT_ERRORS):
            ahead, there = gauss_newton_step(here, at, anew, part, objective(here))
            if objective(ahead) < objective(here):
                return ahead, there
    again = at.fit(hooke_jeeves(here, at))
    return (again, at) if objective(again) < objective(here) else (here, at)


def sigma_squared(fit: Fit) -> float:
    """Return the mean square of a residual, at least that of the noise."""
    return max(1.0, fit.cost / len(fit.residual))
