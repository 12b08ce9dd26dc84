"""Laws that act through a joint's spring, probed anew once a rigid joint has one.

A motor turns a rigid joint whatever rubs or pulls there: friction, play or a cable move nothing in a model
without a spring, and their probes about it (`diagnosis.screening`) are empty. Beside a spring that was found
they are simulated about the model with it.

Probes about a fit: what effects move beside those that were found.

Beside a soft joint or a rod of twice its mass an arm rings at another frequency and hangs otherwise. What a
load's inertia moves there is another thing than about the nominal model, where it was screened, and least
squares on those moves give it the wrong size, even the wrong sign. Beside effects that are not all, probes
are therefore taken anew: in small steps of laws that have derivatives, as the fit is near by then, and at
full size of waves, of soft springs and of laws with corners. Clocks, frames and points move as they do where
they are eliminated.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from math import isfinite

import numpy as np

from flexarm.arm import Arm
from flexarm.diagnosis.candidate import Candidate, nulls, value_of
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.screening import LONGER, Probed, in_proportion


def new_springs(fit: Fit) -> frozenset[str]:
    """Joints that are rigid in the nominal model and have a spring in a fit."""
    return frozenset(at for m in fit.members if _softens_a_joint(m) for _, at in m.spots)


def awakened(estimator: Estimator, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """Return the same probes, those of laws through the new springs of a fit about its model."""
    joints = new_springs(fit)
    sleeping = [p for p in probed if p.candidate.effect.acts_through_spring() and p.candidate.at in joints]
    if not sleeping:
        return list(probed)
    coarse = replace(estimator, problem=estimator.problem.with_step(LONGER * estimator.problem.step))
    found = {id(each): probed_beside(coarse, each, fit) for each in sleeping}
    return [found.get(id(each), each) for each in probed]


def probed_beside(estimator: Estimator, probed: Probed, fit: Fit) -> Probed:
    """Return a candidate about a model; as it was where that cannot be simulated."""
    problem = estimator.problem
    with suppress(*FIT_ERRORS):
        arm = estimator.with_effects(fit.members)
        models = [arm.with_effect(probe) for probe in probed.candidate.probes]
        problem.prepare([arm, *models])
        before = problem.residual(arm)
        return replace(probed, moves=np.stack([problem.residual(each) - before for each in models], axis=1))
    return probed


def _softens_a_joint(member: Candidate) -> bool:
    """Return True for a spring at a joint that is rigid in the nominal model."""
    rigid = member.without is None or member.without.inert
    return member.effect.is_spring and member.effect.place == "joint" and rigid


SMALL = 1e-3
"""Part of a probe that is a small step; at 0.03 a spring in a joint that was rigid bends too much."""


def nearby(estimator: Estimator, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """Return the same candidates, probed about the model of a fit; as they were where that cannot be
    simulated.

    A law on a spring that the fit has not comes with that spring, and stays as it was. Small steps of a
    spring are of one variant; softer ones, which move modes by themselves, are no small steps.
    """
    coarse = replace(estimator, problem=estimator.problem.with_step(LONGER * estimator.problem.step))
    there = {None, *fit.spots}
    found: list[Probed] = []
    smooth: dict[int, Probed] = {}
    for each in probed:
        candidate = each.candidate
        moves = in_proportion(candidate, fit.nuisance.keys, fit.projection.jacobian)
        if moves is not None:
            each = replace(each, moves=moves)
        elif not candidate.spots & fit.spots and candidate.stands_on in there:
            again = same_in_small_steps(candidate, [other.candidate for other in smooth.values()])
            small = candidate.effect.smooth and not candidate.effect.is_wave
            if again or candidate.needs is not None or not small:
                each = probed_beside(coarse, each, fit)
            else:
                smooth[len(found)] = each
        found.append(each)
    with suppress(*FIT_ERRORS):  # of the fit itself, in longer steps
        stepped = small_steps(estimator, [each.candidate for each in smooth.values()], fit)
        for k, steps in zip(smooth, stepped, strict=True):
            found[k] = steps or smooth[k]
    return found


def small_steps(estimator: Estimator, candidates: Sequence[Candidate], fit: Fit) -> Iterator[Probed | None]:
    """Return derivatives by the sizes of probes about a fit, in simulations of longer steps; None without
    any.

    Each effect is the same from the model's own values.

    Raises
    ------
    NotConverged, InvalidParameter
        If the fit itself cannot be simulated in such steps.
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
            moves = np.array([(problem.residual(arm) - before) / SMALL for arm in arms]).T
        yield Probed(candidate, moves) if moves.any() else None


def same_in_small_steps(candidate: Candidate, others: Sequence[Candidate]) -> bool:
    """Return True if a candidate moves in small steps what another variant of it does."""
    return candidate.effect.is_spring and candidate.place in {other.place for other in others}


def _nudged(estimator: Estimator, candidate: Candidate, fit: Fit) -> list[Arm]:
    """Models with a small part of each probe of an effect; none where one of them cannot be."""
    arms = []
    for k in range(len(candidate.probes)):
        with suppress(*FIT_ERRORS):
            small = replace(candidate, effect=candidate.nudged(k, SMALL))
            arms.append(estimator.with_effects((*fit.members, small)))
    return arms if len(arms) == len(candidate.probes) else []


def _from(candidate: Candidate, there: Arm) -> Candidate:
    """Return the same from a model's own values, where an effect states what a fit has elsewhere than it is
    stated.

    A small step of a load's mass would else begin with all that the fit has moved it.
    """
    without = there.effect(candidate.name, candidate.effect.at)
    null = nulls(candidate.effect, without, there)
    away = {key: value - candidate.null[key] for key, value in null.items() if isfinite(value)}
    if not any(away[key] for key in candidate.free if key in away):
        return candidate
    probes = [
        each.with_parameters({key: value_of(each, key) + away.get(key, 0.0) for key in candidate.free})
        for each in candidate.probes
    ]
    return replace(candidate, probes=tuple(probes), null=null, without=without)
