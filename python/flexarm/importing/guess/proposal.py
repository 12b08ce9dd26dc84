"""A map proposed from names, rates, ranges and the model's motion.

    1. names     what each column is, of which joint or point                       (`words`)
    2. stamps    the column that rises, its unit by name or size                    (`logged`)
    3. units     of angles those for which the model's points move as far as measured (`motion`)
    4. clocks    one a file, frames known where the coordinates are the base's

What none of this tells is written as `# unknown:`, and a signal that cannot be read so is commented out.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import log, pi
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arguments import ITEMS, PATH, takes
from flexarm.arm import Arm
from flexarm.importing.guess.logged import Logged, logged
from flexarm.importing.guess.motion import Agreement, Track, agreement, rigid_track, white_noise
from flexarm.importing.guess.text import map_text
from flexarm.importing.guess.words import VECTORS, matched, words_of
from flexarm.importing.workflow import gear_ratio
from flexarm.quantities import QUANTITIES
from flexarm.units import factor_to

SCALARS = ("joint_angle", "joint_rate", "joint_command", "motor_torque", "current", "motor_voltage")
MOTOR, OUTPUT = ("mot", "motor", "actuator"), ("se", "link", "out", "output", "secondary", "load", "arm")
"""Words of sides."""
ALIKE = log(2.0)
"""Units are told apart where one makes the model's motion twice as near to the measured size as another."""
ALIKE_SPEEDS = 0.8
"""Correlation of speeds from which on columns without names are taken for a point."""
TURNS = 2.0
"""Turns that a joint's output may make, where no measured point tells."""


@dataclass
class Proposal:
    """A signal of the map, and why.

    Attributes
    ----------
    columns : list of Logged
        In the order of the channels.
    quantity, name : str
        Of the record's signal.
    place : tuple of (str, str)
        Kind and name of the place; empty name: unknown.
    keys : dict
        Further keys of the map.
    why : dict of str to str
        Key -> the reason.
    unknown : dict of str to str
        Key -> what is not known.
    out : bool
        True if it is commented out, as the map could not be read with it.
    """

    columns: list[Logged]
    quantity: str
    place: tuple[str, str]
    name: str = ""
    keys: dict[str, Any] = field(default_factory=dict)
    why: dict[str, str] = field(default_factory=dict)
    unknown: dict[str, str] = field(default_factory=dict)
    out: bool = False

    @property
    def first(self) -> Logged:
        """The first column."""
        return self.columns[0]

    def track(self) -> Track:
        """Return its values in SI, by the keys so far."""
        factor = self.factor()
        return Track.of(self.first.time.seconds, [factor * column.values for column in self.columns])

    def raw(self, arm: Arm) -> Track:
        """Return an angle as the smallest of what it may be: in degrees where it is too far for radians."""
        values = self.first.values
        reach = float(np.nanmax(np.abs(values)))
        unit = self.first.meaning.unit or ("rad" if reach <= pi * TURNS else "deg")
        geared = np.radians(reach) if unit == "deg" else reach
        option = (unit, self.keys.get("side") == "motor" and geared > pi * TURNS)
        return _in_output(self, arm, option)

    def moves(self) -> bool:
        """Return True if a value changes."""
        return any(np.nanmax(c.values) > np.nanmin(c.values) for c in self.columns)

    def factor(self) -> float:
        """Return the factor to SI of its unit."""
        units = QUANTITIES[self.quantity].units
        unit = self.keys.get("unit", units[0])
        return next((f for si in units if (f := factor_to(si, unit)) is not None), 1.0) if units else 1.0


@takes(files=ITEMS, model=PATH, out=PATH)
def guess_map(files: Iterable[Path], model: str | Path, out: str | Path) -> str:
    """Return the text of an import map that is proposed for logs.

    Parameters
    ----------
    files : iterable of Path
        Logs of one run.
    model : str or Path
        Model of the arm.
    out : str or Path
        Where the map shall lie: its sources are named from there.

    Returns
    -------
    str
        TOML with a reason beside each line; `# unknown: ...` marks what the logs do not tell.

    Raises
    ------
    InvalidFile
        If a log cannot be read.
    """
    arm = Arm.from_toml(model)
    folder = Path(out).absolute().parent
    columns = [
        column
        for path in map(Path, files)
        for column in logged(path, os.path.relpath(path.absolute(), folder).replace(os.sep, "/"))
    ]
    stamped = [column for column in columns if column.time.column is not None] or columns
    proposals = [*_scalars(stamped, arm), *_vectors(stamped, arm)]
    _settle_places(proposals, arm)
    proposals = [proposal for proposal in proposals if _of_joint_type(proposal, arm)]
    proposals.sort(key=lambda p: p.place[0] == "point" and p.quantity == "position" and not p.moves())
    _settle_doubles(proposals)
    proposals += _unnamed(stamped, proposals, arm)
    _settle_units(proposals, arm)
    frames = _settle_motion(proposals, arm)
    _settle_noise(proposals, arm)
    _name(proposals)
    used = {id(column) for proposal in proposals for column in proposal.columns}
    left = [column for column in columns if id(column) not in used]
    named = os.path.relpath(Path(model).absolute(), folder).replace(os.sep, "/")
    return map_text(named, drives_of(proposals), proposals, left, frames)


