"""Candidates: every effect of the vocabulary at every place where it acts on these records and can be seen.

A guide, a mount or a bearing gives way about two axes at one place. A tree of joints with one axis each has
two joints there, whose axes meet in a point, with a massless link between them and no drive (a cardan joint).
A law at one axis without the same law at the other is no likelier than both, so both are tried as one.

External vibrations are candidates at the dominant frequencies of the gap. The periodograms
(`residual_analysis.spectrum`) of all channels over their noise are summed: the aliases of a frequency differ
between sampling rates, and only the true one is high in all. Frequencies below the band of an external
vibration are left out, as the motion of the drive has them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.closure import loop_joints
from flexarm.arm.effect import Effect, Search, effect_class
from flexarm.arm.joint import coupled_joints
from flexarm.arm.joint_units import priors_in
from flexarm.arm.link import RigidLink
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ClockEffect, FrameEffect, SignalEffect
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.diagnosis.candidate import Candidate, nulls
from flexarm.diagnosis.problem import Problem
from flexarm.effects.external_vibration import ExternalVibration
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.residual_analysis.spectrum import periodogram


def cardan_joints(arm: Arm, driven: Iterable[str]) -> dict[str, str]:
    """Return the second joint of each cardan joint by the first, given the joints that are `driven`."""
    idle = {joint.name for joint in arm.joints if joint.type == "revolute"} - set(driven)
    found = {}
    for first in arm.joints:
        for second in arm.joints:
            if (
                {first.name, second.name} <= idle
                and second.parent == first.child
                and not any(second.origin.xyz)
                and isinstance(link := arm.link(first.child), RigidLink)
                and link.mass == 0
            ):
                found[first.name] = second.name
    return found


def driven_joints(arm: Arm, records: Iterable[Record]) -> set[str]:
    """Joints that a drive turns in some record, or that a gear couples to one of them."""
    driven = {record.signals[name].joint for record in records for name in record.drive}
    return coupled_joints((name for name in driven if name is not None), arm.gears)


def pins_of_loops(arm: Arm) -> list[str]:
    """Return the joints and closures that turn about an axis in closed loops."""
    found = [
        joint.name for joint in arm.joints if joint.type == "revolute" and joint.name in loop_joints(arm)
    ]
    return found + [closure.name for closure in arm.closures if closure.type == "revolute"]


def effect_count(members: Sequence[Candidate], pairs: dict[str, str]) -> int:
    """Return the number of effects, the same one at both axes of a cardan joint counted once."""
    places = {member.place for member in members}
    return len(members) - sum((m.name, pairs.get(m.effect.at, "")) in places for m in members)


def places_of(kind: type[Effect], problem: Problem, arm: Arm) -> list[str]:
    """Return the places where an effect can act and be seen."""
    records = problem.records.values()
    evidence = dict.fromkeys((row.record, row.signal) for row in problem.rows)
    signals = [problem.records[record].signals[signal] for record, signal in evidence]
    if kind.leaves_plane and problem.planar:
        return []
    if kind.place == "joint":
        if kind.pins_of_loops_only:
            return pins_of_loops(arm)
        joints = [joint.name for joint in arm.joints if joint.moves]
        joints += [closure.name for closure in arm.closures if closure.type in kind.at_closures]
        if kind.stated_only:
            joints = [joint for joint in joints if arm.effect(kind.name, joint) is not None]
        if kind.torque_at == "motor":
            shown = {s.joint for s in signals if s.quantity == "motor_torque"}
            shown |= commanded(records) & {controller.joint for controller in arm.controllers}
            return [joint for joint in joints if joint in shown]
        turned = driven_joints(arm, records)
        return [joint for joint in joints if not kind.driven_joints_only or joint in turned]
    if kind.place == "payload":
        known = kind.stated_by_records
        loads = [load.name for load in arm.payloads]
        return [name for name in loads if not (known and all(weighed(record, name) for record in records))]
    if kind.place == "link":
        names = [link.name for link in arm.links]
        return [at for at in names if not any(kind.typical(at, arm).problems(arm))]
    if kind.place == "base":
        known = kind.stated_by_records and all(record.base is not None for record in records)
        return [] if known else ["base"]
    if kind.place == "point":
        return list(dict.fromkeys(s.point for s in signals if s.point is not None))
    if kind.place == "frame":
        assert issubclass(kind, FrameEffect)
        seen: dict[str, int] = {}
        for signal in signals:
            if signal.quantity in kind.sees and signal.frame != "base":
                rows = signal.time if signal.pose is None else set(signal.pose[signal.valid])
                seen[signal.frame] = seen.get(signal.frame, 0) + len(rows)
        return [frame for frame, places in seen.items() if places >= kind.least_places]
    if issubclass(kind, ClockEffect):
        return _late(kind, problem)
    assert issubclass(kind, SignalEffect)
    if kind.of_drives:
        signals = [record.signals[name] for record in records for name in record.drive]
    sought = dict.fromkeys(s.name for s in signals if kind.sought_in(s.quantity))
    return [at for at in sought if not any(kind.typical(at, arm).problems(arm))]


def commanded(records: Iterable[Record]) -> set[str | None]:
    """Joints that follow commands: under a controller a motor's friction moves the arm there."""
    drives = (record.signals[name] for record in records for name in record.drive)
    return {signal.joint for signal in drives if signal.quantity == "joint_command"}


