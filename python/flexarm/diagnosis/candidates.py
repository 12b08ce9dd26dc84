r"""Every effect at every place it can sit: the vocabulary, laid over a model and its records.

Frequencies at which a gap swings, from samples at any instants.

The periodogram (`residual_analysis.spectrum`) of every channel over its noise, summed over channels. A
tracker alone cannot tell a frequency from its aliases about its sampling rate; beside a faster signal the
sum can, as only the true frequency is high in both. What moves with the drive, below `LOWEST`, is left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isinf

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import Prior
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import SPRINGS, Candidate, value_of
from flexarm.diagnosis.candidate_places import late_commands, places_of
from flexarm.diagnosis.perturbations import (
    command_priors,
    nulls,
    offset_priors,
    probes,
    spring_priors,
    typical_of,
    variants,
)
from flexarm.diagnosis.problem import Problem
from flexarm.effects.joint_compliance import TYPICAL_DAMPING, TYPICAL_STIFFNESS, JointCompliance
from flexarm.errors import InvalidParameter
from flexarm.residual_analysis.spectrum import periodogram

FAULTS = ("saturation", "sign_error", "unit_error", "dead_channel", "outliers")
"""Of sensors; `check` finds them before."""
LEFT_OUT = (*FAULTS, "lugre_friction", "encoder_quantisation")
"""`lugre_friction` is no name of the shared vocabulary; steps of an encoder are noise."""
ON_SPRING = ("joint_stiffening", "joint_hysteresis", "backlash")
"""Laws of the reducer's deflection, which need a joint_compliance."""
STARTS = ("width", "time_constant", "frequency", "stiffness")
"""Parameters of which variants are starts of a fit."""
IN_MOTION = (
    "joint_hysteresis",
    "coulomb_friction",
    "viscous_friction",
    "payload_inertia",
    "link_damping",
    "frame_drift",
)
"""Laws of motion and time, which are zero in poses that are each an equilibrium of their own."""


def candidates(
    problem: Problem, arm: Arm, rhythm: Sequence[float] = (), softer: Sequence[float] = (1.0,)
) -> list[Candidate]:
    """All that can act on these records in a model, variants of one effect one after the other.

    Parameters
    ----------
    problem : Problem
        The records.
    arm : Arm
        The model.
    rhythm : sequence of float
        Frequencies at which the gap swings [Hz]: an external vibration may have them.
    softer : sequence of float
        How much softer than typical springs are probed, such as `SOFTER`.
    """
    found: list[Candidate] = []
    poses = all(record.kind == "static" for record in problem.records.values())
    for name in KNOWN_EFFECTS:
        if name in LEFT_OUT or (poses and name in IN_MOTION):
            continue
        for at in places_of(name, problem, arm):
            found += _at_place(name, at, arm, rhythm, softer, _stated(name, at, arm, problem))
    return [_of_poses(candidate) for candidate in found] if poses else found


def _stated(name: str, at: str, arm: Arm, problem: Problem) -> dict[str, Prior]:
    """Priors that follow from the records, and of springs from the model."""
    if name == "sensor_offset":
        return offset_priors(at, problem)
    if name in SPRINGS:
        return spring_priors(arm.effect(name, at), arm)
    return command_priors() if name == "time_delay" and at in late_commands(problem) else {}


def _of_poses(candidate: Candidate) -> Candidate:
    """Without what poses cannot show: the damping of a spring."""
    return replace(candidate, free=tuple(key for key in candidate.free if key != "damping"))


def _at_place(
    name: str,
    at: str,
    arm: Arm,
    rhythm: Sequence[float],
    softer: Sequence[float],
    stated: Mapping[str, Prior],
) -> Iterator[Candidate]:
    """Variants of an effect at a place; none where the model refuses it."""
    without = arm.effect(name, at)
    needs: Effect | None = None
    if name == "external_vibration":
        base = arm.effect("base_compliance", at)
        if base is None or isinf(value_of(base, "stiffness")):
            needs = typical_of("base_compliance", at, arm)
    if name in ON_SPRING:
        spring = arm.effect("joint_compliance", at)
        if spring is None or isinf(value_of(spring, "stiffness")):
            damping = TYPICAL_DAMPING * TYPICAL_STIFFNESS
            needs = JointCompliance(at=at, stiffness=TYPICAL_STIFFNESS, damping=damping)
    there = arm if needs is None else arm.with_effect(needs)
    typical = without if without is not None and name not in SPRINGS else typical_of(name, at, there)
    for fixed in variants(name, typical, without, arm, rhythm, softer):
        effect = typical.with_parameters(fixed)
        held = {key for key, value in fixed.items() if key not in STARTS or value == 0}
        priors = {**priors_in(effect, there), **stated}
        free = tuple(key for key in priors if key not in held and _has(effect, key))
        null = nulls(effect, without, arm)
        steps = tuple(probes(name, effect, without, free, null, priors))
        try:
            for probe in steps:
                there.with_effect(probe)
        except InvalidParameter:
            continue
        if steps:
            yield Candidate(effect, free, steps, null, without, needs, stated)


def _has(effect: Effect, key: str) -> bool:
    """Whether a parameter is a number of the effect."""
    field, _, axis = key.partition(".")
    found = getattr(effect, field, None)
    return found is not None and (not axis or len(found) > "xyz".index(axis))


LOWEST, HIGHEST = 0.3, 15.0
"""Frequencies that are looked at [Hz]."""
FINE = 4.0
"""Frequencies a width of a peak, which is one over the length of the record."""


def rhythms(rest: Floats, problem: Problem, most: int = 3) -> list[float]:
    """The `most` frequencies [Hz] at which a residual swings most, the strongest first."""
    motions = [each for each in problem.rows if problem.records[each.record].kind == "motion"]
    length = problem.seconds
    if length <= 0:
        return []
    frequency = np.arange(LOWEST, HIGHEST, 1.0 / (FINE * length))
    power = np.zeros(len(frequency))
    for each in motions:
        values = rest[each.where]
        if len(values) > 8:
            power += len(values) * np.interp(frequency, *periodogram(each.time, values, 2 * FINE, HIGHEST))
    found: list[float] = []
    width = 2.0 / length
    for k in np.argsort(-power):
        if all(abs(frequency[k] - other) > width for other in found):
            found.append(float(frequency[k]))
        if len(found) == most:
            break
    return found
