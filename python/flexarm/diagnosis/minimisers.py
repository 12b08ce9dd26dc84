"""Minimisers beside `least_squares`: joint Gauss-Newton steps, a search without derivatives, multi-start.

**Joint steps.** A fit moves z through the full simulation and the nuisance parameters x to first order about
an earlier model. Where both act alike, as the stiffness of a link and its modulus do, such fits creep. With
r, J_z = dr/dz and J_x = dr/dx of one and the same model,

    min over dz of  C(r + J_z dz) + sum_i ln(1 + (z_i + dz_i)^2/9),                                    (1)

where C eliminates x with J_x. z is then fitted about the model at z + dz and x + dx, with J_x of that one.

**Hooke-Jeeves.** For non-smooth laws C of `diagnosis.fit` has ripples. Steps of some percent of a gap, a
torque or a width, along one parameter at a time and smaller where none descends, pass over them [Hooke1961].

**Multi-start.** Along the gap of a backlash each ripple is a minimum. Gaps of a geometric series about the
fitted one are tried, all else as it is, and the best one starts another fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.parameters import TransformedParameter, members_at, prior_rows
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
