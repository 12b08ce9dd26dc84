"""Moves of the search by name, in the order in which a step makes them, and two small ones.

A base that gives way moves an arm almost as a soft joint does: springs are tried elsewhere. A law of another
shape is still that law: before a second effect is sought, one more shape parameter of a found law is freed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

from flexarm.arm.effect import effect_class
from flexarm.budget import allows
from flexarm.diagnosis.candidate import is_required
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.confounding import confounding
from flexarm.diagnosis.moves.families import families
from flexarm.diagnosis.moves.proposals import fit_singles, pairs, singles, triples
from flexarm.diagnosis.moves.search_state import Move, SearchState, newly_soft_joints


def shapes(state: SearchState, best: Fit, about: Estimator, found: Sequence[Fit]) -> list[Fit]:
    """Propose models with the effects of the best, one of them of a freer shape."""
    more: list[Fit] = []
    for k, member in enumerate(best.members):
        for shaped in member.reshaped():
            if not allows("all shapes of laws were fitted"):
                return more
            limit = state.criteria.early_stop([best, *more], state.null, state.criteria.policy.halfway)
            try:
                more.append(about.trial([*best.members[:k], shaped, *best.members[k + 1 :]], best, limit))
            except FIT_ERRORS:
                continue
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


FORWARD: Mapping[str, Move] = {
    "singles": singles,
    "families": families,
    "twin_spring": twin_spring,
    "confounding": confounding,
}
"""They add an effect."""
CONFLICT: Mapping[str, Move] = {
    "confounding": confounding,
    "singles": singles,
    "families": families,
    "twin_spring": twin_spring,
}
"""The same where nothing but a conflict with priors is left."""
SETS: Mapping[str, Move] = {"pairs": pairs, "triples": triples}
"""They compete with a single effect, which is the model that they get."""
ELSEWHERE: Mapping[str, Move] = {"spring_swap": spring_swap}
"""They change the best model."""
SHAPES: Mapping[str, Move] = {"shapes": shapes}
"""They free the shape of one of its laws."""
