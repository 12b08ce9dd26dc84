"""Laws of another shape: where a named law leaves a gap, parameters of its shape are freed.

A law of another shape is still that law. Before a second effect is sought beside it, models compete in which
one more part of the shape of one effect is fitted, each from the starts that the effect states.
"""

from __future__ import annotations

from collections.abc import Sequence

from flexarm.budget import allows
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.search_state import SearchState


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
