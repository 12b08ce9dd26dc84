"""Selection of effects: forward, backward, refine, swap.

*Forward*: the moves of `FORWARD` propose larger models; the best of them is taken if it is accepted
(`acceptance`). Where one effect explains too little, sets of two and three compete with it and with its own
extensions, since screening about the nominal model may order them wrongly. *Backward*: an effect that the
others made needless is dropped, and the search goes forward once more. *Refine*: all values move together to
the optimum (`refinement`). *Swap*: alternatives of each effect are fitted in its place (`alternatives`); one
that comes out ahead takes it, and may make others needless.

**Ranking.** Larger models are compared pairwise by evidence: compared with the smaller model all of them
differ by the whole gap, and the error of the simulation (eq. (3) of `evidence`) would hide their differences.
Where all leave gaps, evidence rests on the size and correlation of an unknown remainder. It then decides only
among models that predict left-out data about as well as the best one, by eq. (2) of `cross_validation`, and
are as plausible, by eq. (6) of `acceptance`. A model that leaves a gap and removes too little of it ranks
behind. When the time is over, evidence alone decides: unfinished fits predict badly and pull nuisance
parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cmp_to_key, partial

import numpy as np

from flexarm.budget import allows, current, until
from flexarm.diagnosis.acceptance import Criteria, implausibility
from flexarm.diagnosis.alternatives import AlternativeModel, alternatives_of, without
from flexarm.diagnosis.candidate import is_required
from flexarm.diagnosis.candidates import cardan_joints, driven_joints, effect_count
from flexarm.diagnosis.cross_validation import log_odds_lost, press_rms
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.evidence import explained_share, log_bayes_factor
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.moves.confounding import confounding
from flexarm.diagnosis.moves.families import families, without_idle_places
from flexarm.diagnosis.moves.proposals import sets, shapes, singles, spring_swap, twin_spring
from flexarm.diagnosis.moves.search_state import Move, SearchState, silent
from flexarm.diagnosis.noise_model import allow_for_discretisation_error, allow_for_input_noise
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.refinement import (
    converged,
    estimator_about,
    fitted_null,
    refined_while_better,
    relinearised,
)
from flexarm.diagnosis.screening import Probed

FORWARD: Mapping[str, Move] = {
    "singles": singles,
    "families": families,
    "twin_spring": twin_spring,
    "confounding": confounding,
}
"""They add an effect."""
CONFLICT: Mapping[str, Move] = {"confounding": confounding, **FORWARD}
"""The same where nothing but a conflict with priors is left."""
SETS: Mapping[str, Move] = {"pairs": partial(sets, size=2), "triples": partial(sets, size=3)}
"""They compete with a single effect, which is the model that they get."""
ELSEWHERE: Mapping[str, Move] = {"spring_swap": spring_swap}
"""They change the best model."""
SHAPES: Mapping[str, Move] = {"shapes": shapes}
"""They free the shape of one of its laws."""


def best_of(estimator: Estimator, fits: Sequence[Fit], old: Fit, criteria: Criteria) -> tuple[Fit, Estimator]:
    """Return the best fit, refined, after the closest fits or the best predictors were relinearised."""
    problem = criteria.problem
    first, *others = _ranked(fits, old, criteria)
    if criteria.leaves_gap(first):
        limit = criteria.early_stop([first], criteria.null, criteria.policy.halfway / 2)
        near = [f for f in others if f.cost < limit]
        near = sorted(near, key=lambda f: press_rms(f, problem))
        close: list[Fit] = []
        for fit in near:  # pins at both ends of a cylinder give way alike
            if len(close) < 2 and not any(_alike(fit, other, criteria) for other in (first, *close)):
                close.append(fit)
    else:
        reach = criteria.policy.close
        close = [f for f in others[:2] if log_bayes_factor(first, f, problem) < reach]
    there = dict(relinearised(fit, estimator) for fit in (first, *close))
    if not criteria.leaves_gap(first):
        there |= dict(_in_steps(fit, estimator) for fit in _unsettled(others, first, criteria))
    best = _ranked(list(there), old, criteria)[0]
    return refined_while_better(best, there[best])


def _alike(one: Fit, other: Fit, criteria: Criteria) -> bool:
    """Return True if two models leave the same residual."""
    n = len(criteria.problem)  # the rest are pulls of nuisance parameters
    left = other.projected[:n]
    return bool(np.linalg.norm(one.projected[:n] - left) < criteria.policy.alike * np.linalg.norm(left))


def _ranked(fits: Sequence[Fit], old: Fit, criteria: Criteria) -> list[Fit]:
    """Return the best first, of those that reduce the gap enough if there are any."""
    problem, reach = criteria.problem, criteria.policy.reach
    fits = [f for f in fits if criteria.reduces(f, old) or not criteria.leaves_gap(f)] or fits

    def behind(one: Fit, other: Fit) -> int:
        return int(np.sign(log_bayes_factor(other, one, problem)))

    if current().spent or not criteria.all_leave_gaps(fits):
        return sorted(fits, key=cmp_to_key(behind))
    odd = [implausibility(f) for f in fits]
    less = [lost + u - min(odd) for lost, u in zip(log_odds_lost(fits, problem), odd, strict=True)]
    lost = dict(zip(fits, (each - min(less) for each in less), strict=True))
    near = [f for f in fits if lost[f] < reach]
    others = [f for f in fits if lost[f] >= reach]
    return sorted(near, key=cmp_to_key(behind)) + sorted(others, key=lambda f: lost[f])


def _unsettled(others: Sequence[Fit], first: Fit, criteria: Criteria) -> list[Fit]:
    """Return fits in prior-data conflict that explain half of what the first one does.

    Their derivatives change most when they are relinearised.
    """
    half = (criteria.null.cost + first.cost) / 2
    found = [f for f in others if f.cost < half and criteria.in_conflict(f)]
    return sorted(found, key=lambda f: f.cost)[: criteria.policy.more_proposals]


def _in_steps(fit: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a fit relinearised about itself while its cost falls clearly."""
    for _ in range(FIT.relinearised):
        before, (fit, estimator) = fit, relinearised(fit, estimator)
        if fit.cost > FIT.better_share * before.cost:
            break
    return fit, estimator


