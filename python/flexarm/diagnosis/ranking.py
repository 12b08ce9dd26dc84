"""Which of several larger models is best: by the evidence of each over each.

Beside the smaller model all of them differ by the whole gap, and the simulation's error would hide what they
differ by; so they are compared with one another. Where all leave gaps, evidence rests on the size and the
correlation of a remainder that nobody knows; it decides only among those that foretell what is left out about
as well as the best one, by eq. (2) of `left_out`, and are as plausible, by eq. (6) of `acceptance`: a forearm
of thirty times its mass leaves as little as two soft joints beside a friction that neither knows. What leaves
a gap of which it takes too little to be worth a name, as a rate that is read late while an arm goes
elsewhere, stands back for what takes more.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cmp_to_key

import numpy as np

from flexarm.diagnosis.acceptance import (
    REACH,
    STRAINED,
    implausibility,
    leaves_gap,
    limit_beside,
    strain,
    worth_a_name,
)
from flexarm.diagnosis.cross_validation import log_odds_lost, press_rms
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import log_bayes_factor, variance_inflation
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.refinement import BETTER, about_itself, polished

UNSETTLED, STEPS = 4, 3
"""Most fits that are taken anew since they strain values, and how often."""
BESIDE_GAPS = 0.25
"""Part of what the first explains by which others may stay behind that are fitted anew beside a gap."""
CLOSE = 30.0
"""How far behind in ln Z a model is fitted with derivatives of its own."""


def best_of(estimator: Estimator, fits: Sequence[Fit], old: Fit, null: Fit) -> tuple[Fit, Estimator]:
    """The best fit, polished, with derivatives taken anew about those that come close or foretell best."""
    problem = estimator.problem
    first, *others = _ranked(fits, old, null, problem)
    if leaves_gap(first, null, problem):
        near = [f for f in others if f.cost < limit_beside([first], null, BESIDE_GAPS)]
        close = sorted(near, key=lambda f: press_rms(f, problem))[:2]
    else:
        close = [f for f in others[:2] if _close(f, first, problem)]
    there = dict(about_itself(fit, estimator) for fit in (first, *close))
    if not leaves_gap(first, null, problem):
        there |= dict(_in_steps(fit, estimator) for fit in _unsettled(others, first, null))
    best = _ranked(list(there), old, null, problem)[0]
    return polished(best, there[best])


def _ranked(fits: Sequence[Fit], old: Fit, null: Fit, problem: Problem) -> list[Fit]:
    """The best first, of those worth a name if there are any."""
    fits = [f for f in fits if worth_a_name(f, old) or not leaves_gap(f, null, problem)] or fits
    value = variance_inflation(min(fits, key=lambda f: f.cost).projected, problem)

    def behind(one: Fit, other: Fit) -> int:
        return int(np.sign(log_bayes_factor(other, one, problem, value)))

    if not all(leaves_gap(f, null, problem) for f in fits):
        return sorted(fits, key=cmp_to_key(behind))
    odd = [implausibility(f) for f in fits]
    less = [lost + u - min(odd) for lost, u in zip(log_odds_lost(fits, problem), odd, strict=True)]
    lost = dict(zip(fits, (each - min(less) for each in less), strict=True))
    near = [f for f in fits if lost[f] < REACH]
    others = [f for f in fits if lost[f] >= REACH]
    return sorted(near, key=cmp_to_key(behind)) + sorted(others, key=lambda f: lost[f])


def _unsettled(others: Sequence[Fit], first: Fit, null: Fit) -> list[Fit]:
    """Fits that do half of what the first one does and strain values: derivatives about those are others.

    A load's inertia left a third more than an eccentricity where its mass was thought to be 40 sigmas off.
    """
    half = (null.cost + first.cost) / 2
    found = [f for f in others if f.cost < half and strain(f) > STRAINED]
    return sorted(found, key=lambda f: f.cost)[:UNSETTLED]


def _in_steps(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """A fit about itself, and about what that finds while it leaves clearly less."""
    for _ in range(STEPS):
        before, (fit, estimator) = fit, about_itself(fit, estimator)
        if fit.cost > BETTER * before.cost:
            break
    return fit, estimator


def _close(fit: Fit, first: Fit, problem: Problem) -> bool:
    """Whether a fit may be as good as the first with derivatives of its own."""
    value = variance_inflation(min((fit, first), key=lambda f: f.cost).projected, problem)
    return log_bayes_factor(first, fit, problem, value) < CLOSE
