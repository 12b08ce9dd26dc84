"""Proposals of larger models: the effects that promise most, or sets of them, given those of a model.

A screening (`diagnosis.screening`) ranks effects and places; the first few are fitted. Sets of two or three
are fitted only where no smaller one explains all, sets of three only if no extension of a smaller set
explains as much.

A mass or a stiffness that is far off shifts the frequency of a vibration, and within some periods the model
is out of phase: linearisation then fails. Static deflections and torques remain nearly linear. Moving
averages of the residuals, in which vibrations hardly show, are therefore screened too.

A base that gives way moves an arm almost as a soft joint does: springs are tried elsewhere. A law of another
shape is still that law: before a second effect is sought, one more shape parameter of a found law is freed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from flexarm.arm.effect import effect_class
from flexarm.arm.spring_effect import SpringEffect
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import Candidate, is_required
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.search_state import SearchState, newly_soft_joints, silent
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.refinement import multi_start
from flexarm.diagnosis.screening import NONE, Probed, Share, rescreened_at_size, screen, screen_sets
from flexarm.named_effects import Place


def slow_part(problem: Problem) -> Callable[[Floats], Floats]:
    """Return a function that averages columns of residuals over `low_pass` seconds, channel by channel."""
    windows = []
    for each, where in problem.channels():
        if problem.records[each.record].kind == "motion" and len(each.time) > 1:
            windows.append((where, round(problem.policy.low_pass / float(np.median(np.diff(each.time))))))

    def averaged(columns: Floats) -> Floats:
        from scipy.ndimage import uniform_filter1d

        found = columns.copy()
        for where, size in windows:
            if size > 1:
                found[where] = uniform_filter1d(columns[where], size, axis=0, mode="nearest")
        return found

    return averaged


def singles(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose the most promising single effects, unless nothing but a resolved conflict was left."""
    here = best if best.members else state.null
    if found and state.criteria.adequate(here):
        return []
    here = best if best.members else state.start
    probed = state.candidates(best, about)
    return fit_singles(about, probed, here, state.criteria, state.places, found, state.tell)


def fit_singles(
    estimator: Estimator,
    probed: Sequence[Probed],
    best: Fit,
    criteria: Criteria,
    places: Mapping[str, str] = NONE,
    found: Sequence[Fit] = (),
    tell: Callable[[str], object] = silent,
) -> list[Fit]:
    """Return fits of the most promising candidates, given the effects of `best`.

    Where all leave a gap, candidates that explain most at low frequency are fitted too, at the first step
    those of the second rank, and a backlash from other starts. `places` are joints that are one place of the
    machine; `found` are fits of the same size.
    """
    policy = criteria.policy
    at_ends = not found or not criteria.adequate(best)
    wanted, others = _screened(estimator, probed, best, places, at_ends)
    more = fitted(estimator, wanted, best, criteria, tell=tell)
    if criteria.all_leave_gaps([*found, *more]) and policy.allows("low_pass"):
        slow = screen(estimator, probed, best, seen=slow_part(estimator.problem))
        slower = [s for s in one_variant(slow, policy.more_proposals) if not _is_fitted(s, best, more)]
        more += fitted(estimator, slower, best, criteria, found=more, tell=tell)
    others = [s for s in others if not (best.members or _is_fitted(s, best, more))]
    if others and criteria.all_leave_gaps([*found, *more]) and policy.allows("second_rank"):
        more += fitted(estimator, others, best, criteria, found=more, tell=tell)
    if criteria.all_leave_gaps([*found, *more]):
        more += _multi_started(estimator, more)
    return more


