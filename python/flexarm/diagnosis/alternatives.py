"""Rivals: what could stand in the place of a chosen effect, with the rest of the model refitted.

A rival lies ln B_j behind the chosen model in evidence, the model without that effect ln B_n, which says that
there is nothing in its place but unlikely nominal values. Beside the chosen effect, ln B_0 = 0, its
probability is

    P_j = exp(-ln B_j) / (exp(-ln B_n) + sum_i exp(-ln B_i)).                                          (1)

Those within `SelectionPolicy.reach` of the chosen one are within reach of the data, and so is what fits as
well and is only implausible: it may still be true. Beside a gap that the chosen model leaves open no name is
certain, and rivals are judged by what they foretell of data left out: those that foretell clearly less are
out of reach, and none is ahead that does not foretell clearly better.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp

import numpy as np

from flexarm.arm.effect import effect_class
from flexarm.budget import allows
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import Candidate, carries
from flexarm.diagnosis.collinear import collinear, out_of_step
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import log_bayes_factor, log_likelihood_ratio, predicts_better
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.proposals import one_variant
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.refinement import ROUNDS, further, predicted_decrease
from flexarm.diagnosis.screening import Probed, Share, screen, sharpened
from flexarm.named_effects import Place

NEARER = 0.3
"""Least gain of ln Z in a step of a rival that comes nearer, made or foretold: a tenth of what decides."""


@dataclass(frozen=True, eq=False)
class Rival:
    """An effect in the place of another one, with the rest refitted.

    Attributes
    ----------
    candidate, fit : Candidate and Fit
        The effect, and the model with it.
    behind : float
        ln Z less than the chosen model's.
    fits_behind : float
        The same of the fit alone, whatever is plausible.
    foretells : bool
        Whether it says as much of data that are left out, where a gap is left.
    reach : float
        ln B within which it is an alternative.
    """

    candidate: Candidate
    fit: Fit
    behind: float
    fits_behind: float
    foretells: bool = True
    reach: float = SelectionPolicy.reach

    @property
    def within_reach(self) -> bool:
        """Return True if the data cannot tell it from the chosen effect; what is implausible may still be
        true.
        """
        reach = self.reach
        close = self.behind < reach or (self.fits_behind < reach and self.behind < 2 * reach)
        return close and self.foretells


def rivals_of(
    k: int,
    best: Fit,
    criteria: Criteria,
    estimator: Estimator,
    probed: Sequence[Probed],
    tried: Sequence[Fit],
) -> list[Rival]:
    """Return what could stand in the place of effect k of the chosen model, the best first.

    Fits that were `tried` on the way are taken up; rivals beside an open gap are fewer and fitted once.
    Beside a model that explains everything none is fitted that promises far less than the first. A spring
    that another effect stands on has none.
    """
    problem, null, policy = estimator.problem, criteria.null, criteria.policy
    open_gap = criteria.leaves_gap(best)
    chosen = best.members[k]
    others = tuple(m for i, m in enumerate(best.members) if i != k)
    if carries(others, chosen):
        return []
    fewer = without(others, estimator, (null, *tried))
    if fewer is None:
        return []
    known = _known(best, {m.place for m in others}, tried)
    shares = screen(estimator, probed, fewer)
    wanted = _promising(chosen, shares, fewer, estimator, open_gap)
    if not open_gap:
        if out_of_step(chosen, shares, best, fewer, policy.halfway):
            same = {each.place: each for each in collinear(k, best, estimator, probed)}
            wanted = [*same.values(), *(each for each in wanted if each.place not in same)]
            known = {place: fit for place, fit in known.items() if place not in same}
        wanted += _near(known, wanted, best, problem)
        wanted += _sticking(chosen, wanted, probed)
        before = min((f.cost for f in (null, *tried) if set(f.places) == set(fewer.places)), default=np.inf)
        wanted += _soft_elsewhere(known, wanted, best, before, probed, policy.halfway)
    limit = criteria.early_stop([best], fewer, policy.faint)
    peer = _peer(best, tried)
    found = []
    for candidate in wanted:
        if not allows("all alternatives were fitted"):
            break
        try:
            fit = known.get(candidate.place) or estimator.trial((candidate, *others), best, limit)
            if (alike := candidate.acting_as(chosen)) is not None:
                fit = min(fit, estimator.trial((alike, *others), best, limit), key=lambda f: f.cost)
            fit, behind = _caught_up(fit, best, peer, estimator, open_gap)
        except FIT_ERRORS:
            continue
        found.append(_rival(candidate, fit, best, behind, problem, open_gap))
    return sorted(found, key=lambda rival: rival.behind)


def _promising(
    chosen: Candidate, screened: Sequence[Share], fewer: Fit, estimator: Estimator, open_gap: bool
) -> list[Candidate]:
    """Effects that promise most of what the chosen one explains; beside a gap however little that is."""
    shares = [s for s in screened if s.members[0].place != chosen.place]
    policy = estimator.problem.policy
    most = policy.proposals // 2 if open_gap else policy.proposals
    sharp = sharpened(estimator, one_variant(shares, 2 * most), fewer)[:most]
    return [s.members[0] for s in sharp if open_gap or s.share >= policy.faint * sharp[0].share]


def _rival(
    candidate: Candidate,
    fit: Fit,
    best: Fit,
    behind: float,
    problem: Problem,
    open_gap: bool,
) -> Rival:
    """Return what is said of a rival; beside a gap it is ahead only if it foretells clearly better."""
    member = next(m for m in fit.members if m.place == candidate.place)
    told = not open_gap or not predicts_better(best, fit, problem)
    if open_gap and not predicts_better(fit, best, problem):
        behind = max(behind, 0.0)
    fits_behind = log_likelihood_ratio(best, fit, problem)
    return Rival(member, fit, behind, fits_behind, told, problem.policy.reach)


def without(others: tuple[Candidate, ...], estimator: Estimator, tried: Sequence[Fit]) -> Fit | None:
    """Return the model without the chosen effect; one that was tried, if any, where it cannot be fitted."""
    try:
        return estimator.fit(others)
    except FIT_ERRORS:
        places = {member.place for member in others}
        return next((f for f in reversed(tried) if set(f.places) == places), None)


def _known(best: Fit, others: set[tuple[str, Place]], tried: Sequence[Fit]) -> dict[tuple[str, Place], Fit]:
    """Models that were tried and differ from the chosen one by one effect, by its place."""
    return {
        next(iter(set(f.places) - others)): f
        for f in tried
        if others < set(f.places) and len(f.members) == len(best.members)
    }


def _peer(best: Fit, tried: Sequence[Fit]) -> Fit:
    """Return the chosen model as it was when it was tried beside its rivals, before it was taken further."""
    return next((f for f in reversed(tried) if set(f.places) == set(best.places)), best)


def _near(
    known: Mapping[tuple[str, Place], Fit],
    wanted: Sequence[Candidate],
    best: Fit,
    problem: Problem,
) -> list[Candidate]:
    """Effects that came close when they were tried, though screening, to first order, sees little in them."""
    there = {candidate.place for candidate in wanted} | {member.place for member in best.members}
    return [
        next(m for m in fit.members if m.place == place)
        for place, fit in known.items()
        if place not in there and log_bayes_factor(best, fit, problem) < problem.policy.close
    ]


def _soft_elsewhere(
    known: Mapping[tuple[str, Place], Fit],
    wanted: Sequence[Candidate],
    best: Fit,
    before: float,
    probed: Sequence[Probed],
    part: float,
) -> list[Candidate]:
    """Return the machine's other springs, as soft as one that explained a `part` of what the chosen effect
    does.

    What is soft has moved far from where it was screened: a joint took half of what a base did that gives
    way, beside a strained modulus, and a vibration all of it. `before` is what was left without them.
    """
    half = before - part * (before - best.cost)
    found = [
        (fit.cost, fit, at) for at, fit in known.items() if effect_class(at[0]).is_spring and fit.cost < half
    ]
    if not found or np.isinf(before):
        return []
    _, fit, at = min(found, key=lambda one: one[0])
    spring = next(member for member in fit.members if member.place == at)
    there = {candidate.place for candidate in wanted} | {member.place for member in best.members} | {at}
    others = {p.candidate.place: p.candidate for p in reversed(probed) if p.candidate.effect.is_spring}
    alike = (each.acting_as(spring) for place, each in others.items() if place not in there)
    return [each for each in alike if each is not None]


def _sticking(spring: Candidate, wanted: Sequence[Candidate], probed: Sequence[Probed]) -> list[Candidate]:
    """Hysteresis in the place of a joint's spring, of which it is one while it sticks: no small step."""
    like = [p.candidate for p in probed if (p.candidate.effect.acts_as, p.candidate.at) == spring.place]
    there = like[:1] if like and like[0].place not in (candidate.place for candidate in wanted) else []
    return [each for each in there if each.acting_as(spring) is not None]


