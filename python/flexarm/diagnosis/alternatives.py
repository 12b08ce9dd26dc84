"""Alternative models: another effect in the place of a chosen one, with the rest of the model refitted.

An alternative lies ln B_j behind the chosen model in evidence. The model without the effect, whose only
explanation are unlikely nominal values, lies ln B_n behind. With ln B_0 = 0 the probability of a name is

    P_j = exp(-ln B_j) / (exp(-ln B_n) + sum_i exp(-ln B_i)).                                          (1)

Alternatives within `SelectionPolicy.reach` of the chosen effect are indistinguishable from it, and so is one
that fits as well and is only implausible. Where the chosen model leaves a gap no name is certain.
Alternatives are then compared by cross-validation: those that predict clearly worse are out of reach, and
none is ahead that does not predict clearly better.

**Collinear effects.** A mass that is 4 % off puts a lightly damped arm out of phase within some periods.
About the model without the effect, in which alternatives are screened, it explains little to first order, and
so do they. About the chosen model, with J_e the response to the effect and D that to small steps of a
candidate, both projected orthogonally to nuisance parameters and the other effects,

    R2 = |P J_e|^2 / |J_e|^2,    P = D (D^T D)^-1 D^T                                                  (2)

is 1 for a candidate with the same response. It is fitted from the size at which the responses agree.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import exp, isfinite

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.effect import effect_class
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import Candidate, is_required
from flexarm.diagnosis.cross_validation import predicts_better
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import log_bayes_factor, log_likelihood_ratio
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.proposals import one_variant
from flexarm.diagnosis.moves.search_state import small_steps
from flexarm.diagnosis.policy import FIT, SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.refinement import predicted_decrease, refinement_step
from flexarm.diagnosis.screening import LONGER, Probed, Share, rescreened_at_size, screen
from flexarm.errors import InvalidParameter
from flexarm.named_effects import Place


def out_of_step(chosen: Candidate, shares: Sequence[Share], best: Fit, fewer: Fit, part: float) -> bool:
    """Return True if screening without an effect sees less than a part of what it explains."""
    seen = max((s.share for s in shares if s.places == (chosen.place,)), default=0.0)
    return seen < part * (1.0 - best.cost / fewer.cost)


def collinear(k: int, best: Fit, estimator: Estimator, probed: Sequence[Probed]) -> list[Candidate]:
    """Return candidates of which (2) is above `confounded`, few, the highest R2 first."""
    policy, chosen = estimator.problem.policy, best.members[k]
    own = np.array([parameter.candidate == k for parameter in best.parameters])
    there = {None, *best.spots}
    found = {
        p.candidate.place: p.candidate
        for p in reversed(probed)
        if p.candidate.effect.smooth
        and not p.candidate.effect.is_wave
        and p.candidate.needs is None
        and p.candidate.required_place in there
        and not p.candidate.spots & best.spots
    }
    ranked: list[tuple[float, Candidate]] = []
    effect = best.jacobian[:, own] @ _away(chosen, best, own)
    fine = replace(estimator, problem=estimator.problem.with_step(estimator.problem.step / LONGER))
    with suppress(*FIT_ERRORS):
        moved = small_steps(fine, [*found.values()], best)  # in time steps of the fit
        for candidate, steps in zip(found.values(), moved, strict=True):
            if steps is None:
                continue
            columns = np.column_stack([effect, steps.moves, best.jacobian[:, ~own]])
            rest = best.projection.project(columns)
            sizes = np.linalg.lstsq(rest[:, 1:], rest[:, 0], rcond=None)[0]
            left = rest[:, 0] - rest[:, 1:] @ sizes
            r2 = 1.0 - float(left @ left) / max(float(rest[:, 0] @ rest[:, 0]), 1e-300)  # eq. (2)
            if r2 > policy.confounded:
                ranked.append((r2, candidate.at_size(sizes[: steps.moves.shape[1]].tolist())))
    ranked.sort(key=lambda one: -one[0])
    return [candidate for _, candidate in ranked[: policy.more_proposals]]


def _away(chosen: Candidate, best: Fit, own: NDArray[np.bool_]) -> Floats:
    """Return how far each parameter of the effect is from none of it, in z; 1 where that is not finite."""
    found = []
    for k in np.flatnonzero(own):
        parameter, away = best.parameters[k], 1.0
        null = chosen.null.get(parameter.name, np.nan)
        with suppress(InvalidParameter):
            away = float(best.z[k]) - parameter.z(null) if isfinite(null) else away
        found.append(away)
    return np.array(found)


@dataclass(frozen=True, eq=False)
class AlternativeModel:
    """An effect in the place of another one, with the rest refitted."""

    candidate: Candidate
    fit: Fit
    """The effect, and the model with it."""
    behind: float
    """Difference of log evidence to the chosen model."""
    fits_behind: float
    """The same of the likelihood alone, without priors."""
    predicts: bool = True
    """True if it predicts left-out data as well, where a gap is left."""
    reach: float = SelectionPolicy.reach
    """ln B within which it is an alternative."""

    @property
    def within_reach(self) -> bool:
        """Return True if the data cannot distinguish it from the chosen effect, plausible or not."""
        reach = self.reach
        close = self.behind < reach or (self.fits_behind < reach and self.behind < 2 * reach)
        return close and self.predicts


def alternatives_of(
    k: int,
    best: Fit,
    criteria: Criteria,
    estimator: Estimator,
    probed: Sequence[Probed],
    tried: Sequence[Fit],
    tell: Callable[[str, float], object] = lambda what, done: None,
) -> list[AlternativeModel]:
    """Return the alternatives of effect k of the chosen model, the best first.

    `tell` hears what is fitted, and the share done. Fits that the search has `tried` are reused. If the model
    leaves a gap, fewer alternatives are fitted, and once. If it explains everything, none is fitted that
    promises far less than the first. A spring that another effect requires has none.
    """
    problem, null, policy = estimator.problem, criteria.null, criteria.policy
    open_gap = criteria.leaves_gap(best)
    chosen = best.members[k]
    others = tuple(m for i, m in enumerate(best.members) if i != k)
    if is_required(others, chosen):
        return []
    fewer = without(others, estimator, (null, *tried))
    if fewer is None:
        return []
    known = _known(best, {m.place for m in others}, tried)
    shares = screen(estimator, probed, fewer)
    wanted = _screened(chosen, shares, fewer, estimator, open_gap)
    if not open_gap:
        if out_of_step(chosen, shares, best, fewer, policy.halfway):
            same = {each.place: each for each in collinear(k, best, estimator, probed)}
            wanted = [*same.values(), *(each for each in wanted if each.place not in same)]
            known = {place: fit for place, fit in known.items() if place not in same}
        wanted += _near(known, wanted, best, problem)
        wanted += _hysteresis(chosen, wanted, probed)
        before = min((f.cost for f in (null, *tried) if set(f.places) == set(fewer.places)), default=np.inf)
        wanted += _springs_elsewhere(known, wanted, best, before, probed, policy.halfway)
    limit = criteria.early_stop([best], fewer, policy.faint)
    peer = _as_tried(best, tried)
    found = []
    for number, candidate in enumerate(wanted):
        if not allows("all alternatives were fitted"):
            break
        share = (k + number / len(wanted)) / len(best.members)
        tell(f"alternative {number + 1} of {len(wanted)} to effect {k + 1}", share)
        try:
            fit = known.get(candidate.place) or estimator.trial((candidate, *others), best, limit)
            for alike in filter(None, (candidate.acting_as(chosen), candidate.shaped_as(chosen))):
                fit = min(fit, estimator.trial((alike, *others), best, limit), key=lambda f: f.cost)
            fit, behind = _refined_model(fit, best, peer, estimator, open_gap)
        except FIT_ERRORS:
            continue
        found.append(_alternative_model(candidate, fit, best, behind, problem, open_gap))
    return sorted(found, key=lambda alternative: alternative.behind)


def _screened(
    chosen: Candidate, screened: Sequence[Share], fewer: Fit, estimator: Estimator, open_gap: bool
) -> list[Candidate]:
    """Return effects that promise most of what the chosen one explains; given a gap, however little."""
    shares = [s for s in screened if s.members[0].place != chosen.place]
    policy = estimator.problem.policy
    most = policy.proposals // 2 if open_gap else policy.proposals
    sharp = rescreened_at_size(estimator, one_variant(shares, 2 * most), fewer)[:most]
    return [s.members[0] for s in sharp if open_gap or s.share >= policy.faint * sharp[0].share]


def _alternative_model(
    candidate: Candidate,
    fit: Fit,
    best: Fit,
    behind: float,
    problem: Problem,
    open_gap: bool,
) -> AlternativeModel:
    """Return an alternative; where a gap is left it is ahead only if it predicts clearly better."""
    member = next(m for m in fit.members if m.place == candidate.place)
    told = not open_gap or not predicts_better(best, fit, problem)
    if open_gap and not predicts_better(fit, best, problem):
        behind = max(behind, 0.0)
    fits_behind = log_likelihood_ratio(best, fit, problem)
    return AlternativeModel(member, fit, behind, fits_behind, told, problem.policy.reach)


def without(others: tuple[Candidate, ...], estimator: Estimator, tried: Sequence[Fit]) -> Fit | None:
    """Return the model without the chosen effect; one that was tried, if any, where it cannot be fitted."""
    try:
        return estimator.fit(others)
    except FIT_ERRORS:
        places = {member.place for member in others}
        return next((f for f in reversed(tried) if set(f.places) == places), None)


def _known(best: Fit, others: set[tuple[str, Place]], tried: Sequence[Fit]) -> dict[tuple[str, Place], Fit]:
    """Return models that were tried and differ from the chosen one by one effect, by its place."""
    return {
        next(iter(set(f.places) - others)): f
        for f in tried
        if others < set(f.places) and len(f.members) == len(best.members)
    }


def _near(
    known: Mapping[tuple[str, Place], Fit],
    wanted: Sequence[Candidate],
    best: Fit,
    problem: Problem,
) -> list[Candidate]:
    """Return effects that came close when they were tried, whatever their screened share."""
    there = {candidate.place for candidate in wanted} | {member.place for member in best.members}
    return [
        next(m for m in fit.members if m.place == place)
        for place, fit in known.items()
        if place not in there and log_bayes_factor(best, fit, problem) < problem.policy.close
    ]


def _as_tried(best: Fit, tried: Sequence[Fit]) -> Fit:
    """Return the chosen model as it was tried along with its alternatives, before its refinement."""
    return next((f for f in reversed(tried) if set(f.places) == set(best.places)), best)


def _springs_elsewhere(
    known: Mapping[tuple[str, Place], Fit],
    wanted: Sequence[Candidate],
    best: Fit,
    before: float,
    probed: Sequence[Probed],
    part: float,
) -> list[Candidate]:
    """Return the machine's other springs, as soft as one that explained a `part` of what the chosen effect
    does.

    Screening is linear, and a soft spring has moved far from where it was screened. `before` is the cost
    without them.
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


