"""Columns as signals: by their names those of joints and points, by their motion those without names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.importing.guess.logged import Logged, counted
from flexarm.importing.guess.motion import ALIKE_SPEEDS, Track, agreement, rigid_track
from flexarm.importing.guess.proposal import Proposal, drives_of
from flexarm.importing.guess.words import VECTORS, matched, words_of
from flexarm.quantities import QUANTITIES
from flexarm.units import factor_to

SCALARS = ("joint_angle", "joint_rate", "joint_command", "motor_torque", "current", "motor_voltage")
MOTOR, OUTPUT = ("mot", "motor", "actuator"), ("se", "link", "out", "output", "secondary", "load", "arm")
"""Words of sides."""
STROKES = ("stroke", "extension", "hub", "auszug", "ausschub")
"""Words of ways of joints that slide."""


def joint_signals(columns: Sequence[Logged], arm: Arm) -> list[Proposal]:
    """Return the signals of joints."""
    known = [joint.name for joint in arm.moving_joints]
    found = []
    for column in columns:
        quantity, why = column.meaning.quantity, column.meaning.why
        if not quantity and _is_way(column, arm):
            quantity, why = "joint_angle", f"its unit {column.meaning.unit}, and a joint that slides"
        if quantity not in SCALARS or (column.rests and quantity not in ("joint_angle", "joint_command")):
            continue
        label = f"{column.topic or ''} {column.column}" if not _is_message(column) else str(column.column)
        joint = matched(label, known) or matched(column.told, known)
        proposal = Proposal([column], "motor_torque" if quantity == "current" else quantity, ("joint", joint))
        proposal.why["quantity"] = why
        if joint:
            where = "in the column's" if matched(label, known) else "beside, under the same number"
            proposal.why["joint"] = f"its name stands {where}"
        if quantity == "current":
            proposal.unknown["unit"] = "the motor's torque constant: unit = { torque_constant = } [N m/A]"
            proposal.out = True
            factor = factor_to("A", column.meaning.unit) or 1.0
            if factor != 1.0:
                proposal.keys["scale"] = factor
                proposal.why["scale"] = f"the constant is of one ampere, the log in {column.meaning.unit}"
        if QUANTITIES[proposal.quantity].has_side:
            words = words_of(label)
            side = "output" if any(w in OUTPUT for w in words) else "motor"
            proposal.keys["side"] = side
            if not any(w in (*MOTOR, *OUTPUT) for w in words):
                proposal.unknown["side"] = "before or behind the gear; motor is taken"
        found.append(proposal)
    return found


def named_after_joints(columns: Sequence[Logged], arm: Arm) -> list[Logged]:
    """Return the columns, as angles those that have the bare name of a joint."""
    joints = {" ".join(words_of(joint.name)) for joint in arm.moving_joints}
    ways = [id(column) for column in _ways_named_as_axes(columns, arm)]
    return [
        replace(
            column,
            meaning=counted(replace(m, quantity="joint_angle", axis="", why="a joint's name"), column.values),
        )
        if id(column) in ways or (not (m.quantity or m.unit or m.axis) and m.stem in joints)
        else column
        for column in columns
        for m in [column.meaning]
    ]


def _ways_named_as_axes(columns: Sequence[Logged], arm: Arm) -> list[Logged]:
    """Return coordinates that are named after joints that slide, and after no point.

    Three together are a point's, unless others may be, or angles of joints stand beside them. Of several
    threes those beside angles are taken, else the first.
    """
    slides = [joint.name for joint in arm.moving_joints if joint.type == "prismatic"]
    points = [point.name for point in arm.points]
    angles = [column.kind for column in columns if column.meaning.quantity == "joint_angle"]
    groups: dict[tuple[Any, str], list[Logged]] = {}
    for column in columns:
        if column.meaning.quantity == "position":
            groups.setdefault((column.kind, column.meaning.stem), []).append(column)

    def named(column: Logged, whole: bool) -> bool:
        name, bare = str(column.column), column.meaning.stem.replace(" ", "") + column.meaning.axis
        told = (whole or column.kind in angles) and matched(name, slides) and not matched(name, points)
        return bool(told) or bare in ["".join(words_of(slide)) for slide in slides]

    whole = [group for group in groups.values() if len(group) == len("xyz")]
    first = next(
        (
            group
            for group in sorted(whole, key=lambda group: group[0].kind not in angles)
            if all(named(column, True) for column in group)
        ),
        [],
    )
    unnamed = [column.kind for column in columns if isinstance(column.column, int)]
    others = len(whole) > 1 or any(unnamed.count(kind) >= len("xyz") for kind in unnamed)
    found = [c for group in groups.values() if len(group) != len("xyz") for c in group if named(c, False)]
    return found + (first if first and (others or first[0].kind in angles) else [])


def _is_way(column: Logged, arm: Arm) -> bool:
    """Return True for a length that is named as a stroke, or after a joint that slides."""
    sliding = [joint.name for joint in arm.moving_joints if joint.type == "prismatic"]
    metres = factor_to("m", column.meaning.unit) if column.meaning.unit else None
    stroke = bool(sliding) and any(word in STROKES for word in words_of(str(column.column)))
    return metres is not None and (stroke or bool(matched(str(column.column), sliding)))


def point_signals(columns: Sequence[Logged], arm: Arm) -> list[Proposal]:
    """Return the signals of points."""
    families: dict[tuple[Any, str, str], list[Logged]] = {}
    for column in columns:
        m = column.meaning
        if m.quantity in VECTORS and m.axis:
            families.setdefault((column.kind, m.stem, m.quantity), []).append(column)
    known = [point.name for point in arm.points]
    found = []
    for ((file, topic, _), stem, quantity), members in families.items():
        rotation = members[0].meaning.rotation
        wanted = "xyzw" if quantity == "orientation" and not rotation else "xyz"
        by_axis = {column.meaning.axis: column for column in members if column.meaning.axis in wanted}
        axes = [axis for axis in wanted if axis in by_axis]
        still = all(by_axis[axis].rests for axis in axes)  # a device that does not fill the field
        whole = quantity != "orientation" or len(axes) == len(wanted)
        if not axes or not whole or (quantity != "position" and still):
            continue
        label = members[0].label
        point = matched(f"{stem} {topic or ''} {label}", known) or matched(Path(file).stem, known)
        proposal = Proposal([by_axis[axis] for axis in axes], quantity, ("point", point))
        proposal.why["quantity"] = by_axis[axes[0]].meaning.why
        if point:
            proposal.why["point"] = "its name stands in the log's"
        if rotation:
            proposal.keys["rotation"] = rotation
            proposal.unknown["quantity"] = (
                "whether it was measured, not computed from the joints, and is that of the link's axes"
            )
            proposal.out = True
        elif quantity == "orientation" and not stem:
            proposal.unknown["columns"] = "whether w is the first of the four, as taken, or the last"
        if quantity != "orientation" and axes != ["x", "y", "z"]:
            proposal.keys["axes"] = axes
        found.append(proposal)
    return found


def unnamed_points(columns: Sequence[Logged], proposals: Sequence[Proposal], arm: Arm) -> list[Proposal]:
    """Return points among columns without names: three in a row that move as one of the model's does.

    Speeds (1) of `motion` correlate whatever the unit of angles is, as long as they are small or the joint is
    the only one; the joints' columns are taken as radians of the output where nothing is known yet. Beside
    counts alone, the only three columns that move are the model's only point.
    """
    joints = {p.place[1]: p.raw(arm) for p in drives_of(proposals) if not p.counts}
    bare = [column for column in columns if isinstance(column.column, int) and not column.meaning.quantity]
    found: list[Proposal] = []
    taken = {p.place for p in proposals if p.quantity == "position" and not p.out}
    if not joints:
        return _only_point(bare, [point.name for point in arm.points if ("point", point.name) not in taken])
    for kind in dict.fromkeys(column.kind for column in bare if joints):
        here = [column for column in bare if column.kind == kind]
        best: tuple[float, str, list[Logged]] = (0.0, "", [])
        for three in (here[k : k + 3] for k in range(len(here) - 2)):
            time = three[0].time
            measured = Track.of(time.seconds, [column.values for column in three], time.poses)
            if len(measured.time) < 9 or measured.size == 0:
                continue
            for point in (p.name for p in arm.points if ("point", p.name) not in taken):
                alike = agreement(measured, rigid_track(arm, point, joints, range(3))).correlation
                named = matched(three[0].label, [point]) == point
                best = max(best, (alike + named, point, three), key=lambda each: each[0])
        score, point, three = best
        if score < ALIKE_SPEEDS:
            continue
        proposal = Proposal(three, "position", ("point", point))
        proposal.why["columns"] = "without names: their speed goes with the model's point"
        proposal.unknown["columns"] = "whether they are x, y, z in this order"
        found.append(proposal)
    return found


def _only_point(bare: Sequence[Logged], points: Sequence[str]) -> list[Proposal]:
    """Return the only three columns without names that move as the only point; else nothing."""
    moving = [c for c in bare if not (c.rests or np.all(np.diff(c.values) == 1))]  # nor do they number rows
    if len(points) != 1 or len(moving) != 3 or len({column.kind for column in moving}) != 1:
        return []
    proposal = Proposal(moving, "position", ("point", points[0]))
    proposal.why["columns"] = "the only ones without names that move"
    proposal.why["point"] = "the model's only point that no other column is"
    proposal.unknown["columns"] = "whether they are x, y, z in this order"
    return [proposal]


def _is_message(column: Logged) -> bool:
    return column.topic is not None and "[" in str(column.column)


def settle_places(proposals: Sequence[Proposal], arm: Arm) -> None:
    """Give joints and points to the signals whose names do not say them."""
    points = [point.name for point in arm.points]
    families: dict[tuple[Any, str, str], list[Proposal]] = {}
    for proposal in proposals:
        if proposal.place[0] == "joint" and not proposal.place[1]:
            stem = re.sub(r"\d+", "", proposal.first.meaning.stem)
            families.setdefault((proposal.first.kind, stem, proposal.quantity), []).append(proposal)
    for family in families.values():
        joints = _suiting(family[0], arm)
        if len(family) == 1 and len(joints) == 1:
            family[0].place = ("joint", joints[0])
            only = len(arm.moving_joints) == 1
            family[0].why["joint"] = f"the model's only joint that {'moves' if only else 'has such a unit'}"
        elif numbers := _numbers(family, len(joints)):
            for proposal, number in zip(family, numbers, strict=True):
                proposal.place = ("joint", joints[number - 1])
                proposal.unknown["joint"] = f"taken by its number {number} in the order of the model"
        elif len(family) == len(joints):
            for proposal, joint in zip(family, joints, strict=True):
                proposal.place = ("joint", joint)
                proposal.unknown["joint"] = "taken in the order of the model, as there are as many columns"
        else:
            for proposal in family:
                proposal.unknown["joint"] = f"there are {', '.join(joints)}"
                if any(joint.gear_ratio != 1 for joint in arm.moving_joints):
                    proposal.unknown["before_gear"] = "true if the motor's own angle is logged"
                proposal.out = True

    for proposal in (p for p in proposals if p.place == ("point", "")):
        if len(points) == 1:
            proposal.place = ("point", points[0])
            proposal.why["point"] = "the model's only point"
        else:
            _point_by_motion(proposal, proposals, arm)


def _numbers(family: Sequence[Proposal], most: int) -> list[int]:
    """Return the only number in the name of each column, from 1; empty unless they number joints."""
    found = [re.findall(r"\d+", str(p.first.column)) for p in family]
    numbers = [int(each[0]) for each in found if len(each) == 1]
    first = min(numbers, default=1)
    numbers = [number + 1 for number in numbers] if first == 0 else numbers
    return numbers if len(set(numbers)) == len(family) and max(numbers) <= most else []


def _point_by_motion(proposal: Proposal, proposals: Sequence[Proposal], arm: Arm) -> None:
    """Give the model's point whose speed goes best with the measured one, if one does."""
    names = [point.name for point in arm.points]
    joints = {p.place[1]: p.raw(arm) for p in drives_of(proposals) if p.place[1] and not p.counts}
    time = proposal.first.time
    measured = Track.of(time.seconds, [column.values for column in proposal.columns], time.poses)
    axes = ["xyz".index(axis) for axis in proposal.keys.get("axes", "xyz")]
    found: list[tuple[float, str]] = []
    if proposal.quantity == "position" and joints and len(measured.time) > 8 and measured.size > 0:
        tracks = {name: rigid_track(arm, name, joints, axes) for name in names}
        found = sorted(((agreement(measured, t).correlation, n) for n, t in tracks.items()), reverse=True)
    if not found or found[0][0] < ALIKE_SPEEDS:
        proposal.unknown["point"] = f"there are {', '.join(names) or 'none'}"
        proposal.out = True
        return
    proposal.place = ("point", found[0][1])
    told = ", ".join(f"{name} by {alike:.3f}" for alike, name in found[:3])
    proposal.unknown["point"] = f"taken by its speed, which goes with that of {told}"


