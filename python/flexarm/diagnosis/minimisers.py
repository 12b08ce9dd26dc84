"""Steps of Gauss and Newton in which effects, clocks, frames and nominal values move together.

A fit moves z through the full simulation, and the unknowns x to first order about where they were. Where
both act alike, such as the stiffness of a link and its modulus, what x does there is known too badly for z to
follow it along the valley of the least C, and fits repeated about themselves creep. With r, J_z = dr/dz, and
J_x = dr/dx of one and the same model,

    min over dz of  C(r + J_z dz) + sum_i ln(1 + (z_i + dz_i)^2/9),                                    (1)

where C eliminates x with J_x. About the model at z + dz and x + dx, with J_x of that one, z is then fitted:
what bends beside the straight step is mended where it costs least.

A search along parameters of laws with corners, without derivatives.

Where an arm falls through a gap or sticks, C of `diagnosis.fit` has ripples: what hits a stop a little
earlier swings on out of step. Differences finer than the ripples say where the next one goes, not where the
least C lies. Steps of some percent of a gap, a torque or a width, along one of them at a time, smaller ones
where none leads down [Hooke1961], go over the ripples.

Starts for a law that bounces: gaps over a range, since between them least squares stop at ripples.

An arm that falls through a gap hits its ends a little earlier for a gap a little smaller and swings on out of
step, so that C of `diagnosis.fit` has ripples along the gap; steps of Newton and of three tenths
(`diagnosis.minimisers`) end in one of them where the probe was far off. Across them C falls to where the gap
is right: gaps of a geometric series about the one that a fit found are tried, with all else as it is, and the
best one starts another fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate, value_of
from flexarm.diagnosis.estimator import Fitter
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.parameters import Coordinate, members_at, prior_rows
from flexarm.errors import InvalidParameter, NotConverged


def evaluated(fit: Fit, fitter: Fitter) -> tuple[Fit, Fitter]:
    """A fit as (1) needs it, with all derivatives of one model, and the fitter about that."""
    if fitter.members != fit.members:
        fitter = fitter.about(fit)
    elif fit.projection is fitter.eliminated(fit.members)[1]:
        return fit, fitter
    return fitter.evaluated(fit.members), fitter


def stepped(
    fit: Fit, fitter: Fitter, anew: bool = True, part: float = 1.0, limit: float = inf
) -> tuple[Fit, Fitter]:
    """The fit after a step of (1), or a part of it, from an evaluated one, and the fitter that made it.

    Its derivatives by unknowns are taken `anew`, or kept where they foretell the step. A fit that would stay
    above the limit is not finished.

    Raises
    ------
    NotConverged, InvalidParameter
        If there is no such model.
    """
    dz = _least(fit)
    members = members_at(fit.members, fit.coordinates, fit.z + part * dz)
    ahead = replace(fit, members=members, residual=fit.residual + fit.slopes @ dz)  # where x is after dz
    about = fitter.about(ahead, part) if anew else fitter.towards(ahead, part)
    return about.fit(members, limit=limit, nearby=fit), about


def foretold(fit: Fit) -> float:
    """By how much the objective of an evaluated fit falls in a step, to first order."""
    dz = _least(fit)
    rest = fit.projection.rest(fit.residual + fit.slopes @ dz)
    ahead = float(rest @ rest) + float(np.sum(prior_rows(fit.coordinates, fit.z + dz)[0] ** 2))
    return objective(fit) - ahead


def objective(fit: Fit) -> float:
    """What (1) makes least."""
    return fit.cost + float(np.sum(prior_rows(fit.coordinates, fit.z)[0] ** 2))


def _least(fit: Fit) -> Floats:
    """dz of (1), cut where z would leave its bounds."""
    rows, slopes = prior_rows(fit.coordinates, fit.z)
    found = np.linalg.lstsq(
        np.vstack([fit.projection.rest(fit.slopes), np.diag(slopes)]),
        -np.concatenate([fit.projection.rest(fit.residual), rows]),
        rcond=None,
    )[0]
    bounds = np.array([c.bound for c in fit.coordinates])
    return np.asarray(np.clip(fit.z + found, -bounds, bounds) - fit.z)


STEPS = (0.1, 0.03, 0.01, 0.003)
"""Parts of a parameter."""
AHEAD = 3
"""Steps that are looked at to each side."""
MOVES = 4
"""Most moves of one size."""


def stepped_over(fit: Fit, fitter: Fitter) -> tuple[Candidate, ...]:
    """The effects of a fit where steps along cornered laws lead down to; as they are if none does."""
    cornered = [j for j, c in enumerate(fit.coordinates) if not c.smooth]
    if not cornered:
        return fit.members
    problem = fitter.problem(fit.members)

    def height(z: Floats) -> float:
        return float(np.sum(problem.rows(z) ** 2))

    z, least = fit.z, height(fit.z)
    for part in STEPS:
        for _ in range(MOVES):
            tried = [
                z + step * np.eye(len(z))[j]
                for j in cornered
                for step in _steps(part, fit.coordinates[j], float(z[j]))
            ]
            fitter.observed.prepare(fitter.with_effects(problem.members_at(there)) for there in tried)
            heights = [height(there) for there in tried]
            if min(heights, default=least) >= least:
                break
            least = min(heights)
            z = tried[heights.index(least)]
    return problem.members_at(z)


def _steps(part: float, coordinate: Coordinate, z: float) -> list[float]:
    """Steps of z by such parts of the parameter, up and down, within its bounds."""
    step = abs(part * coordinate.value(z) / coordinate.slope(z))
    both = [sign * k * step for k in range(1, AHEAD + 1) for sign in (1, -1)]
    return [each for each in both if abs(z + each) <= coordinate.bound]


TIMES = tuple(np.geomspace(0.4, 2.5, 12).tolist())
"""Values of a gap over the one that was found; the series steps over it, as it is known."""


def scanned(fit: Fit, fitter: Fitter) -> Fit | None:
    """A fit from the best of several starts in the parameter whose misfit has several minima.

    None where the model has no such parameter, or no value is better than its own.
    """
    k = next((i for i, member in enumerate(fit.members) if member.effect.multistart), None)
    if k is None:
        return None
    key = str(fit.members[k].effect.multistart)
    value = value_of(fit.members[k].effect, key)
    tried = [_with_value(fit.members, k, key, times * value) for times in TIMES]
    fitter.observed.prepare(fitter.with_effects(members) for members in tried)
    best = min(tried, key=lambda members: _left(members, fitter))
    if _left(best, fitter) >= fit.cost:
        return None
    return fitter.fit(best)


def _with_value(members: Sequence[Candidate], k: int, key: str, value: float) -> tuple[Candidate, ...]:
    moved = replace(members[k], effect=members[k].effect.with_parameters({key: value}))
    return (*members[:k], moved, *members[k + 1 :])


def _left(members: Sequence[Candidate], fitter: Fitter) -> float:
    """C; infinite where nothing can be simulated."""
    try:
        rest = fitter.eliminated(members)[1].rest(fitter.residual(members))
    except (InvalidParameter, NotConverged):
        return np.inf
    return float(rest @ rest)
