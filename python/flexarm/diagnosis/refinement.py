"""Fits taken further: at the model that it found, a fit takes derivatives by unknowns anew.

Clocks, frames and nominal values are eliminated to first order about the model that a fit starts from
(`diagnosis.fit`), and so is what its time steps miss. About the model that it found both are better
known. A step or two in which all that is free moves together (`diagnosis.minimisers`) then finds what fits
repeated about themselves creep towards: where a link's stiffness and its modulus act alike these stop
percents short.
"""

from __future__ import annotations

from contextlib import suppress

from flexarm.budget import allows, current
from flexarm.diagnosis.acceptance import conflict
from flexarm.diagnosis.estimator import BETTER, Estimator
from flexarm.diagnosis.evidence import above_noise
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.minimisers import (
    gauss_newton_step,
    hooke_jeeves,
    linearised,
    objective,
    predicted_decrease,
)
from flexarm.diagnosis.residual_rows import is_non_smooth

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
