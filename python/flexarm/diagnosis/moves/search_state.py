"""State of a search: candidates, the model without effects, and all fits so far.

Every move has one signature, `Move`: given the state, a model, the estimator about it and the larger models
that moves before it proposed in this step, it returns more of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.moves.rescreening import awakened, nearby, new_springs
from flexarm.diagnosis.screening import Probed
from flexarm.named_effects import Place


@dataclass(eq=False)
class SearchState:
    """State of a search.

    Attributes
    ----------
    probed : sequence of Probed
        Candidates, screened about the nominal model.
    start : Fit
        The model without effects, clocks and frames at their nominal values: first effects start there.
    null, about_null : Fit and Estimator
        The same about its own optimum, which larger models are compared with.
    criteria : Criteria
        What is accepted.
    places : dict of str to str
        Joints that are one place of the machine.
    tried : list of Fit
        All fits so far.
    complete : Fit or None
        A model beside which nothing was accepted.
    """

    probed: Sequence[Probed]
    start: Fit
    null: Fit
    about_null: Estimator
    criteria: Criteria
    places: dict[str, str]
    tried: list[Fit] = field(default_factory=list)
    complete: Fit | None = None
    _awake: dict[frozenset[str], Sequence[Probed]] = field(default_factory=dict)
    _near: dict[frozenset[tuple[str, Place]], Sequence[Probed]] = field(default_factory=dict)

    def candidates(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Return candidates given the effects of a fit, screened about it where more is to be explained."""
        criteria = self.criteria
        if not fit.members or criteria.adequate(fit) or not criteria.policy.allows("rescreening"):
            return self.awake(fit, about)
        places = frozenset(fit.places)
        if places not in self._near:
            self._near[places] = nearby(about, self.probed, fit)
        return self._near[places]

    def awake(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Return candidates with those that act through new springs of a fit screened about it."""
        joints = new_springs(fit)
        if not joints:
            return self.probed
        if joints not in self._awake:
            self._awake[joints] = awakened(about, self.probed, fit)
        return self._awake[joints]


Move = Callable[[SearchState, Fit, Estimator, Sequence[Fit]], list[Fit]]
"""A step of the search: state, model, estimator about it, larger models so far -> larger models."""