def _scalars(columns: Sequence[Logged], arm: Arm) -> list[Proposal]:
    """Return the signals of joints."""
    known = [joint.name for joint in arm.moving_joints]
    found = []
    for column in columns:
        quantity = column.meaning.quantity
        if quantity not in SCALARS:
            continue
        label = f"{column.topic or ''} {column.column}" if not _is_message(column) else str(column.column)
        joint = matched(label, known)
        proposal = Proposal([column], "motor_torque" if quantity == "current" else quantity, ("joint", joint))
        proposal.why["quantity"] = column.meaning.why
        if joint:
            proposal.why["joint"] = "its name stands in the column's"
        if quantity == "current":
            proposal.unknown["unit"] = "the motor's torque constant: unit = { torque_constant = } [N m/A]"
            proposal.out = True
        if QUANTITIES[proposal.quantity].has_side:
            words = words_of(label)
            side = "output" if any(w in OUTPUT for w in words) else "motor"
            proposal.keys["side"] = side
            if not any(w in (*MOTOR, *OUTPUT) for w in words):
                proposal.unknown["side"] = "before or behind the gear; motor is taken"
        found.append(proposal)
    return found


def _vectors(columns: Sequence[Logged], arm: Arm) -> list[Proposal]:
    """Return the signals of points."""
    families: dict[tuple[Any, str, str], list[Logged]] = {}
    for column in columns:
        m = column.meaning
        if m.quantity in VECTORS and m.axis:
            families.setdefault((column.kind, m.stem, m.quantity), []).append(column)
    known = [point.name for point in arm.points]
    found = []
    for ((file, topic, where), stem, quantity), members in families.items():
        wanted = "xyzw" if quantity == "orientation" else "xyz"
        by_axis = {column.meaning.axis: column for column in members if column.meaning.axis in wanted}
        axes = [axis for axis in wanted if axis in by_axis]
        if quantity == "orientation" and len(axes) < 4:
            continue
        label = where[1] if where else ""
        point = matched(f"{stem} {topic or ''} {label}", known) or matched(Path(file).stem, known)
        proposal = Proposal([by_axis[axis] for axis in axes], quantity, ("point", point))
        proposal.why["quantity"] = by_axis[axes[0]].meaning.why
        if point:
            proposal.why["point"] = "its name stands in the log's"
        if quantity != "orientation" and axes != ["x", "y", "z"]:
            proposal.keys["axes"] = axes
        found.append(proposal)
    return found


def _unnamed(columns: Sequence[Logged], proposals: Sequence[Proposal], arm: Arm) -> list[Proposal]:
    """Return points among columns without names: three in a row that move as one of the model's does.

    Speeds (1) of `motion` correlate whatever the unit of angles is, as long as they are small or the joint is
    the only one; the joints' columns are taken as radians of the output where nothing is known yet.
    """
    joints = {p.place[1]: p.raw(arm) for p in drives_of(proposals)}
    bare = [column for column in columns if isinstance(column.column, int) and not column.meaning.quantity]
    found: list[Proposal] = []
    taken = {p.place for p in proposals if p.quantity == "position" and not p.out}
    for kind in dict.fromkeys(column.kind for column in bare if joints):
        here = [column for column in bare if column.kind == kind]
        best: tuple[float, str, list[Logged]] = (0.0, "", [])
        for three in (here[k : k + 3] for k in range(len(here) - 2)):
            measured = Track.of(three[0].time.seconds, [column.values for column in three])
            if len(measured.time) < 9 or measured.size == 0:
                continue
            for point in (p.name for p in arm.points if ("point", p.name) not in taken):
                alike = agreement(measured, rigid_track(arm, point, joints, range(3))).correlation
                named = kind[2] is not None and matched(kind[2][1], [point]) == point
                best = max(best, (alike + named, point, three), key=lambda each: each[0])
        score, point, three = best
        if score < ALIKE_SPEEDS:
            continue
        proposal = Proposal(three, "position", ("point", point))
        proposal.why["columns"] = "without names: their speed goes with the model's point"
        proposal.unknown["columns"] = "whether they are x, y, z in this order"
        found.append(proposal)
    return found


