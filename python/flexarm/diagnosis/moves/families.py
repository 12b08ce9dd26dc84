"""Families: one effect at all places of a kind, proposed as one cause.

With D_i the response to the probe of an effect at place i, a shared size alpha has the response sum_i D_i
alpha; errors that may have either sign have an alpha each. A family is screened and fitted as a single
candidate is (`diagnosis.screening`), from the same probes. Where the model has the effect at some places
already, the family takes their place.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress

import numpy as np

from flexarm.arm import Arm
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import log_bayes_factor
from flexarm.diagnosis.family import EffectFamily, clear_places, family_of, with_spreads
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.proposals import fitted, one_variant
from flexarm.diagnosis.moves.search_state import SearchState
from flexarm.diagnosis.refinement import estimator_about
from flexarm.diagnosis.screening import Probed, rescreened_at_size, screen


def families(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose the most promising families, unless a single effect explains everything."""
    criteria, policy = state.criteria, state.criteria.policy
    if any(criteria.explains(fit) for fit in found):
        return []
    probed = probed_families(about, state.candidates(best, about))
    here = best if best.members else state.start
    shares = one_variant(screen(about, probed, here), policy.proposals)
    wanted = rescreened_at_size(about, shares, here)[: policy.proposals // 2]
    more = fitted(about, wanted, here, criteria, found=found, tell=state.tell)
    return more + _in_place_of_singles(
        about, probed, best, criteria.early_stop([best, *found, *more], state.null, policy.halfway)
    )


def without_idle_places(criteria: Criteria, best: Fit, about: Estimator) -> tuple[Fit, Estimator]:
    """Return a model without places of families that make it less probable.

    If the data determine too few places of a family, these become single effects, if the model is then more
    probable by as much for each place removed.
    """
    found = best
    for spots in [m.spots for m in best.members if isinstance(m, EffectFamily)]:
        [family] = [m for m in found.members if m.spots == spots]  # each fit replaces its members
        assert isinstance(family, EffectFamily)
        found = _thinned(criteria, found, family, about)
    return found, about if found is best else estimator_about(found, about)


def _thinned(criteria: Criteria, whole: Fit, family: EffectFamily, about: Estimator) -> Fit:
    rest, policy = tuple(m for m in whole.members if m is not family), criteria.policy
    clear, best, left = clear_places(whole, family, policy.strong_evidence), whole, family
    for at in (m.effect.at for m in family.members if m.effect.at not in clear):
        fewer = _fitted(about, (*rest, left.without_place(at)), best) if len(left.members) > 1 else None
        if fewer is not None and log_bayes_factor(fewer, best, criteria.problem) > policy.family_leave:
            best = fewer
            [left] = [m for m in best.members if isinstance(m, EffectFamily) and m.spots < family.spots]
    sure = [m for m in left.members if m.effect.at in clear]
    if len(sure) < EffectFamily.least_places:
        few = len(left.members) < EffectFamily.least_places
        singles = _fitted(about, (*rest, *(left.members if few else sure)), best)
        least = policy.family_leave * (len(family.members) - len(sure))
        if singles and (few or log_bayes_factor(singles, whole, criteria.problem) > least):
            return singles
    return best


def _fitted(about: Estimator, members: tuple[Candidate, ...], nearby: Fit) -> Fit | None:
    try:
        return with_spreads(about.fit(members, nearby=nearby))
    except FIT_ERRORS:
        return None


def probed_families(estimator: Estimator, probed: Sequence[Probed]) -> list[Probed]:
    """Return the families of single candidates, one a variant, and what their probes move."""
    policy, found = estimator.problem.policy, []
    for alike in _alike(probed, estimator.arm):
        family = family_of([p.candidate for p in alike], estimator.arm, policy)
        if len(alike) >= EffectFamily.least_places and family is not None:
            moves = [p.moves for p in alike]
            found.append(Probed(family, np.sum(moves, axis=0) if family.shared else np.hstack(moves)))
    return found


def _alike(probed: Iterable[Probed], arm: Arm) -> list[list[Probed]]:
    """Return candidates that are the same but for their places, if neither model nor records state them."""
    found: dict[tuple[object, ...], list[Probed]] = {}
    for each in probed:
        candidate = each.candidate
        stated = candidate.without is not None and not candidate.without.inert
        if candidate.effect.forms_families() and not stated and candidate.needs is None:
            sizes = tuple(candidate.effect.parameters())
            units = tuple(prior.unit for prior in candidate.priors_in(arm).values())
            found.setdefault((candidate.name, sizes, candidate.free, units), []).append(each)
    return list(found.values())


def _in_place_of_singles(about: Estimator, probed: Sequence[Probed], best: Fit, limit: float) -> list[Fit]:
    """Return fits of families that take the place of the same effect at some of their places."""
    found: list[Fit] = []
    for family in {p.candidate.name: p.candidate for p in reversed(probed)}.values():
        there = [m for m in best.members if m.spots < family.spots]
        if any(isinstance(m, EffectFamily) for m in there):  # places were removed from it
            continue
        if not there or not isinstance(family, EffectFamily) or not family.shared:
            continue
        sized = {name: there[0].value_of(name) for name in family.free}
        others = [m for m in best.members if m not in there]
        with suppress(*FIT_ERRORS):
            found.append(about.trial((family.with_parameters(sized), *others), best, limit))
    return found
