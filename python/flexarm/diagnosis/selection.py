"""Which effects: one after the other while they explain something real, then every one against its rivals.

*Forward*: the most promising effects are fitted beside those that are there (`moves.proposals`), as probes
about their fit show it where that is not all (`nearby`), after those that do what unknowns are strained to do
(`takeover`), and the best of them (`ranking`) is taken if it is accepted (`acceptance`). Where one explains
too little, sets of two and three compete with what goes on from the best smaller one: sets are put in their
order to first order about the nominal model, which may be far from what one effect makes of it. After each
step derivatives are taken anew about the better model (`polish`). *Backward*: an effect that the others have
made needless is dropped, and what that leaves is gone on from once more. *Rivals*: every rival of every
effect that is left is fitted in its place (`rivals`); one that comes out ahead takes it, and may make others
needless in its turn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from flexarm.diagnosis.acceptance import (
    accepted,
    explained,
    far_off,
    hardly_helps,
    leaves_gap,
    quiet,
    worth_a_name,
)
from flexarm.diagnosis.alternatives import Rival, rivals_of, without
from flexarm.diagnosis.candidate import SPRINGS, carries
from flexarm.diagnosis.candidate_places import cardan_joints, causes, driven_joints
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import Channel, log_bayes_factor, variance_inflation
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.confounding import taken_over
from flexarm.diagnosis.moves.proposals import TWIN, larger_fits, other_springs
from flexarm.diagnosis.moves.rescreening import THROUGH_SPRINGS, awakened, nearby, new_springs
from flexarm.diagnosis.noise_model import allow_for_discretisation_error, allow_for_input_noise
from flexarm.diagnosis.ranking import best_of
from flexarm.diagnosis.refinement import about_or_here, settled, without_effects
from flexarm.diagnosis.screening import Probed

MOST = 3
"""Effects in one diagnosis."""
TWO = 2
"""Effects that must explain half of a gap for a third one to be looked for."""
AGAIN = 2
"""Times that the search goes forward and back."""
NEAR = 4.0
"""Mean square, over the noise, below which what noise of the drives and time steps do may be all of it."""
OVERTAKEN = 3
"""Times that a rival may take the place of what was chosen."""

Note = Callable[[str, float], object]


@dataclass(eq=False)
class Choice:
    """What was chosen.

    Attributes
    ----------
    null, best : Fit
        The nominal model and the chosen one; both with unknowns fitted.
    estimator : Estimator
        About the chosen model.
    value : dict
        Worth of the samples, T of `evidence`, after the chosen model.
    rivals : list of (list of Rival)
        For each effect of `best`, the best first.
    needed : list of float
        ln Z of the chosen model over itself without each of its effects.
    tried : list of (Fit, float)
        Every fit and its gain of ln Z over the nominal model.
    """

    null: Fit
    best: Fit
    estimator: Estimator
    value: Mapping[Channel, float]
    rivals: list[list[Rival]] = field(default_factory=list)
    needed: list[float] = field(default_factory=list)
    tried: list[tuple[Fit, float]] = field(default_factory=list)

    @property
    def gain(self) -> float:
        """ln Z of the chosen model over the nominal one."""
        problem = self.estimator.problem
        return log_bayes_factor(self.best, self.null, problem, self.value)


def choose(estimator: Estimator, probed: Sequence[Probed], note: Note | None = None) -> Choice:
    """Forward, backward, and rivals."""
    tell = note or (lambda what, done: None)
    search = _Search(estimator, probed)
    best, about = search.through(tell)
    tell("weighing rivals", MOST / (MOST + 1))
    choice = search.weighed(*settled(best, about))
    gains = [(f, log_bayes_factor(f, search.null, estimator.problem, choice.value)) for f in search.tried]
    return replace(choice, tried=gains)


class _Search:
    """What the steps of a search share: candidates, the model without effects, and all fits so far.

    That model is fitted twice: `start` with clocks and frames about their nominal values, where the first
    effects are looked for; `null` about its own optimum, with which larger models are compared.
    """

    def __init__(self, estimator: Estimator, probed: Sequence[Probed]) -> None:
        self.estimator, self.problem, self.probed = estimator, estimator.problem, probed
        self.start = estimator.fit(())
        self.null, self.about_null = without_effects(self.start, estimator)
        arm, records = self.problem.arm, self.problem.records.values()
        self.places = cardan_joints(arm, driven_joints(arm, records))
        self.tried: list[Fit] = []
        self.complete: Fit | None = None  # nothing beside it was accepted
        self._awake: dict[frozenset[str], Sequence[Probed]] = {frozenset(): probed}
        self._near: dict[frozenset[tuple[str, str]], Sequence[Probed]] = {}

    def through(self, tell: Note) -> tuple[Fit, Estimator]:
        """Forward and backward; forward once more where what is left after that is not all."""
        best, about = self.null, self.estimator
        for _ in range(AGAIN):
            larger, there = self.forward(best, about, tell)
            best, about = _backward(there, larger, self.null)
            if len(best.members) == len(larger.members) or self._explained(best):
                break
        return best, about

    def forward(self, best: Fit, about: Estimator, tell: Note) -> tuple[Fit, Estimator]:
        """The largest model of which each effect is accepted, and about which."""
        while (count := causes(best.members, self.places)) < self._most(best) and not self._explained(best):
            tell(f"looking for effect {count + 1}", count / (MOST + 1))
            larger = self._larger(best, about)
            if larger is None or not accepted(larger[0], best, self.null, self.problem):
                break
            best, about = larger
            if best is self.complete:
                break
        return best, about

    def _larger(self, best: Fit, about: Estimator) -> tuple[Fit, Estimator] | None:
        """The best model with an effect more; with two or three at first, if one explains too little.

        None if there is no candidate.
        """
        found = self._one_more(best, about)
        if not found:
            return None
        better, there = self._best_of(about, found, best)
        for size in (2, 3):
            if best.members or self._explained(better):
                break
            sets = self._sets(about, size, better)
            if len(better.members) == size - 1 < self._most(better) and worth_a_name(better, best):
                sets += self._one_more(better, there)
                self.complete = better
            if not sets:
                continue
            more, where = self._best_of(about, sets, better)
            if accepted(more, better, self.null, self.problem):
                better, there = more, where
        return better, there

    def _one_more(self, best: Fit, about: Estimator) -> list[Fit]:
        """Models with an effect more: what takes over where unknowns are strained, and what promises most.

        Only the former, if there is such, where nothing but that strain is left.
        """
        here, at = (best, about) if best.members else (self.null, self.about_null)
        probed = self._beside(best, about)
        found = taken_over(at, self.probed, here)  # whose sizes count from stated values
        if not (found and quiet(here, self.null, self.problem)):
            here = best if best.members else self.start
            found += larger_fits(about, probed, here, self.null, places=self.places, found=found)
            found += self._beside_a_twin(best, about)
        self.tried += found
        return found

    def _beside(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Candidates as they are beside the effects of a fit: where more is left to explain, about it."""
        if not fit.members or quiet(fit, self.null, self.problem):
            return self._awakened(fit, about)
        places = frozenset(fit.places)
        if places not in self._near:
            self._near[places] = nearby(about, self.probed, fit)
        return self._near[places]

    def _awakened(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Candidates, those awake that act through springs which a fit has and the nominal model has not."""
        joints = new_springs(fit)
        if joints not in self._awake:
            self._awake[joints] = awakened(about, self.probed, fit)
        return self._awake[joints]

    def _beside_a_twin(self, best: Fit, about: Estimator) -> list[Fit]:
        """An effect more in the joint of a spring that elsewhere leaves as little as in the best model.

        A base that gives way does what a soft shoulder does; friction there shows beside the latter.
        """
        twins = [f for f in self.tried if f.cost < TWIN * best.cost and _one_spring_apart(f, best)]
        if not twins or not leaves_gap(best, self.null, self.problem):
            return []
        twin = min(twins, key=lambda f: f.cost)
        joints = new_springs(twin) - new_springs(best)
        laws = [p for p in self._awakened(twin, about) if p.candidate.at in joints]
        laws = [p for p in laws if p.candidate.name in THROUGH_SPRINGS]
        return larger_fits(about, laws, twin, self.null) if laws else []

    def _sets(self, about: Estimator, size: int, beside: Fit) -> list[Fit]:
        """Models of two or three effects, unless what a smaller one leaves is a strained unknown alone."""
        if quiet(beside, self.null, self.problem):
            return []
        found = larger_fits(about, self.probed, self.start, self.null, size, beside=beside)
        self.tried += found
        return found

    def _best_of(self, estimator: Estimator, fits: Sequence[Fit], old: Fit) -> tuple[Fit, Estimator]:
        """The best of some, or if it leaves a gap the same with another spring of the machine soft."""
        best, about = best_of(estimator, fits, old, self.null)
        if leaves_gap(best, self.null, self.problem) and best.cost < NEAR * len(self.problem):
            arm = about.with_effects(best.members)
            allow_for_input_noise(self.problem, arm)
            allow_for_discretisation_error(self.problem, arm)
        if not leaves_gap(best, self.null, self.problem):
            return best, about
        found = other_springs(best, about, self.probed)
        self.tried += found
        nearer = [f for f in found if f.cost < best.cost]
        if not nearer:
            return best, about
        better, there = best_of(about, nearer, old, self.null)
        return (better, there) if better.cost < best.cost else (best, about)

    def _most(self, fit: Fit) -> int:
        """Effects in one diagnosis; no third one where two are far off, no second where one hardly helps."""
        count = causes(fit.members, self.places)
        if count == 1 and hardly_helps(fit, self.null):
            return 1
        return TWO if count == TWO and far_off(fit, self.null, self.problem) else MOST

    def _explained(self, fit: Fit) -> bool:
        return explained(fit, self.null, self.problem)

    def weighed(self, best: Fit, about: Estimator) -> Choice:
        """A model with the rivals of its effects, after those that are ahead have taken their places.

        None does so twice: of two that are equal each may be ahead of the other by a little.
        """
        choice, chosen = self._with_rivals(best, about), []
        for _ in range(OVERTAKEN):
            ahead = min((r for each in choice.rivals for r in each), key=lambda r: r.behind, default=None)
            if ahead is None or ahead.behind >= 0:
                break
            chosen.append(set(choice.best.places))
            if set(ahead.fit.places) in chosen:
                break
            self.tried.append(choice.best)  # which is the other's rival now
            fewer = _backward(about_or_here(ahead.fit, choice.estimator), ahead.fit, self.null)
            choice = self._with_rivals(*settled(*fewer))
        return choice

    def _with_rivals(self, best: Fit, about: Estimator) -> Choice:
        value = variance_inflation(best.projected, self.problem)
        rivals = [
            rivals_of(k, best, self.null, about, self._beside(best, about), self.tried, value)
            for k in range(len(best.members))
        ]
        needed = [self._needed(k, best, about, value) for k in range(len(best.members))]
        return Choice(self.null, best, about, value, rivals, needed)

    def _needed(self, k: int, best: Fit, about: Estimator, value: Mapping[Channel, float]) -> float:
        """ln Z of a model over itself without effect k; over that without all, if others stand on it."""
        others = tuple(m for i, m in enumerate(best.members) if i != k)
        alone = not others or carries(others, best.members[k])
        fewer = None if alone else without(others, about, self.tried)
        return log_bayes_factor(best, fewer or self.null, self.problem, value)


def _one_spring_apart(one: Fit, other: Fit) -> bool:
    """Whether two models differ by where one spring is."""
    mine, theirs = (set(a.places) - set(b.places) for a, b in ((one, other), (other, one)))
    return len(mine) == len(theirs) == 1 and all(name in SPRINGS for name, _ in mine | theirs)


def _backward(estimator: Estimator, best: Fit, null: Fit) -> tuple[Fit, Estimator]:
    """Drops what the others have made needless."""
    problem = estimator.problem
    k = 0
    while len(best.members) > 1 and k < len(best.members):
        rest = tuple(m for i, m in enumerate(best.members) if i != k)
        if carries(rest, best.members[k]):
            k += 1
            continue
        try:
            fewer = estimator.fit(rest, nearby=best)
        except FIT_ERRORS:
            k += 1
            continue
        if accepted(best, fewer, null, problem):
            k += 1
        else:
            best, estimator, k = fewer, about_or_here(fewer, estimator), 0
    return best, estimator