def _is_message(column: Logged) -> bool:
    return column.topic is not None and "[" in str(column.column)


def _settle_places(proposals: Sequence[Proposal], arm: Arm) -> None:
    """Give joints and points to the signals whose names do not say them."""
    joints, points = [joint.name for joint in arm.moving_joints], [point.name for point in arm.points]
    families: dict[tuple[Any, str, str], list[Proposal]] = {}
    for proposal in proposals:
        if proposal.place[0] == "joint" and not proposal.place[1]:
            stem = re.sub(r"\d+", "", proposal.first.meaning.stem)
            families.setdefault((proposal.first.kind, stem, proposal.quantity), []).append(proposal)
        elif not proposal.place[1] and len(points) == 1:
            proposal.place = ("point", points[0])
            proposal.why["point"] = "the model's only point"
        elif not proposal.place[1]:
            proposal.unknown["point"] = f"there are {', '.join(points) or 'none'}"
            proposal.out = True
    for family in families.values():
        if len(family) == 1 and len(joints) == 1:
            family[0].place = ("joint", joints[0])
            family[0].why["joint"] = "the model's only joint that moves"
        elif len(family) == len(joints):
            for proposal, joint in zip(family, joints, strict=True):
                proposal.place = ("joint", joint)
                proposal.unknown["joint"] = "taken in the order of the model, as there are as many columns"
        else:
            for proposal in family:
                proposal.unknown["joint"] = f"there are {', '.join(joints)}"
                proposal.out = True


def _of_joint_type(proposal: Proposal, arm: Arm) -> bool:
    """Return False for a length of a joint that turns, or an angle of one that slides."""
    kind, joint = proposal.place
    units, unit = QUANTITIES[proposal.quantity].units, proposal.first.meaning.unit
    if kind != "joint" or not joint or len(units) < 2 or not unit:
        return True
    own = units[1] if arm.joint(joint).type == "prismatic" else units[0]
    other = units[0] if own == units[1] else units[1]
    return factor_to(own, unit) is not None or factor_to(other, unit) is None


def _settle_doubles(proposals: Sequence[Proposal]) -> None:
    """Comment out further columns of the same quantity, place and side: one log has it once as a rule."""
    seen: dict[tuple[str, tuple[str, str], Any], Proposal] = {}
    for proposal in proposals:
        key = (proposal.quantity, proposal.place, proposal.keys.get("side"))
        if not proposal.out and seen.setdefault(key, proposal) is not proposal:
            first = seen[key].first
            proposal.unknown["columns"] = f"which is meant; {first.column!r} of {first.file} is taken"
            proposal.out = True


def _settle_units(proposals: Sequence[Proposal], arm: Arm) -> None:
    """Give units: by name; of coordinates by size; of angles by the model's motion, family by family."""
    for proposal in proposals:
        unit = proposal.first.meaning.unit
        units = QUANTITIES[proposal.quantity].units
        fits = unit and any(factor_to(si, unit) is not None for si in units)
        if fits and proposal.quantity != "orientation":
            proposal.keys["unit"], proposal.why["unit"] = unit, "the log says it"
        elif proposal.quantity == "position":
            far = float(np.nanmax([np.nanmax(np.abs(column.values)) for column in proposal.columns]))
            proposal.keys["unit"] = "mm" if far > 50 else "m"
            proposal.why["unit"] = f"coordinates up to {far:.4g}"
        elif proposal.quantity == "acceleration":
            size = float(np.nanmedian(np.linalg.norm([c.values for c in proposal.columns], axis=0)))
            near_g = 0.5 < size < 2
            proposal.keys["unit"] = "g" if near_g else "m/s2"
            proposal.why["unit"] = f"its size is {size:.3g} for most of the time"
            if not (near_g or 5 < size < 20):
                proposal.unknown["unit"] = f"{size:.3g} is neither 1 g nor 9.81 m/s2"
    families: dict[tuple[Any, str, str], list[Proposal]] = {}
    for proposal in proposals:
        if proposal.quantity in ("joint_angle", "joint_command", "joint_rate") and not proposal.out:
            families.setdefault(
                (proposal.first.kind, proposal.quantity, str(proposal.keys.get("side"))), []
            ).append(proposal)
    seen = _moving_points(proposals)
    for family in families.values():
        _settle_family(family, seen, arm)


