"""Moves between springs: a base that gives way moves an arm almost as a soft joint does."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from flexarm.arm.effect import effect_class
from flexarm.diagnosis.candidate import carries
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.proposals import fit_singles
from flexarm.diagnosis.moves.rescreening import new_springs
from flexarm.diagnosis.moves.search_state import SearchState


def twin_spring(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose laws in the joint of a spring that elsewhere fits as well as in the best model.

    Friction of a soft joint shows given that spring, not given a base that gives way in its place.
    """
    limit = (1 + state.criteria.policy.alike) * best.cost
    twins = [f for f in state.tried if f.cost < limit and _one_spring_apart(f, best)]
    if not twins or not state.criteria.leaves_gap(best):
        return []
    twin = min(twins, key=lambda f: f.cost)
    joints = new_springs(twin) - new_springs(best)
    laws = [p for p in state.awake(twin, about) if p.candidate.at in joints]
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
            if not spring.effect.is_spring or candidate.spots & best.spots or carries(others, spring):
                continue
            with suppress(*FIT_ERRORS):
                swapped.append(about.trial((candidate.acting_as(spring) or candidate, *others), best, limit))
    return swapped
