"""State of a search, and candidates screened anew about a model that the search has reached.

Every move has one signature, `Move`: given the state, a model, the estimator about it and the larger models
that earlier moves of this step proposed, it returns more of them.

A motor turns a rigid joint whatever friction, play or cable acts there. Laws that act through the spring of a
joint are therefore inactive in a model without it (conditionally inactive). Once a rigid joint has a spring,
they are probed again about the model with it.

Effects that are found change what others do: a load's inertia acts otherwise on an arm with a soft joint.
Where more is to be explained, all candidates are linearised again about the fit: in small steps of smooth
laws, and at full size of waves, soft springs and non-smooth laws. Clocks, frames and points have the
derivatives with which they are eliminated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import isfinite

import numpy as np

from flexarm.arm import Arm
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import Candidate, nulls
from flexarm.diagnosis.candidates import vibrations
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.screening import LONGER, Probed, linear_response
from flexarm.errors import InvalidParameter
from flexarm.named_effects import Place


def newly_soft_joints(fit: Fit) -> frozenset[str]:
    """Return joints that are rigid in the nominal model and have a spring in a fit."""
    springs = (m for m in fit.members if m.effect.is_spring and m.effect.place == "joint")
    return frozenset(at for m in springs if m.without is None or m.without.inert for _, at in m.spots)


def probed_through_springs(estimator: Estimator, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """Return probes in which laws that act through new springs of a fit are simulated about its model."""
    joints = newly_soft_joints(fit)
    sleeping = [p for p in probed if p.candidate.effect.acts_through_spring() and p.candidate.at in joints]
    if not sleeping:
        return list(probed)
    coarse = replace(estimator, problem=estimator.problem.with_step(LONGER * estimator.problem.step))
    found = dict(zip(map(id, sleeping), probed_about(coarse, sleeping, fit), strict=True))
    return [found.get(id(each), each) for each in probed]


def probed_about(estimator: Estimator, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """Return candidates probed about a model; one that cannot be simulated there is unchanged."""
    problem, found = estimator.problem, list(probed)
    with suppress(*FIT_ERRORS):
        arm = estimator.with_effects(fit.members)
        models: dict[int, list[Arm]] = {}
        for k, each in enumerate(probed):
            with suppress(InvalidParameter):
                models[k] = [arm.with_effect(probe) for probe in each.candidate.probes]
        problem.prepare([arm, *(each for some in models.values() for each in some)])
        before = problem.residual(arm)
        for k, some in models.items():
            with suppress(*FIT_ERRORS):
                moves = np.stack([problem.residual(each) - before for each in some], axis=1)
                found[k] = replace(found[k], moves=moves)
    return found


def vibrations_about(estimator: Estimator, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """Return external vibrations of candidates at the frequencies of what a fit leaves, probed about it.

    About the nominal model a larger effect hides them.
    """
    problem, found = estimator.problem, []
    free = {each.candidate.place for each in probed} - fit.spots
    with suppress(*FIT_ERRORS):
        there = estimator.with_effects(fit.members)
        for candidate in vibrations(problem, estimator.nuisance.arm, fit.projected):
            if candidate.place in free:
                base = candidate.base(there)
                shaken = [base.with_effect(each) for each in candidate.probes]
                problem.prepare([base, *shaken])
                before = problem.residual(base)
                moves = np.stack([problem.residual(each) - before for each in shaken], axis=1)
                found.append(Probed(candidate, moves))
    return found


def rescreened(estimator: Estimator, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """Return the same candidates, probed about the model of a fit; unchanged where that cannot be simulated.

    A law that requires a spring which the fit lacks is unchanged, but for external vibrations, whose
    frequencies are those of the residual of the fit. Small steps of a spring are of one variant; softer ones
    are probed at full size.
    """
    coarse = replace(estimator, problem=estimator.problem.with_step(LONGER * estimator.problem.step))
    shaken = vibrations_about(coarse, probed, fit)
    moved = {each.candidate.place for each in shaken}
    probed = [each for each in probed if each.candidate.place not in moved]
    there = {None, *fit.spots}
    found: list[Probed] = []
    smooth: dict[int, Probed] = {}
    whole: list[int] = []
    for each in probed:
        candidate = each.candidate
        moves = linear_response(candidate, fit.nuisance.keys, fit.projection.jacobian)
        if moves is not None:
            each = replace(each, moves=moves)
        elif not candidate.spots & fit.spots and candidate.required_place in there:
            again = same_in_small_steps(candidate, [other.candidate for other in smooth.values()])
            small = candidate.effect.smooth and not candidate.effect.is_wave
            if again or candidate.needs is not None or not small:
                whole.append(len(found))
            else:
                smooth[len(found)] = each
        found.append(each)
    for k, each in zip(whole, probed_about(coarse, [found[k] for k in whole], fit), strict=True):
        found[k] = each
    with suppress(*FIT_ERRORS):  # the fit itself may fail in longer steps
        stepped = small_steps(estimator, [each.candidate for each in smooth.values()], fit)
        for k, steps in zip(smooth, stepped, strict=True):
            found[k] = steps or smooth[k]
    return [*found, *shaken]


def small_steps(estimator: Estimator, candidates: Sequence[Candidate], fit: Fit) -> Iterator[Probed | None]:
    """Yield derivatives with respect to the sizes of probes about a fit, in longer time steps; None if zero.

    Raise NotConverged or InvalidParameter if the fit itself cannot be simulated in such steps.
    """
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.with_effects(fit.members)
    own = [_from(each, there) for each in candidates]
    nudged = [_nudged(estimator, each, fit) for each in own]
    problem.prepare([there, *(arm for arms in nudged for arm in arms)])
    before = problem.residual(there)
    for candidate, arms in zip(own, nudged, strict=True):
        moves = np.empty((len(before), 0))
        with suppress(*FIT_ERRORS):
            moves = np.array([(problem.residual(arm) - before) / FIT.small_probe for arm in arms]).T
        yield Probed(candidate, moves) if moves.any() else None


def same_in_small_steps(candidate: Candidate, others: Sequence[Candidate]) -> bool:
    """Return True if a candidate equals another variant of it in small steps."""
    return candidate.effect.is_spring and candidate.place in {other.place for other in others}


def _nudged(estimator: Estimator, candidate: Candidate, fit: Fit) -> list[Arm]:
    """Return models with a small part of each probe of an effect; none if one is invalid."""
    arms = []
    for k in range(len(candidate.probes)):
        with suppress(*FIT_ERRORS):
            small = replace(candidate, effect=candidate.nudged(k, FIT.small_probe))
            arms.append(estimator.with_effects((*fit.members, small)))
    return arms if len(arms) == len(candidate.probes) else []


def _from(candidate: Candidate, there: Arm) -> Candidate:
    """Return a candidate with probes counted from the values of a model, if a fit has moved these.

    Otherwise a small step of a load's mass would include all that the fit has moved it.
    """
    without = there.effect(candidate.name, candidate.effect.at)
    null = nulls(candidate.effect, without, there)
    away = {key: value - candidate.null[key] for key, value in null.items() if isfinite(value)}
    if not any(away[key] for key in candidate.free if key in away):
        return candidate
    probes = [
        each.with_parameters({key: each.value_of(key) + away.get(key, 0.0) for key in candidate.free})
        for each in candidate.probes
    ]
    return replace(candidate, probes=tuple(probes), null=null, without=without)


def silent(*told: object) -> None:
    """Take what nobody reads."""


@dataclass(eq=False)
class SearchState:
    """State of a search."""

    probed: Sequence[Probed]
    """Candidates, screened about the nominal model."""
    start: Fit
    """The model without effects, clocks and frames at their nominal values: first effects start there."""
    null: Fit
    about_null: Estimator
    """The same about its own optimum, which larger models are compared with."""
    criteria: Criteria
    """Criteria of acceptance."""
    places: dict[str, str]
    """Pairs of joints that are one place of the machine."""
    tried: list[Fit] = field(default_factory=list)
    """All fits so far."""
    complete: Fit | None = None
    """A model to which no further effect was accepted."""
    tell: Callable[[str], object] = silent
    """Receives a sentence on the fit that is under way."""
    _with_springs: dict[frozenset[str], Sequence[Probed]] = field(default_factory=dict)
    _rescreened: dict[frozenset[tuple[str, Place]], Sequence[Probed]] = field(default_factory=dict)

    def candidates(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Return candidates given the effects of a fit, screened about it where more is to be explained."""
        criteria = self.criteria
        if not fit.members or criteria.adequate(fit) or not criteria.policy.allows("rescreening"):
            return self.with_new_springs(fit, about)
        places = frozenset(fit.places)
        if places not in self._rescreened:
            self._rescreened[places] = rescreened(about, self.probed, fit)
        return self._rescreened[places]

    def with_new_springs(self, fit: Fit, about: Estimator) -> Sequence[Probed]:
        """Return candidates with those that act through new springs of a fit screened about it."""
        joints = newly_soft_joints(fit)
        if not joints:
            return self.probed
        if joints not in self._with_springs:
            self._with_springs[joints] = probed_through_springs(about, self.probed, fit)
        return self._with_springs[joints]


Move = Callable[[SearchState, Fit, Estimator, Sequence[Fit]], list[Fit]]
"""A step of the search: state, model, estimator about it, larger models so far -> larger models."""