def _moving_points(proposals: Sequence[Proposal]) -> list[Proposal]:
    asked = [p for p in proposals if p.quantity == "position" and not p.out and p.moves()]
    found = [p for p in asked if len(p.track().time) > 8]
    return sorted(found, key=lambda p: -p.track().size)


def _settle_family(family: Sequence[Proposal], seen: Sequence[Proposal], arm: Arm) -> None:
    """Choose unit and side of the gear for angles of one kind."""
    rate = family[0].quantity == "joint_rate"
    stated = family[0].keys.get("unit")
    turning = any(arm.joint(p.place[1]).type == "revolute" for p in family)
    units = [stated] if stated else ["rad/s", "deg/s"] if rate else ["rad", "deg"]
    units = units if turning else [stated or ("m/s" if rate else "m")]
    geared = family[0].keys.get("side") != "output" and family[0].quantity != "joint_command"
    geared = geared and any(abs(gear_ratio(arm, p.place[1])) != 1 for p in family)
    options = [(unit, gear) for unit in units for gear in ((False, True) if geared else (False,))]
    if seen and not rate and len(options) > 1:
        found = sorted((_misfit(family, seen[0], arm, option), option) for option in options)
        (best, chosen), (second, other) = found[0], found[1]
        size = seen[0].track().size
        told = f"{seen[0].place[1]} of the model then moves by {_by(best, size)} rms, measured {size:.3g} m"
        apart = second[0] - best[0] > ALIKE
        _say(family, chosen, told, "" if apart else f"{_words(other)} fits almost as well")
        return
    widest = [_widest(family, arm, option) for option in options]
    limit = pi * TURNS * (10 if rate else 1)
    chosen = next((o for o, w in zip(options, widest, strict=True) if w <= limit), options[0])
    told = f"as {_words(chosen)} values reach {_widest(family, arm, chosen):.3g} rad{'/s' if rate else ''}"
    others = [o for o, w in zip(options, widest, strict=True) if w <= limit and o != chosen]
    _say(family, chosen, told, f"no measured point tells; {_words(others[0])} is possible" if others else "")


def _by(misfit: tuple[float, float], size: float) -> str:
    return f"{misfit[1] * size:.3g} m"


def _words(option: tuple[str, bool]) -> str:
    return f"{option[0]} {'before the gear' if option[1] else 'of the output'}"


def _say(family: Sequence[Proposal], option: tuple[str, bool], why: str, unknown: str) -> None:
    for proposal in family:
        stated = "unit" in proposal.keys
        proposal.keys["unit"] = option[0]
        if option[1]:
            proposal.keys["before_gear"] = True
        proposal.why["before_gear" if stated and option[1] else "unit"] = (
            f"the log says it; {why}" if stated and not option[1] else why
        )
        if unknown:
            proposal.unknown["unit"] = unknown


def _in_output(proposal: Proposal, arm: Arm, option: tuple[str, bool]) -> Track:
    """Return an angle at the output [rad or m]."""
    factor = next(f for si in QUANTITIES[proposal.quantity].units if (f := factor_to(si, option[0])))
    ratio = gear_ratio(arm, proposal.place[1]) if option[1] else 1.0
    return Track.of(proposal.first.time.seconds, [proposal.first.values * factor / ratio])


def _widest(family: Sequence[Proposal], arm: Arm, option: tuple[str, bool]) -> float:
    return max(float(np.abs(_in_output(p, arm, option).values).max(initial=0.0)) for p in family)


def _misfit(
    family: Sequence[Proposal], seen: Proposal, arm: Arm, option: tuple[str, bool]
) -> tuple[float, float]:
    """Return |log| of the size of the model's motion over the measured one, and that ratio."""
    joints = {p.place[1]: _in_output(p, arm, option) for p in family}
    ratio = agreement_of(seen, arm, joints, sizes_only=True).ratio
    return abs(log(max(ratio, 1e-9))), ratio


