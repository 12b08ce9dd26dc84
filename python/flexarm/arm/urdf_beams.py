"""Joints of a URDF file on beams that take the place of its links.

An origin in the file counts from the frame of the parent link. With the fraction s of the beam's length at
which it projects on the beam's axis, the joint stands

    s <= ENDS        on the frame at the start
    s >= 1 - ENDS    on the section at the far end, from which its origin then counts                 (1)

and between them on neither, which is refused: a beam carries joints at its ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import hypot
from pathlib import Path
from typing import Any

from flexarm.arm.rotation import Vector, added, dot, scaled
from flexarm.errors import InvalidFile
from flexarm.tables.ranges import out_of_range

ENDS = 1e-3
"""Part of a beam's length within which a joint stands at an end: files round coordinates."""
_ROUNDING = 1e-9
"""Part of a beam's length below which what is left of an origin is zero."""


def is_named(entry: Any) -> bool:
    """Return True for a table with a name."""
    return isinstance(entry, dict) and isinstance(entry.get("name"), str)


def on_beams(
    model: dict[str, Any], own: Iterable[Any], joints: Iterable[Mapping[str, Any]], file: Path
) -> dict[str, Any]:
    """Return the merged tables of a model with the joints of its URDF file on the sections they belong to.

    `own` are joints as the model's own file has them, whose `origin` and `at` take precedence over those of
    `joints`, from the URDF file.

    Raise InvalidFile if a joint stands between the ends of a beam.
    """
    merged = model.get("joints", ())
    beams = {link["name"]: link["end"] for link in _entries(model.get("links")) if _is_beam(link)}
    stated = {entry["name"]: entry for entry in _entries(own) if is_named(entry)}
    origins = {joint["name"]: joint["origin"] for joint in joints}
    if not beams or not isinstance(merged, list) or not all(map(is_named, merged)):
        return model
    placed = []
    for joint in merged:
        name, parent = joint["name"], joint.get("parent")
        known = name in origins and isinstance(parent, str) and parent in beams
        if known and "origin" not in stated.get(name, {}):
            end = beams[parent]
            side = joint.get("at") or _side(name, origins[name]["xyz"], parent, end, file)
            joint = {**joint, "at": side, "origin": _counted_from(side, origins[name], end)}
        placed.append(joint)
    return {**model, "joints": placed}


def _side(name: str, xyz: list[float], beam: str, end: list[float], file: Path) -> str:
    """Return "start" or "end" of a beam by eq. (1)."""
    along = dot((xyz[0], xyz[1], xyz[2]), (end[0], end[1], end[2])) / hypot(*end) ** 2
    if ENDS < along < 1 - ENDS:
        what = f"stands at {along:.3g} of the length of beam {beam!r}, which carries joints at its ends only"
        way = 'make two beams of it, or give the joint at = "start" or "end", with which it is rigid'
        raise InvalidFile(file, f"joints.{name}.origin", f"{what}; {way}")
    return "end" if along >= 1 - ENDS else "start"


def _counted_from(side: str, origin: dict[str, list[float]], end: list[float]) -> dict[str, list[float]]:
    if side != "end":
        return origin
    x, y, z = origin["xyz"]
    return {**origin, "xyz": list(left_from_end((x, y, z), (end[0], end[1], end[2])))}


def left_from_end(xyz: Vector, end: Vector) -> Vector:
    """Return an origin in the frame of a beam's link as it counts from the beam's far end [m]."""
    x, y, z = added(xyz, scaled(-1.0, end))
    rounding = _ROUNDING * hypot(*end)
    return x * (abs(x) > rounding), y * (abs(y) > rounding), z * (abs(z) > rounding)


def _entries(tables: Any) -> list[Any]:
    return list(tables) if isinstance(tables, list | tuple) else []


def _is_beam(link: Any) -> bool:
    """Return True for a beam with an end that can be one; the check of the model names what cannot."""
    if not is_named(link) or link.get("type") != "beam":
        return False
    end = link.get("end")
    if not isinstance(end, list | tuple) or len(end) != 3:
        return False
    if not all(isinstance(x, int | float) and not isinstance(x, bool) for x in end):
        return False
    return out_of_range(hypot(*end), "m", size=True) is None and hypot(*end) > 0
