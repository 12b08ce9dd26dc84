"""Which of several larger models is best: by the evidence of each over each.

Beside the smaller model all of them differ by the whole gap, and the simulation's error would hide what they
differ by; so they are compared with one another. Where all leave gaps, evidence rests on the size and the
correlation of a remainder that nobody knows; it decides only among those that foretell what is left out about
as well as the best one, by eq. (2) of `left_out`, and are as plausible, by eq. (6) of `acceptance`: a forearm
of thirty times its mass leaves as little as two soft joints beside a friction that neither knows. What leaves
a gap of which it takes too little to be worth a name, as a rate that is read late while an arm goes
elsewhere, stands back for what takes more. When the time is over evidence alone decides: fits that have not
come to rest foretell badly and strain values.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cmp_to_key

import numpy as np

from flexarm.budget import current
from flexarm.diagnosis.acceptance import Criteria, implausibility
from flexarm.diagnosis.cross_validation import log_odds_lost, press_rms
from flexarm.diagnosis.estimator import BETTER, Estimator
from flexarm.diagnosis.evidence import log_bayes_factor
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.refinement import about_itself, polished

STEPS = 3
"""Most times that a fit in conflict with priors is taken anew."""


def best_of(estimator: Estimator, fits: Sequence[Fit], old: Fit, criteria: Criteria) -> tuple[Fit, Estimator]:
    """Return the best fit, polished, with derivatives taken anew about those that come close or foretell
    best.
    """
    problem = criteria.problem
    first, *others = _ranked(fits, old, criteria)
    if criteria.leaves_gap(first):
        limit = criteria.early_stop([first], criteria.null, criteria.policy.halfway / 2)
        near = [f for f in others if f.cost < limit]
        close = sorted(near, key=lambda f: press_rms(f, problem))[:2]
    else:
        close = [f for f in others[:2] if _close(f, first, criteria)]
    there = dict(about_itself(fit, estimator) for fit in (first, *close))
    if not criteria.leaves_gap(first):
        there |= dict(_in_steps(fit, estimator) for fit in _unsettled(others, first, criteria))
    best = _ranked(list(there), old, criteria)[0]
    return polished(best, there[best])


def _ranked(fits: Sequence[Fit], old: Fit, criteria: Criteria) -> list[Fit]:
    """Return the best first, of those worth a name if there are any."""
    problem, reach = criteria.problem, criteria.policy.reach
    fits = [f for f in fits if criteria.reduces(f, old) or not criteria.leaves_gap(f)] or fits

    def behind(one: Fit, other: Fit) -> int:
        return int(np.sign(log_bayes_factor(other, one, problem)))

    if current().spent or not criteria.all_leave_gaps(fits):
        return sorted(fits, key=cmp_to_key(behind))
    odd = [implausibility(f) for f in fits]
    less = [lost + u - min(odd) for lost, u in zip(log_odds_lost(fits, problem), odd, strict=True)]
    lost = dict(zip(fits, (each - min(less) for each in less), strict=True))
    near = [f for f in fits if lost[f] < reach]
    others = [f for f in fits if lost[f] >= reach]
    return sorted(near, key=cmp_to_key(behind)) + sorted(others, key=lambda f: lost[f])


def _unsettled(others: Sequence[Fit], first: Fit, criteria: Criteria) -> list[Fit]:
    """Fits that do half of what the first one does and strain values: derivatives about those are others.

    A load's inertia left a third more than an eccentricity where its mass was thought to be 40 sigmas off.
    """
    half = (criteria.null.cost + first.cost) / 2
    found = [f for f in others if f.cost < half and criteria.in_conflict(f)]
    return sorted(found, key=lambda f: f.cost)[: criteria.policy.more_proposals]


def _in_steps(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit about itself, and about what that finds while it leaves clearly less."""
    for _ in range(STEPS):
        before, (fit, estimator) = fit, about_itself(fit, estimator)
        if fit.cost > BETTER * before.cost:
            break
    return fit, estimator


def _close(fit: Fit, first: Fit, criteria: Criteria) -> bool:
    """Return True if a fit may be as good as the first with derivatives of its own."""
    return log_bayes_factor(first, fit, criteria.problem) < criteria.policy.close
