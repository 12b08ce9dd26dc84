"""The repaired model: the nominal one with refined values and the effects that were found.

Effects that explain all are kept. Where a gap is left, they are kept if they are better than none: if they
close half the gap also where it was not fitted, or if they predict, each part of the training from the others
(`diagnosis.cross_validation`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import log10

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import with_value
from flexarm.diagnosis.candidate import Candidate, springs_first
from flexarm.diagnosis.cross_validation import cross_validated_skill, press_rms
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.selection import Choice
from flexarm.diagnosis.uncertainty import Estimates
from flexarm.errors import InvalidParameter
from flexarm.named_effects import Estimate, Refined

Rounding = Callable[[float, float], float]
"""Of a value, by its standard deviation."""


def repaired(arm: Arm, fit: Fit, sizes: Estimates) -> Arm:
    """Return the nominal model with refined values and the effects of a fit."""
    for refined in filter(moved, sizes.refined):
        arm = _written(partial(_refined, arm, refined))
    found = dict(zip(fit.places, sizes.effects, strict=True))
    for member in springs_first(fit.members):
        arm = _written(partial(_added, arm, member, found[member.place]))
    return arm


def _written(change: Callable[[Rounding], Arm]) -> Arm:
    """Return a model with its new values rounded, or as they are where one is so near a limit of what is
    allowed.
    """
    try:
        return change(_rounded)
    except InvalidParameter:
        return change(lambda value, _: value)


def _refined(arm: Arm, refined: Refined, rounding: Rounding) -> Arm:
    return with_value(arm, refined.parameter, rounding(refined.value, refined.std))


def _added(arm: Arm, member: Candidate, values: Sequence[Estimate], rounding: Rounding) -> Arm:
    sized = {each.name: rounding(each.value, each.std) for each in values}
    return member.with_parameters(sized).enter(arm)


def moved(refined: Refined) -> bool:
    """Return True if the data say anything of a nominal value: not of one across the plane of a planar
    arm.
    """
    return abs(refined.value - refined.nominal) > 1e-3 * refined.std


def _rounded(value: float, std: float) -> float:
    """Return a value to a thousandth of its standard deviation, so that files do not feign more."""
    return value if not std > 0 else round(value, 3 - int(np.floor(log10(std))))


def worth_keeping(choice: Choice, problem: Problem) -> bool:
    """Return True if a fit that does not explain all is better than none: it closes half, or it predicts."""
    if not choice.best.members:
        return False
    best, null = choice.best, choice.null
    if _closes(best, null, problem):
        return True
    return (
        cross_validated_skill(best, null, choice.estimator.nominal_residual(), problem)
        > problem.policy.predictive_share
    )


def _closes(best: Fit, null: Fit, problem: Problem) -> bool:
    """Return True if a fit closes enough of the gap, also where it was not fitted, to be kept with one
    left.
    """
    return press_rms(best, problem) < (1 - problem.policy.most_of_gap) * press_rms(null, problem)