def _multi_started(estimator: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Return the best model with several minima refitted from a better start, if there is one."""
    bouncing = [f for f in found if any(member.effect.multistart for member in f.members)]
    with suppress(*FIT_ERRORS):
        if bouncing and estimator.problem.policy.allows("gap_scan"):
            again = multi_start(min(bouncing, key=lambda f: f.cost), estimator)
            return [] if again is None else [again]
    return []


def sets(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit], size: int) -> list[Fit]:
    """Propose sets of two or three effects, unless `best` leaves nothing but a conflict."""
    return [] if state.criteria.adequate(best) else fit_sets(about, state, best, size)


def fit_sets(estimator: Estimator, state: SearchState, smaller: Fit, size: int) -> list[Fit]:
    """Return fits of the sets that explain most, of pairs also at low frequency where all leave a gap.

    Sets of three are fitted only if no extension of `smaller`, the best smaller set, explains as much.
    """
    criteria, start, probed = state.criteria, state.start, state.probed
    policy = criteria.policy
    shares = [s for s in screen_sets(estimator, probed, start, size) if s.share > policy.least_reduction]
    ahead = size == 2 or _exceeds_extensions(shares, smaller, policy.alike)
    most, wanted = policy.proposals // 2, one_variant(shares, 2 * policy.proposals) if ahead else []
    found = fitted(estimator, wanted, start, criteria, most, tell=state.tell)
    if size == 2 and criteria.all_leave_gaps(found) and policy.allows("low_pass"):
        slow = screen_sets(estimator, probed, start, size, slow_part(estimator.problem))
        wanted = one_variant(slow, 2 * policy.proposals)
        found += fitted(estimator, wanted, start, criteria, most, tell=state.tell)
    return found


def _is_fitted(share: Share, best: Fit, found: Sequence[Fit]) -> bool:
    """Return True if the best model with these effects added has been fitted."""
    return {*best.places, *share.places} in (set(f.places) for f in found)


def fitted(
    estimator: Estimator,
    wanted: Sequence[Share],
    best: Fit,
    criteria: Criteria,
    most: int | None = None,
    found: Sequence[Fit] = (),
    tell: Callable[[str], object] = silent,
) -> list[Fit]:
    """Return fits of the first that can be simulated, until one explains everything and the rest promise far
    less.

    A fit that does not come halfway to the best so far, those `found` included, is terminated early.
    """
    before, found = found, []
    for number, share in enumerate(wanted, 1):
        if len(found) == most or not allows("all proposals were fitted"):
            break
        done = any(criteria.explains(f) for f in found)
        if done and share.share < criteria.policy.faint * wanted[0].share:
            break
        tell(f"proposal {number} of {len(wanted)}")
        near = criteria.early_stop([*before, *found], best, criteria.policy.halfway)
        with suppress(*FIT_ERRORS):
            members = (*map(_with_typical_damping, best.members), *share.members)
            found.append(estimator.trial(members, best, near))
    return found


def one_variant(shares: Sequence[Share], most: int) -> list[Share]:
    """Return the best variant of each set of places, at most `most`."""
    found: dict[tuple[tuple[str, Place], ...], Share] = {}
    for share in shares:
        found.setdefault(tuple(sorted(m.place for m in share.members)), share)
    return list(found.values())[:most]


def _screened(
    estimator: Estimator, probed: Sequence[Probed], best: Fit, places: Mapping[str, str], at_ends: bool
) -> tuple[list[Share], list[Share]]:
    """Return single candidates: those that explain most, and others.

    Where the best promises little, the ends of priors are screened too if `at_ends`.
    """
    policy = estimator.problem.policy
    shares = one_variant(screen(estimator, probed, best, places), len(probed))
    sharp = rescreened_at_size(estimator, shares[: 2 * policy.proposals], best)
    at_ends = at_ends and (not sharp or sharp[0].share < policy.halfway)
    if at_ends and policy.allows("prior_ends"):
        ends = rescreened_at_size(estimator, _at_ends(estimator, probed, best), best)
        sharp = one_variant(sorted([*sharp, *ends], key=lambda share: -share.share), len(probed))
    wanted = sharp[: policy.proposals]
    there = {share.places for share in wanted}
    least = policy.negligible_share
    return wanted, [share for share in sharp if share.places not in there and share.share > least]


def _at_ends(estimator: Estimator, probed: Sequence[Probed], best: Fit) -> list[Share]:
    """Return effects of one parameter at the ends of their priors.

    To first order a damping or a mass explains little of a vibration that it puts out of phase.
    """
    found = []
    for candidate in (p.candidate for p in probed):
        if candidate.spots & best.spots or candidate.required_place or len(candidate.free) > 1:
            continue
        (name,) = candidate.free
        with suppress(*FIT_ERRORS):
            prior = candidate.priors_in(estimator.with_effects((candidate,)))[name]
            ends = [candidate.effect.with_parameters({name: value}) for value in (prior.low, prior.high)]
            found += [Share((replace(candidate, effect=effect),), 0.0) for effect in ends]
    return found


def _exceeds_extensions(shares: Sequence[Share], smaller: Fit, alike: float) -> bool:
    """Return True if the best set explains more than any extension of a smaller one."""
    reached = max(
        (s.share for s in shares if set(smaller.places) <= {m.place for m in s.members}), default=0.0
    )
    return bool(shares) and 1.0 - shares[0].share < (1 - alike) * (1.0 - reached)


def _with_typical_damping(member: Candidate) -> Candidate:
    """Return a spring with a typical damping, as its own may have compensated for the added effect."""
    if not isinstance(member.effect, SpringEffect) or "damping" not in member.free:
        return member
    damping = member.effect.typical_damping * member.effect.softest
    return replace(member, effect=member.effect.with_parameters({"damping": damping}))


def shapes(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose models with the effects of the best, one of them of a freer shape."""
    more: list[Fit] = []
    for k, member in enumerate(best.members):
        for shaped in member.reshaped():
            if not allows("all shapes of laws were fitted"):
                return more
            limit = state.criteria.early_stop([best, *more], state.null, state.criteria.policy.halfway)
            with suppress(*FIT_ERRORS):
                more.append(about.trial([*best.members[:k], shaped, *best.members[k + 1 :]], best, limit))
    return more


def twin_spring(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose laws at the joint of a spring, if the spring fits there as well as in the best model.

    Friction of a soft joint shows given that spring, not given a soft base in its place.
    """
    limit = (1 + state.criteria.policy.alike) * best.cost
    twins = [f for f in state.tried if f.cost < limit and _one_spring_apart(f, best)]
    if not twins or not state.criteria.leaves_gap(best):
        return []
    twin = min(twins, key=lambda f: f.cost)
    joints = newly_soft_joints(twin) - newly_soft_joints(best)
    laws = [p for p in state.with_new_springs(twin, about) if p.candidate.at in joints]
    laws = [p for p in laws if p.candidate.effect.acts_through_spring()]
    return fit_singles(about, laws, twin, state.criteria) if laws else []


def _one_spring_apart(one: Fit, other: Fit) -> bool:
    """Return True if two models differ by the place of one spring."""
    mine, theirs = (set(a.places) - set(b.places) for a, b in ((one, other), (other, one)))
    return len(mine) == len(theirs) == 1 and all(effect_class(name).is_spring for name, _ in mine | theirs)


def spring_swap(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose a model that leaves a gap with each of its springs elsewhere, as soft there."""
    if not state.criteria.leaves_gap(best):
        return []
    springs = {p.candidate.place: p.candidate for p in reversed(state.probed) if p.candidate.effect.is_spring}
    limit, swapped = (1 + state.criteria.policy.alike) * best.cost, []
    for k, spring in enumerate(best.members):
        others = tuple(m for i, m in enumerate(best.members) if i != k)
        for candidate in springs.values():
            if not spring.effect.is_spring or candidate.spots & best.spots or is_required(others, spring):
                continue
            with suppress(*FIT_ERRORS):
                swapped.append(about.trial((candidate.acting_as(spring) or candidate, *others), best, limit))
    return swapped
