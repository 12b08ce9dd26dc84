r"""Every effect at every place it can sit: the vocabulary, laid over a model and its records.

Frequencies at which a gap swings, from samples at any instants.

The periodogram (`residual_analysis.spectrum`) of every channel over its noise, summed over channels. A
tracker alone cannot tell a frequency from its aliases about its sampling rate; beside a faster signal the
sum can, as only the true frequency is high in both. What moves with the drive, below the band of an external
vibration, is left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ClockEffect, SignalEffect
from flexarm.arm.spring_effect import SpringEffect
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate, nulls
from flexarm.diagnosis.candidate_places import commanded, late_commands, places_of
from flexarm.diagnosis.problem import Problem
from flexarm.effects.external_vibration import ExternalVibration
from flexarm.errors import InvalidParameter
from flexarm.residual_analysis.spectrum import periodogram


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
        How much softer than typical springs are probed, such as `SpringEffect.softer`.
    """
    found: list[Candidate] = []
    poses = all(record.kind == "static" for record in problem.records.values())
    for kind in map(effect_class, KNOWN_EFFECTS):
        if not kind.competes or (poses and kind.only_in_motion()):
            continue
        for at in places_of(kind, problem, arm):
            found += _at_place(kind, at, problem, arm, rhythm, softer)
    return [_of_poses(candidate) for candidate in found] if poses else found


def _of_poses(candidate: Candidate) -> Candidate:
    """Without what poses cannot show: the damping of a spring."""
    return replace(candidate, free=tuple(k for k in candidate.free if k not in candidate.effect.in_motion))


def _at_place(
    kind: type[Effect],
    at: str,
    problem: Problem,
    arm: Arm,
    rhythm: Sequence[float],
    softer: Sequence[float],
) -> Iterator[Candidate]:
    """Variants of an effect at a place; none where the model refuses it."""
    without, stated = arm.effect(kind.name, at), _stated(kind, at, arm, problem)
    needs: Effect | None = None
    if kind.requires is not None:
        required = arm.effect(kind.requires, at)
        if required is None or required.inert:
            needs = effect_class(kind.requires).typical(at, arm)
    there = arm if needs is None else arm.with_effect(needs)
    unsought = () if at in commanded(problem.records.values()) else kind.sought_of_commands
    forms: Sequence[Effect] = kind.variants(at, there, without)
    if without is not None and not kind.is_spring:
        forms = [without]
    trials = ((form, *trial) for form in forms for trial in form.trials(without, arm, rhythm, softer))
    for typical, start, fixed in trials:
        null = nulls(typical, without, arm)
        fixed = {**fixed, **{key: null[key] for key in unsought}}
        effect = typical.with_parameters({**start, **fixed})
        priors = {**priors_in(effect, there), **stated}
        free = tuple(key for key in priors if key not in fixed and _has(effect, key))
        steps = tuple(effect.probes(without, free, null, priors))
        try:
            for probe in steps:
                there.with_effect(probe)
        except InvalidParameter:
            continue
        if steps:
            yield Candidate(effect, free, steps, null, without, needs, stated)


def _stated(kind: type[Effect], at: str, arm: Arm, problem: Problem) -> dict[str, Prior]:
    """Priors that follow from the records, and of springs from the model."""
    if issubclass(kind, SignalEffect) and not kind.of_drives:
        rows = [row for row in problem.rows if row.signal == at]
        signals = [problem.records[row.record].signals[at] for row in rows]
        readings = [np.abs(s.values[:, row.channel]) for s, row in zip(signals, rows, strict=True)]
        greatest = max(float(np.nanmax(each)) for each in readings)
        return kind.priors_from(greatest, max(row.sigma for row in rows), signals[0].unit)
    if issubclass(kind, ClockEffect):
        return kind.command_priors() if at in late_commands(problem) else {}
    spring = arm.effect(kind.name, at)
    return spring.stated_priors(arm) if isinstance(spring, SpringEffect) else {}


def _has(effect: Effect, key: str) -> bool:
    """Return True if a parameter is a number of the effect."""
    field, _, axis = key.partition(".")
    found = getattr(effect, field, None)
    return found is not None and (not axis or len(found) > "xyz".index(axis))


FINE = 4.0
"""Frequencies a width of a peak, which is one over the length of the record."""


def rhythms(rest: Floats, problem: Problem, most: int = 3) -> list[float]:
    """Return the `most` frequencies [Hz] at which a residual swings most, the strongest first."""
    motions = [each for each in problem.rows if problem.records[each.record].kind == "motion"]
    length = problem.seconds
    if length <= 0:
        return []
    lowest, highest = ExternalVibration.band_hz
    frequency = np.arange(lowest, highest, 1.0 / (FINE * length))
    power = np.zeros(len(frequency))
    for each in motions:
        values = rest[each.where]
        if len(values) > 8:
            power += len(values) * np.interp(frequency, *periodogram(each.time, values, 2 * FINE, highest))
    found: list[float] = []
    width = 2.0 / length
    for k in np.argsort(-power):
        if all(abs(frequency[k] - other) > width for other in found):
            found.append(float(frequency[k]))
        if len(found) == most:
            break
    return found
