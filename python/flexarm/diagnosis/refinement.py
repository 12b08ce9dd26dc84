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
from flexarm.diagnosis.estimator import BETTER, Estimator
from flexarm.diagnosis.evidence import above_noise
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.errors import InvalidParameter, NotConverged


def linearised(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit as (1) needs it, with all derivatives of one model, and the fitter about that."""
    if estimator.members != fit.members:
        estimator = estimator.about(fit)
    elif fit.projection is estimator.eliminated(fit.members)[1]:
        return fit, estimator
    return estimator.linearised(fit.members), estimator


def gauss_newton_step(
    fit: Fit, estimator: Estimator, anew: bool = True, part: float = 1.0, limit: float = inf
) -> tuple[Fit, Estimator]:
    """Return the fit after a step of (1), or a part of it, from an evaluated one, and the fitter that made
    it.

    Its derivatives by unknowns are taken `anew`, or kept where they foretell the step. A fit that would stay
    above the limit is not finished.

    Raises
    ------
    NotConverged, InvalidParameter
        If there is no such model.
    """
    dz = _least(fit)
    members = members_at(fit.members, fit.parameters, fit.z + part * dz)
    ahead = replace(fit, members=members, residual=fit.residual + fit.jacobian @ dz)  # where x is after dz
    about = estimator.about(ahead, part) if anew else estimator.towards(ahead, part)
    return about.fit(members, limit=limit, nearby=fit), about


def predicted_decrease(fit: Fit) -> float:
    """By how much the objective of an evaluated fit falls in a step, to first order."""
    dz = _least(fit)
    rest = fit.projection.project(fit.residual + fit.jacobian @ dz)
    ahead = float(rest @ rest) + float(np.sum(prior_rows(fit.parameters, fit.z + dz)[0] ** 2))
    return objective(fit) - ahead


def objective(fit: Fit) -> float:
    """Return what (1) makes least."""
    return fit.cost + float(np.sum(prior_rows(fit.parameters, fit.z)[0] ** 2))


def _least(fit: Fit) -> Floats:
    """dz of (1), cut where z would leave its bounds."""
    rows, jacobian = prior_rows(fit.parameters, fit.z)
    found = np.linalg.lstsq(
        np.vstack([fit.projection.project(fit.jacobian), np.diag(jacobian)]),
        -np.concatenate([fit.projection.project(fit.residual), rows]),
        rcond=None,
    )[0]
    bounds = np.array([c.bound for c in fit.parameters])
    return np.asarray(np.clip(fit.z + found, -bounds, bounds) - fit.z)


STEPS = (0.1, 0.03, 0.01, 0.003)
"""Parts of a parameter."""
AHEAD = 3
"""Steps that are looked at to each side."""
MOVES = 4
"""Most moves of one size."""


def hooke_jeeves(fit: Fit, estimator: Estimator) -> tuple[Candidate, ...]:
    """Return the effects of a fit where steps along cornered laws lead down to; as they are if none does."""
    cornered = [j for j, c in enumerate(fit.parameters) if not c.smooth]
    if not cornered:
        return fit.members
    solver = estimator.solver(fit.members)

    def height(z: Floats) -> float:
        return float(np.sum(solver.objective_rows(z) ** 2))

    z, least = fit.z, height(fit.z)
    for part in STEPS:
        for _ in range(MOVES):
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
    both = [sign * k * step for k in range(1, AHEAD + 1) for sign in (1, -1)]
    return [each for each in both if abs(z + each) <= parameter.bound]


TIMES = tuple(np.geomspace(0.4, 2.5, 12).tolist())
"""Values of a gap over the one that was found; the series steps over it, as it is known."""


def multi_start(fit: Fit, estimator: Estimator) -> Fit | None:
    """Return a fit from the best of several initial_conditions in the parameter whose misfit has several
    minima.

    None where the model has no such parameter, or no value is better than its own.
    """
    k = next((i for i, member in enumerate(fit.members) if member.effect.multistart), None)
    if k is None:
        return None
    key = str(fit.members[k].effect.multistart)
    value = fit.members[k].value_of(key)
    tried = [_with_value(fit.members, k, key, times * value) for times in TIMES]
    estimator.problem.prepare(estimator.with_effects(members) for members in tried)
    best = min(tried, key=lambda members: _left(members, estimator))
    if _left(best, estimator) >= fit.cost:
        return None
    return estimator.fit(best)


def _with_value(members: Sequence[Candidate], k: int, key: str, value: float) -> tuple[Candidate, ...]:
    return (*members[:k], members[k].with_parameters({key: value}), *members[k + 1 :])


def _left(members: Sequence[Candidate], estimator: Estimator) -> float:
    """C; infinite where nothing can be simulated."""
    try:
        rest = estimator.eliminated(members)[1].project(estimator.residual(members))
    except (InvalidParameter, NotConverged):
        return np.inf
    return float(rest @ rest)


ROUNDS = 6
"""Most steps of `settled`."""
IDLE, QUIET = 2, 0.4
"""Of `polished`: idle rounds, and what is left above the noise where it ends."""
STILL, SETTLED = 1.0, 0.1
"""Least fall of C in a round of each, in squared sigmas: those of the noise or, above it, of what is left."""
SHORTER = (1.0, 0.3, 0.1)
"""Parts of a step that are tried, of which the whole would lead far down to first order, and leads up."""
NULL_ROUNDS = 2
"""Rounds in which the model without effects is fitted about itself."""


def without_effects(start: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return the nominal model about its own optimum, as fits with effects are, and where it was found.

    Otherwise any effect seems better.

    The search itself starts where clocks and frames are nominal, since effects may take their places.
    """
    best, there = start, estimator
    for _ in range(NULL_ROUNDS):
        fit, at = about_itself(best, there)
        before, (best, there) = best, (fit, at) if fit.cost < best.cost else (best, there)
        if fit.cost > BETTER * before.cost:
            break
    return best, there


def about_itself(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit once more with derivatives of its own, and where; as it is if they cannot be taken."""
    try:
        about = estimator.about(fit)
        return about.fit(fit.members, nearby=fit), about
    except FIT_ERRORS:
        return fit, estimator


def about_or_here(fit: Fit, estimator: Estimator) -> Estimator:
    """Return the fitter about a fit, or as it is if no derivatives can be taken there."""
    try:
        return estimator.about(fit)
    except FIT_ERRORS:
        return estimator


def polished(fit: Fit, about: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit taken further until it leaves no less, and where it was found."""
    best, there, idle = fit, about, 0
    with suppress(*FIT_ERRORS):
        while idle < IDLE and not (_quiet(best, about) or current().spent):
            ahead, at = further(best, there, anew=False)
            fell = objective(best) - objective(ahead)
            if fell < STILL * sigma_squared(best):
                break
            idle = 0 if fell > (1 - BETTER) * objective(best) else idle + 1
            best, there = ahead, at
    return best, there


def _quiet(fit: Fit, about: Estimator) -> bool:
    """Return True if nothing is left that would be looked at, and no unknown is strained."""
    left, policy = above_noise(fit.projected, about.problem, fit.non_smooth), about.problem.policy
    return max(left.values()) < QUIET and conflict(fit, policy) < policy.conflict


def settled(fit: Fit, about: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit taken further until it rests: its values are those of the least C.

    What ends the search for names, a gap below the noise, leaves values that are off by several sigma where
    they act alike, and rivals that are compared before they have come to rest seem apart that are not. All
    derivatives are of one model, or what acts alike would seem known apart. Beside corners, or without
    effects, for which no steps are taken, a fit may be so much better by its own account, in which unknowns
    act in proportion, that it stays as it is. Elsewhere steps lead to where C is least, and what unknowns
    would do in proportion from afar is no better than that.
    """
    here, at = fit, about
    with suppress(*FIT_ERRORS):
        here, at = linearised(fit, about)
        for _ in range(ROUNDS if fit.members else 0):
            if not allows("all fits had come to rest"):
                break
            ahead, there = linearised(*further(here, at))
            fell = objective(here) - objective(ahead)
            if fell > 0:
                here, at = ahead, there
            if fell < SETTLED * sigma_squared(here):
                break
    rests = objective(here) < objective(fit) + STILL * sigma_squared(fit)
    smooth = fit.members and not is_non_smooth(about.with_effects(fit.members))
    return (here, at) if rests or smooth else (fit, about)


def further(fit: Fit, about: Estimator, anew: bool = True) -> tuple[Fit, Estimator]:
    """Return a step of Newton from a fit, or a part of it; where all lead up, as over ripples, what a
    search finds.

    Never one of which the objective is higher than that of the fit, all derivatives taken about it. Those by
    unknowns are taken `anew` after the step, or where they did not foretell it.

    Raises
    ------
    NotConverged, InvalidParameter, LinAlgError
        If nothing can be simulated beside the fit.
    """
    here, at = linearised(fit, about)
    far = predicted_decrease(here) > sigma_squared(here)
    for part in SHORTER if far else SHORTER[:1]:
        with suppress(*FIT_ERRORS):
            ahead, there = gauss_newton_step(here, at, anew, part, objective(here))
            if objective(ahead) < objective(here):
                return ahead, there
    again = at.fit(hooke_jeeves(here, at))
    return (again, at) if objective(again) < objective(here) else (here, at)


def sigma_squared(fit: Fit) -> float:
    """Of a residual: one of noise alone, more where a gap is left."""
    return max(1.0, fit.cost / len(fit.residual))