def _suiting(proposal: Proposal, arm: Arm) -> list[str]:
    """Return the moving joints that suit the unit of a column: a length or force is of one that slides."""
    placed = ((joint.name, replace(proposal, place=("joint", joint.name))) for joint in arm.moving_joints)
    return [name for name, each in placed if of_joint_type(each, arm)]


def of_joint_type(proposal: Proposal, arm: Arm) -> bool:
    """Return False for a length of a joint that turns, or an angle of one that slides."""
    kind, joint = proposal.place
    units, unit = QUANTITIES[proposal.quantity].units, proposal.first.meaning.unit
    if kind != "joint" or not joint or len(units) < 2 or not unit:
        return True
    own = units[1] if arm.joint(joint).type == "prismatic" else units[0]
    other = units[0] if own == units[1] else units[1]
    return factor_to(own, unit) is not None or factor_to(other, unit) is None


def settle_doubles(proposals: Sequence[Proposal]) -> None:
    """Comment out further columns of the same quantity, place and side: one log has it once as a rule."""
    seen: dict[tuple[str, tuple[str, str], Any], Proposal] = {}
    for proposal in proposals:
        key = (proposal.quantity, proposal.place, proposal.keys.get("side"))
        if not proposal.out and seen.setdefault(key, proposal) is not proposal:
            first = seen[key].first
            proposal.unknown["columns"] = f"which is meant; {first.column!r} of {first.file} is taken"
            proposal.out = True