Note = Callable[[str, float], object]


SEARCHED, WEIGHED = 0.75, 0.9
"""Parts of a budget of time at which the search for effects, and the fits of their alternatives, end."""


@dataclass(eq=False)
class Choice:
    """The selected model and its alternatives."""

    null: Fit
    best: Fit
    """The model without effects and the chosen one; both with nuisance parameters fitted."""
    estimator: Estimator
    """About the chosen model."""
    alternatives: list[list[AlternativeModel]] = field(default_factory=list)
    """For each effect of `best`, the best first."""
    needed: list[float] = field(default_factory=list)
    """ln B of the chosen model over itself without each of its effects."""
    shares: list[float] = field(default_factory=list)
    """Part of the gap where each effect acts that it explains (`evidence.explained_share`)."""
    tried: list[Fit] = field(default_factory=list)
    """Every fit."""


def choose(estimator: Estimator, probed: Sequence[Probed], note: Note | None = None) -> Choice:
    """Select effects: forward and backward, refine, swap."""
    tell = note or silent
    problem, start = estimator.problem, estimator.fit(())
    null, about_null = fitted_null(start, estimator)
    places = cardan_joints(problem.arm, driven_joints(problem.arm, problem.records.values()))
    state = SearchState(probed, start, null, about_null, Criteria(problem, null), places)
    with until(SEARCHED):
        best, about = forward_and_backward(state, estimator, tell)
    most = problem.policy.most_effects
    tell("refining", most / (most + 1))
    with until(WEIGHED):
        choice = swap(
            state, *converged(best, about), lambda what, done: tell(what, (most + done) / (most + 1))
        )
    return replace(choice, tried=list(state.tried))


def forward_and_backward(state: SearchState, about: Estimator, tell: Note) -> tuple[Fit, Estimator]:
    """Return the model to which effects were added and needless ones dropped, and the estimator about it."""
    best = state.null
    for _ in range(state.criteria.policy.most_effects):
        larger, there = forward(state, best, about, tell)
        best, about = backward(state.criteria, larger, there)
        best, about = without_idle_places(state.criteria, best, about)
        if len(best.members) == len(larger.members) or state.criteria.explains(best):
            break
    return best, about


def forward(state: SearchState, best: Fit, about: Estimator, tell: Note) -> tuple[Fit, Estimator]:
    """Return the largest model of which each effect is accepted, and the estimator about it."""
    while not state.criteria.explains(best):
        count = effect_count(best.members, state.places)
        if count >= most_effects(state, best) or not allows(f"effect {count + 1} was looked for"):
            break
        sought, share = f"looking for effect {count + 1}", count / (state.criteria.policy.most_effects + 1)
        tell(sought, share)
        state.tell = _details(tell, sought, share)
        larger = enlarged(state, best, about)
        if larger is None or not accepted(state.criteria, larger[0], best):
            break
        best, about = reshaped(state, *larger)
        if best is state.complete:
            break
    return best, about


def _details(tell: Note, sought: str, share: float) -> Callable[[str], object]:
    """Return a function that tells the fit that is under way."""
    return lambda what: tell(f"{sought}, {what}", share)


def reshaped(state: SearchState, best: Fit, about: Estimator) -> tuple[Fit, Estimator]:
    """Return a model with freer shapes of its laws, if these are accepted, before more effects."""
    criteria = state.criteria
    while not criteria.explains(best):
        found = proposed(state, SHAPES, best, about)
        better, there = best_of(about, found, best, criteria) if found else (best, about)
        if not found or not accepted(criteria, better, best):
            break
        best, about = better, there
    return best, about


def most_effects(state: SearchState, fit: Fit) -> int:
    """Return the most effects to look for: two if they leave most of the gap, one if it explains little."""
    count, most = effect_count(fit.members, state.places), state.criteria.policy.most_effects
    if count == 1 and state.criteria.hardly_helps(fit):
        return 1
    return min(2, most) if count == 2 and state.criteria.leaves_most(fit) else most