def agreement_of(seen: Proposal, arm: Arm, joints: dict[str, Track], sizes_only: bool = False) -> Agreement:
    """Return how a measured point goes with the rigid arm along joints."""
    axes = ["xyz".index(axis) for axis in seen.keys.get("axes", "xyz")]
    predicted = rigid_track(arm, seen.place[1], joints, axes)
    measured = seen.track()
    if sizes_only:
        return Agreement(0.0, 0.0, predicted.size / measured.size if measured.size else 0.0)
    return agreement(measured, predicted)


def drives_of(proposals: Sequence[Proposal]) -> list[Proposal]:
    """Return the signals that drive: of each joint a motor's angle, else another one, else a command."""
    found: dict[str, Proposal] = {}
    order = sorted(
        (p for p in proposals if p.quantity in ("joint_angle", "joint_command") and not p.out),
        key=lambda p: (p.quantity == "joint_command", p.keys.get("side") == "output"),
    )
    for proposal in order:
        found.setdefault(proposal.place[1], proposal)
    return [p for p in proposals if p in found.values()]


def _settle_motion(proposals: Sequence[Proposal], arm: Arm) -> dict[str, str]:
    """Say how points go with the model, and return the frames that are not the base's with the reason."""
    joints = {
        p.place[1]: _in_output(p, arm, (p.keys["unit"], p.keys.get("before_gear", False)))
        for p in drives_of(proposals)
    }
    frames: dict[str, str] = {}
    for seen in (p for p in proposals if p.quantity in ("position", "orientation") and not p.out):
        name, told = _plain(Path(seen.first.file).stem), "nothing tells where it stands"
        if seen.quantity == "position" and joints and len(seen.track().time) > 8:
            found = agreement_of(seen, arm, joints)
            alike = f"{found.correlation:.2f} at a lag of {found.lag:.3g} s"
            reason = f"speeds correlate with the model's by {alike}"
            seen.why["point"] = "; ".join(filter(None, (seen.why.get("point"), reason)))
            if found.correlation < 0.5:
                seen.unknown["point"] = (
                    "the model's point does not move like it: joints, signs or point may be wrong"
                )
            away = _from_base(seen, arm, joints, found.lag)
            told = f"it is {away:.3g} m off the model's point in the base's axes"
            if away < 0.1 * seen.track().size:
                seen.keys["frame"], seen.why["frame"] = "base", told
                seen.unknown["frame"] = "how well it is registered; exactly is taken"
                continue
        seen.keys["frame"] = name
        frames[name] = told
    return frames


def _from_base(seen: Proposal, arm: Arm, joints: dict[str, Track], lag: float) -> float:
    axes = ["xyz".index(axis) for axis in seen.keys.get("axes", "xyz")]
    predicted, measured = rigid_track(arm, seen.place[1], joints, axes), seen.track()
    at = measured.time - lag
    inside = (at >= predicted.time[0]) & (at <= predicted.time[-1])
    away = measured.values[inside] - predicted.at(at[inside])
    return float(np.sqrt(np.mean(np.sum(away**2, axis=1)))) if inside.any() else float("inf")


def _settle_noise(proposals: Sequence[Proposal], arm: Arm) -> None:
    for proposal in proposals:
        if proposal.quantity == "joint_command":
            continue
        sizes = [white_noise(column.values) for column in proposal.columns]
        sigma = float(np.max(sizes)) * proposal.factor()
        sigma /= abs(gear_ratio(arm, proposal.place[1])) if "before_gear" in proposal.keys else 1.0
        if sigma > 0:
            proposal.keys["noise_std"] = float(f"{sigma:.2g}")
            proposal.why["noise_std"] = "at most: third differences of neighbours"
        else:
            proposal.unknown["noise_std"] = "neighbours do not scatter"


def _name(proposals: Sequence[Proposal]) -> None:
    """Name signals after their places, further ones of a place after what they are."""
    taken: set[str] = set()
    for proposal in proposals:
        place = proposal.place[1] or "unknown"
        plain = {"joint_angle": "", "position": ""}.get(proposal.quantity, f"_{proposal.quantity}")
        side = "_output" if proposal.keys.get("side") == "output" and not plain else ""
        name = base = f"{place}{plain}{side}"
        number = 2
        while name in taken:
            name, number = f"{base}_{number}", number + 1
        taken.add(name)
        proposal.name = name


def _plain(text: str) -> str:
    return re.sub(r"[^\w-]+", "_", text).strip("_") or "log"