def _hysteresis(spring: Candidate, wanted: Sequence[Candidate], probed: Sequence[Probed]) -> list[Candidate]:
    """Return hysteresis in the place of a joint's spring: while it sticks it acts as one."""
    like = [p.candidate for p in probed if (p.candidate.effect.acts_as, p.candidate.at) == spring.place]
    there = like[:1] if like and like[0].place not in (candidate.place for candidate in wanted) else []
    return [each for each in there if each.acting_as(spring) is not None]


def _refined_model(fit: Fit, best: Fit, peer: Fit, estimator: Estimator, open_gap: bool) -> tuple[Fit, float]:
    """Return the model of an alternative after as many steps as could bring it near, and its ln Z behind.

    An alternative that was far behind is refined all the same if the chosen one once was as far behind
    itself.
    """
    problem, policy = estimator.problem, estimator.problem.policy
    behind = log_bayes_factor(best, fit, problem)
    if behind >= policy.close and log_bayes_factor(peer, fit, problem) >= policy.close:
        return fit, behind
    about = estimator.about(fit)
    fit = about.fit(fit.members, nearby=fit) if open_gap else about.linearised(fit.members)
    behind = log_bayes_factor(best, fit, problem)
    for _ in range(0 if open_gap else FIT.converging_steps):
        needed = max(FIT.least_gain, behind - policy.within_sight)
        if predicted_decrease(fit) / 2 < needed:  # no step would bring it near
            break
        try:
            fit, about = refinement_step(fit, about, anew=False)
        except FIT_ERRORS:
            break
        before, behind = behind, log_bayes_factor(best, fit, problem)
        if before - behind < max(FIT.least_gain, behind - policy.within_sight):  # neither would another one
            break
    return fit, behind


def probabilities(alternatives: Sequence[AlternativeModel], gain: float) -> list[float]:
    """Return eq. (1) of the chosen effect and its alternatives; `gain` is ln B_n."""
    behind = [0.0, *(alternative.behind for alternative in alternatives)]
    odds = [exp(-min(max(each, -50.0), 700.0)) for each in behind]
    nothing = exp(-min(max(gain, 0.0), 700.0))
    return [each / (nothing + sum(odds)) for each in odds]
