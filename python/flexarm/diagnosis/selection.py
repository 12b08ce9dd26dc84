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

from flexarm.arm.effect import effect_class
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.alternatives import Rival, rivals_of, without
from flexarm.diagnosis.candidate import carries
from flexarm.diagnosis.candidate_places import cardan_joints, causes, driven_joints
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import Channel, log_bayes_factor, variance_inflation
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.confounding import taken_over
from flexarm.diagnosis.moves.proposals import larger_fits, other_springs
from flexarm.diagnosis.moves.rescreening import awakened, nearby, new_springs
from flexarm.diagnosis.noise_model import allow_for_discretisation_error, allow_for_input_noise
from flexarm.diagnosis.ranking import best_of
from flexarm.diagnosis.refinement import about_or_here, settled, without_effects
from flexarm.diagnosis.screening import Probed

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
    most = search.policy.most_effects
    tell("weighing rivals", most / (most + 1))
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
        self.criteria, self.policy = Criteria(self.problem, self.null), self.problem.policy
        arm, records = self.problem.arm, self.problem.records.values()
        self.places = cardan_joints(arm, driven_joints(arm, records))
        self.tried: list[Fit] = []
        self.complete: Fit | None = None  # nothing beside it was accepted
        self._awake: dict[frozenset[str], Sequence[Probed]] = {frozenset(): probed}
        self._near: dict[frozenset[tuple[str, str]], Sequence[Probed]] = {}

    def through(self, tell: Note) -> tuple[Fit, Estimator]:
        """Forward and backward; forward once more where what is left after that is not all."""
        best, about = self.null, self.estimator
        for _ in range(self.policy.rounds):
            larger, there = self.forward(best, about, tell)
            best, about = _backward(there, larger, self.criteria)
            if len(best.members) == len(larger.members) or self.criteria.explains(best):
                break
        return best, about

    def forward(self, best: Fit, about: Estimator, tell: Note) -> tuple[Fit, Estimator]:
        """The largest model of which each effect is accepted, and about which."""
        while (count := causes(best.members, self.places)) < self._most(best) and not self.criteria.explains(
            best
        ):
            tell(f"looking for effect {count + 1}", count / (self.policy.most_effects + 1))
            larger = self._larger(best, about)
            if larger is None or not self.criteria.accepts(larger[0], best):
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
        for size, move in ((2, "pairs"), (3, "triples")):
            if not self.policy.allows(move) or best.members or self.criteria.explains(better):
                break
            sets = self._sets(about, size, better)
            if len(better.members) == size - 1 < self._most(better) and self.criteria.reduces(better, best):
                sets += self._one_more(better, there)
                self.complete = better
            if not sets:
                continue
            more, where = self._best_of(about, sets, better)
            if self.criteria.accepts(more, better):
                better, there = more, where
        return better, there

    def _one_more(self, best: Fit, about: Estimator) -> list[Fit]:
        """Models with an effect more: what takes over where unknowns are strained, and what promises most.

        Only the former, if there is such, where nothing but that strain is left.
        """
        here, at = (best, about) if best.members else (self.null, self.about_null)
        probed = self._beside(best, about)
        found = []
        if self.policy.allows("confounding"):
            found = taken_over(at, self.probed, here)  # whose sizes count from stated values
        if not (found and self.criteria.adequate(here)):
            here = best if best.members else self.start
            found += larger_fits(about, probed, here, self.criteria, places=self.places, found=found)
            if self.policy.allows("twin_spring"):
                found += self._beside_a_twin(best, about)
        self.tried += found
        return found

    def _beside(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Candidates as they are beside the effects of a fit: where more is left to explain, about it."""
        if not fit.members or self.criteria.adequate(fit) or not self.policy.allows("rescreening"):
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
        limit = (1 + self.policy.alike) * best.cost
        twins = [f for f in self.tried if f.cost < limit and _one_spring_apart(f, best)]
        if not twins or not self.criteria.leaves_gap(best):
            return []
        twin = min(twins, key=lambda f: f.cost)
        joints = new_springs(twin) - new_springs(best)
        laws = [p for p in self._awakened(twin, about) if p.candidate.at in joints]
        laws = [p for p in laws if p.candidate.effect.acts_through_spring()]
        return larger_fits(about, laws, twin, self.criteria) if laws else []

    def _sets(self, about: Estimator, size: int, beside: Fit) -> list[Fit]:
        """Models of two or three effects, unless what a smaller one leaves is a strained unknown alone."""
        if self.criteria.adequate(beside):
            return []
        found = larger_fits(about, self.probed, self.start, self.criteria, size, beside=beside)
        self.tried += found
        return found

    def _best_of(self, estimator: Estimator, fits: Sequence[Fit], old: Fit) -> tuple[Fit, Estimator]:
        """The best of some, or if it leaves a gap the same with another spring of the machine soft."""
        best, about = best_of(estimator, fits, old, self.criteria)
        near = self.policy.allows("model_errors") and best.cost < self.policy.model_errors * len(self.problem)
        if near and self.criteria.leaves_gap(best):
            arm = about.with_effects(best.members)
            allow_for_input_noise(self.problem, arm)
            allow_for_discretisation_error(self.problem, arm)
        if not self.criteria.leaves_gap(best) or not self.policy.allows("spring_swap"):
            return best, about
        found = other_springs(best, about, self.probed)
        self.tried += found
        nearer = [f for f in found if f.cost < best.cost]
        if not nearer:
            return best, about
        better, there = best_of(about, nearer, old, self.criteria)
        return (better, there) if better.cost < best.cost else (best, about)

    def _most(self, fit: Fit) -> int:
        """Effects in one diagnosis; no third one where two are far off, no second where one hardly helps."""
        count = causes(fit.members, self.places)
        if count == 1 and self.criteria.hardly_helps(fit):
            return 1
        most = self.policy.most_effects
        return min(2, most) if count == 2 and self.criteria.leaves_most(fit) else most

    def weighed(self, best: Fit, about: Estimator) -> Choice:
        """A model with the rivals of its effects, after those that are ahead have taken their places.

        None does so twice: of two that are equal each may be ahead of the other by a little.
        """
        choice, chosen = self._with_rivals(best, about), []
        for _ in range(self.policy.most_effects if self.policy.allows("swap") else 0):
            ahead = min((r for each in choice.rivals for r in each), key=lambda r: r.behind, default=None)
            if ahead is None or ahead.behind >= 0:
                break
            chosen.append(set(choice.best.places))
            if set(ahead.fit.places) in chosen:
                break
            self.tried.append(choice.best)  # which is the other's rival now
            fewer = _backward(about_or_here(ahead.fit, choice.estimator), ahead.fit, self.criteria)
            choice = self._with_rivals(*settled(*fewer))
        return choice

    def _with_rivals(self, best: Fit, about: Estimator) -> Choice:
        value = variance_inflation(best.projected, self.problem)
        rivals = [
            rivals_of(k, best, self.criteria, about, self._beside(best, about), self.tried, value)
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
    return len(mine) == len(theirs) == 1 and all(effect_class(name).is_spring for name, _ in mine | theirs)


def _backward(estimator: Estimator, best: Fit, criteria: Criteria) -> tuple[Fit, Estimator]:
    """Drops what the others have made needless."""
    k = 0 if criteria.policy.allows("backward") else len(best.members)
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
        if criteria.accepts(best, fewer):
            k += 1
        else:
            best, estimator, k = fewer, about_or_here(fewer, estimator), 0
    return best, estimator
