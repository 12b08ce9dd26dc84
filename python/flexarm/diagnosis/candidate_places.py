"""Joints that are one thing of the machine though the model has two: the axes of a cardan joint.

A guide, a mount or a bearing gives way about two axes at one place. A tree of joints with one axis each says
so with two joints whose axes meet in a point, a link without mass between them, and nothing that drives
either. If such a place is soft it is soft about both axes, each with its own stiffness: a law at the first
without the same law at the second is no likelier a cause than both, so both are tried as one.

Where an effect can sit: where it acts on these records, and what it does there is seen.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from flexarm.arm import Arm
from flexarm.arm.joint import coupled_joints
from flexarm.arm.link import Beam, RigidLink
from flexarm.arm.sensor_effect import ClockEffect, FrameEffect, SignalEffect
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.diagnosis.problem import Problem
from flexarm.record import Record, Signal

if TYPE_CHECKING:
    from flexarm.arm.effect import Effect
    from flexarm.diagnosis.candidate import Candidate


def cardan_joints(arm: Arm, driven: Iterable[str]) -> dict[str, str]:
    """Second joint of each cardan joint, by the first.

    Parameters
    ----------
    arm : Arm
        The model.
    driven : iterable of str
        Joints that something turns.
    """
    idle = {joint.name for joint in arm.joints if joint.type == "revolute"} - set(driven)
    found = {}
    for first in arm.joints:
        for second in arm.joints:
            if (
                {first.name, second.name} <= idle
                and second.parent == first.child
                and not any(second.origin.xyz)
                and _weightless(arm, first.child)
            ):
                found[first.name] = second.name
    return found


def driven_joints(arm: Arm, records: Iterable[Record]) -> set[str]:
    """Joints that a drive turns in some record, or that a gear couples to one of them."""
    driven = {record.signals[name].joint for record in records for name in record.drive}
    return coupled_joints((name for name in driven if name is not None), arm.gears)


def causes(members: Sequence[Candidate], pairs: dict[str, str]) -> int:
    """Return the number of effects, the same one at both axes of a cardan joint counted once."""
    places = {member.place for member in members}
    return len(members) - sum((m.name, pairs.get(m.effect.at, "")) in places for m in members)


def _weightless(arm: Arm, name: str) -> bool:
    link = arm.link(name)
    return isinstance(link, RigidLink) and link.mass == 0


def places_of(kind: type[Effect], problem: Problem, arm: Arm) -> list[str]:
    """Where an effect can act and be seen."""
    records = problem.records.values()
    evidence = dict.fromkeys((row.record, row.signal) for row in problem.rows)
    signals = [problem.records[record].signals[signal] for record, signal in evidence]
    if kind.leaves_plane and problem.planar:
        return []
    if kind.place == "joint":
        joints = [joint.name for joint in arm.joints if joint.moves]
        joints += [closure.name for closure in arm.closures if closure.type in kind.at_closures]
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
        return [link.name for link in arm.links if isinstance(link, Beam)]
    if kind.place == "base":
        known = kind.stated_by_records and all(record.base is not None for record in records)
        return [] if known else ["base"]
    if kind.place == "point":
        return list(dict.fromkeys(s.point for s in signals if s.point is not None))
    if kind.place == "frame":
        assert issubclass(kind, FrameEffect)
        return _frames(kind, signals)
    if issubclass(kind, ClockEffect):
        return _late(kind, problem)
    assert issubclass(kind, SignalEffect)
    if kind.of_drives:
        signals = [record.signals[name] for record in records for name in record.drive]
    return list(dict.fromkeys(s.name for s in signals if kind.sought_in(s.quantity)))


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


def _frames(kind: type[FrameEffect], signals: Iterable[Signal]) -> list[str]:
    """Frames but the base's own in which enough places are seen."""
    seen: dict[str, int] = {}
    for signal in signals:
        if signal.quantity in kind.sees and signal.frame != "base":
            rows = signal.time if signal.pose is None else set(signal.pose[signal.valid])
            seen[signal.frame] = seen.get(signal.frame, 0) + len(rows)
    return [frame for frame, places in seen.items() if places >= kind.least_places]


def weighed(record: Record, payload: str) -> bool:
    """Return True if a record says what a payload weighs: its mass in the model has no effect there."""
    carried = record.payloads.get(payload)
    return carried is not None and carried.mass is not None