def late_commands(problem: Problem) -> list[str]:
    """Commands that may act late: of records with evidence on the same clock, which moves along otherwise."""
    found: dict[str, None] = {}
    for row in problem.rows:
        record = problem.records[row.record]
        clock = record.signals[row.signal].clock
        drives = [record.signals[name] for name in record.drive]
        found |= {s.name: None for s in drives if s.quantity == "joint_command" and s.clock == clock}
    return list(found)


def _late(kind: type[ClockEffect], problem: Problem) -> list[str]:
    """Clocks but the drives', signals of a clock that has several, and commands."""
    clocks: dict[str, set[str]] = {}
    for row in problem.rows:
        record = problem.records[row.record]
        if record.kind == "motion":
            clocks.setdefault(record.signals[row.signal].clock, set()).add(row.signal)
    own = {drive_clock(record) for record in problem.records.values()}
    found = [clock for clock in clocks if clock not in own]
    for clock, names in clocks.items():
        if clock in own or len(names) > 1:
            found += [signal for signal in sorted(names) if signal not in found]
    return found + (late_commands(problem) if kind.of_commands else [])


def weighed(record: Record, payload: str) -> bool:
    """Return True if a record says what a payload weighs: its mass in the model has no effect there."""
    carried = record.payloads.get(payload)
    return carried is not None and carried.mass is not None


def candidates(
    problem: Problem, arm: Arm, rhythm: Sequence[float] = (), softer: Sequence[float] = (1.0,)
) -> list[Candidate]:
    """Return all effects that can act on these records in a model, variants of one effect in sequence.

    An external vibration may have one of the frequencies `rhythm` [Hz], at which the gap oscillates. Springs
    are probed as much `softer` than typical ones as these factors state.
    """
    found: list[Candidate] = []
    poses = all(record.kind == "static" for record in problem.records.values())
    for kind in map(effect_class, KNOWN_EFFECTS):
        if not kind.competes or (poses and kind.only_in_motion()):
            continue
        for at in places_of(kind, problem, arm):
            found += _at_place(kind, at, problem, Search(arm, None, rhythm, softer))
    if not poses:
        return found
    return [replace(c, free=tuple(k for k in c.free if k not in c.effect.in_motion)) for c in found]


def vibrations(problem: Problem, arm: Arm, rest: Floats) -> list[Candidate]:
    """Return external vibrations at the dominant frequencies of a residual."""
    kind, rhythm = ExternalVibration, dominant_frequencies(rest, problem)
    return [
        candidate
        for at in places_of(kind, problem, arm)
        for candidate in _at_place(kind, at, problem, Search(arm, None, rhythm))
    ]


def _at_place(kind: type[Effect], at: str, problem: Problem, search: Search) -> Iterator[Candidate]:
    """Variants of an effect at a place; none where the model refuses it."""
    arm = search.arm
    without, stated = arm.effect(kind.name, at), _stated(kind, at, arm, problem)
    needs: Effect | None = None
    if kind.requires is not None:
        required = arm.effect(kind.requires, at)
        if required is None or required.inert:
            needs = effect_class(kind.requires).variants(at, arm, None)[0]
    there = arm if needs is None else arm.with_effect(needs)
    unsought = () if at in commanded(problem.records.values()) else kind.sought_of_commands
    forms: Sequence[Effect] = kind.variants(at, there, without)
    if without is not None and not kind.is_spring:
        forms = [without]
    search = search._replace(stated=without)
    trials = ((form, *trial) for form in forms for trial in form.trials(search))
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
    """Priors that follow from the records, and from what the model states."""
    if priors := priors_in_records(kind, at, problem):
        return priors
    stated = arm.effect(kind.name, at)
    return {} if stated is None else stated.stated_priors(arm)


def priors_in_records(kind: type[Effect], at: str, problem: Problem) -> dict[str, Prior]:
    """Return priors of sensor and clock effects that follow from the signal at a place."""
    if issubclass(kind, SignalEffect) and not kind.of_drives:
        rows = [row for row in problem.rows if row.signal == at]
        signals = [problem.records[row.record].signals[at] for row in rows]
        readings = [np.abs(s.values[:, row.channel]) for s, row in zip(signals, rows, strict=True)]
        greatest = max(float(np.nanmax(each)) for each in readings)
        return kind.priors_from(greatest, max(row.sigma for row in rows), signals[0].unit)
    if issubclass(kind, ClockEffect):
        return kind.command_priors() if at in late_commands(problem) else {}
    return {}


def _has(effect: Effect, key: str) -> bool:
    """Return True if a parameter is a number of the effect."""
    field, _, axis = key.partition(".")
    found = getattr(effect, field, None)
    return found is not None and (not axis or len(found) > "xyz".index(axis))


FINE = 4.0
"""Frequencies a width of a peak, which is one over the length of the record."""


def dominant_frequencies(rest: Floats, problem: Problem) -> list[float]:
    """Return the three frequencies [Hz] at which a residual swings most, the strongest first."""
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
        if len(found) == 3:
            break
    return found