def enlarged(state: SearchState, best: Fit, about: Estimator) -> tuple[Fit, Estimator] | None:
    """Return the best model with an effect more, at first with two or three if one explains too little.

    A freer shape of the first effect's law competes before a second effect does. None if there is no
    candidate.
    """
    criteria = state.criteria
    moves = CONFLICT if criteria.adequate(best if best.members else state.null) else FORWARD
    found = proposed(state, moves, best, about)
    if not found:
        return None
    better, there = best_proposed(state, about, found, best)
    if not best.members and criteria.reduces(better, best):
        better, there = reshaped(state, better, there)
    for size, (name, move) in enumerate(SETS.items(), start=2):
        if best.members or criteria.explains(better):
            break
        sets = proposed(state, {name: move}, better, about)
        if len(better.members) == size - 1 < most_effects(state, better) and criteria.reduces(better, best):
            sets += proposed(state, FORWARD, better, there)
            state.complete = better
        if not sets:
            continue
        more, where = best_proposed(state, about, sets, better)
        if accepted(criteria, more, better):
            better, there = more, where
    return better, there


def accepted(criteria: Criteria, new: Fit, old: Fit) -> bool:
    """Return True if a model is accepted in the place of another one.

    When the time is over fits are unfinished, and only more evidence counts.
    """
    if not criteria.accepts(new, old):
        return False
    return not current().spent or log_bayes_factor(new, old, criteria.problem) > 0


def proposed(state: SearchState, moves: Mapping[str, Move], best: Fit, about: Estimator) -> list[Fit]:
    """Return the models that moves propose, those that the policy allows."""
    found: list[Fit] = []
    for name, move in moves.items():
        if not allows("all moves of the search were made"):
            break
        if name == "singles" or state.criteria.policy.allows(name):
            found += move(state, best, about, found)
    state.tried += found
    return found


def best_proposed(
    state: SearchState, about: Estimator, fits: Sequence[Fit], old: Fit
) -> tuple[Fit, Estimator]:
    """Return the best of some models, or with one of its springs elsewhere where that is better."""
    criteria, problem = state.criteria, state.criteria.problem
    best, about = best_of(about, fits, old, criteria)
    near = best.cost < criteria.policy.model_errors * problem.expected_cost(best.non_smooth)
    if near and criteria.leaves_gap(best) and criteria.policy.allows("model_errors"):
        arm = about.with_effects(best.members)
        allow_for_input_noise(problem, arm)
        allow_for_discretisation_error(problem, arm)
    nearer = [f for f in proposed(state, ELSEWHERE, best, about) if f.cost < best.cost]
    if not nearer:
        return best, about
    better, there = best_of(about, nearer, old, criteria)
    return (better, there) if better.cost < best.cost else (best, about)


def backward(criteria: Criteria, best: Fit, estimator: Estimator) -> tuple[Fit, Estimator]:
    """Return a model without the effects that the others made needless."""
    k = 0
    while len(best.members) > 1 and k < len(best.members):
        rest, fewer = tuple(m for i, m in enumerate(best.members) if i != k), None
        if not is_required(rest, best.members[k]):
            with suppress(*FIT_ERRORS):
                fewer = estimator.fit(rest, nearby=best)
        if fewer is None or criteria.accepts(best, fewer):
            k += 1
        elif not criteria.policy.allows("backward"):
            break
        else:
            best, estimator, k = fewer, estimator_about(fewer, estimator), 0
    return best, estimator


def swap(state: SearchState, best: Fit, about: Estimator, tell: Note = silent) -> Choice:
    """Return a model with its alternatives, after those that are ahead have replaced its effects.

    No model is chosen twice: of two that are equal each may be ahead by a little.
    """
    choice, chosen, policy = with_alternatives(state, best, about, tell), [], state.criteria.policy
    for _ in range(policy.most_effects):
        ahead = min((r for each in choice.alternatives for r in each), key=lambda r: r.behind, default=None)
        if ahead is None or ahead.behind >= 0 or not policy.allows("swap"):
            break
        chosen.append(set(choice.best.places))
        if set(ahead.fit.places) in chosen:
            break
        state.tried.append(choice.best)  # now an alternative of the other one
        fewer = backward(state.criteria, ahead.fit, estimator_about(ahead.fit, choice.estimator))
        choice = with_alternatives(state, *converged(*fewer), tell)
    return choice


def with_alternatives(state: SearchState, best: Fit, about: Estimator, tell: Note = silent) -> Choice:
    """Return a model with the alternatives of its effects and the evidence for each effect."""
    criteria = state.criteria
    alternatives, needed, shares = [], [], []
    for k, member in enumerate(best.members):
        probed = state.candidates(best, about)
        alternatives.append(alternatives_of(k, best, criteria, about, probed, state.tried, tell))
        others = tuple(m for i, m in enumerate(best.members) if i != k)
        alone = not others or is_required(others, member)
        fewer = None if alone else without(others, about, state.tried)
        needed.append(log_bayes_factor(best, fewer or state.null, criteria.problem))
        shares.append(explained_share(best, fewer or state.null, criteria.problem))
    return Choice(state.null, best, about, alternatives, needed, shares)