def _caught_up(fit: Fit, best: Fit, peer: Fit, estimator: Estimator, open_gap: bool) -> tuple[Fit, float]:
    """Return a rival's model after as many steps as could bring it near the chosen one, and its ln Z behind
    that.

    A rival that was far behind is taken further all the same if the chosen one once was as far behind itself.
    """
    problem, policy = estimator.problem, estimator.problem.policy
    behind = log_bayes_factor(best, fit, problem)
    if behind >= policy.close and log_bayes_factor(peer, fit, problem) >= policy.close:
        return fit, behind
    about = estimator.about(fit)
    fit = about.fit(fit.members, nearby=fit) if open_gap else about.linearised(fit.members)
    behind = log_bayes_factor(best, fit, problem)
    for _ in range(0 if open_gap else ROUNDS):
        if predicted_decrease(fit) / 2 < max(
            NEARER, behind - policy.within_sight
        ):  # no step would bring it near
            break
        try:
            fit, about = further(fit, about, anew=False)
        except FIT_ERRORS:
            break
        before, behind = behind, log_bayes_factor(best, fit, problem)
        if before - behind < max(NEARER, behind - policy.within_sight):  # nor another one like this
            break
    return fit, behind


def probabilities(rivals: Sequence[Rival], gain: float) -> list[float]:
    """Eq. (1) of the chosen effect and its rivals; `gain` is ln B_n."""
    behind = [0.0, *(rival.behind for rival in rivals)]
    odds = [exp(-min(max(each, -50.0), 700.0)) for each in behind]
    nothing = exp(-min(max(gain, 0.0), 700.0))
    return [each / (nothing + sum(odds)) for each in odds]
