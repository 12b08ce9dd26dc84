"""Models in URDF: what the format can say, as the tables of a model file.

Links become rigid links, `revolute` and `continuous` joints revolute ones, `mimic` a gear; the offset of a
sliding mimic joint moves its origin, so that its value counts from there. The root link becomes "base"; its
mass rests on the ground and is left out. Another link named `base`, which robots of ROS-Industrial have below
their root `base_link`, becomes `BASE_FRAME`. What URDF cannot say stands in the TOML file beside it: its
entries of the same name take precedence, key by key for joints.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arm.inertia import Matrix
from flexarm.arm.rotation import added, from_rpy, rotated, scaled, times, transposed
from flexarm.arm.urdf_beams import is_named, on_beams
from flexarm.errors import InvalidFile
from flexarm.reading import reading, regular_file, xml_text
from flexarm.tables.ranges import out_of_range

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_TYPES = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic", "fixed": "fixed"}
BASE_FRAME = "base_frame"
"""Name of a link that the file calls `base` and that is not its root."""
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_XACRO = re.compile(r"<xacro:|\$\{")
_NOT_TABLES = {"format", "name", "gravity", "uncertainty", "urdf"}


def with_urdf(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return tables of a model with those of the URDF file that it names, relative to `folder`.

    Raise InvalidFile if the file cannot be read, or says what flexarm does not know.
    """
    if not isinstance(data.get("urdf"), str):
        return dict(data)
    file = folder / str(data["urdf"])
    tables = read_urdf(file)
    merged = {key: value for key, value in data.items() if key != "urdf"}
    merged.setdefault("name", tables.pop("name"))
    for kind, entries in tables.items():
        own = merged.get(kind, [])
        if not isinstance(own, list | tuple) or not all(is_named(entry) for entry in own):
            continue  # the check of the model says what is wrong with it
        named = {entry["name"]: entry for entry in own}
        joined = []
        for entry in entries:
            other = named.pop(entry["name"], None)
            joined.append({**entry, **other} if kind == "joints" and other else other or entry)
        merged[kind] = joined + [entry for entry in own if entry["name"] in named] + _doubles(list(own))
    merged = on_beams(merged, data.get("joints", ()), tables["joints"], file)
    return {key: value for key, value in merged.items() if key in _NOT_TABLES or value}


def _doubles(entries: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return entries whose name stands before them already: kept, for the check of the model to refuse."""
    names = [entry["name"] for entry in entries]
    return [entry for i, entry in enumerate(entries) if entry["name"] in names[:i]]


def read_urdf(path: Path) -> dict[str, Any]:
    """Name, links, joints and gears of a URDF file, as the tables of a model file.

    Raise InvalidFile with file and place of what is wrong.
    """
    from xml.etree import ElementTree

    with reading(regular_file(path), "XML"):
        content, _ = xml_text(path, path.read_bytes())
        if _XACRO.search(_COMMENT.sub("", content)):
            what = "is a xacro file that is not expanded; allowed is URDF"
            raise InvalidFile(path, "file", f"{what}, as `xacro in.xacro > arm.urdf` makes it")
        try:
            robot = ElementTree.fromstring(content)
        except ElementTree.ParseError as error:
            raise InvalidFile(path, f"line {error.position[0]}", f"is no XML: {error}") from None
    if robot.tag != "robot":
        raise InvalidFile(path, "file", f"must hold a <robot>, got <{robot.tag}>")
    reader = _Reader(path)
    joints = robot.findall("joint")
    children = {reader.end(joint, "child") for joint in joints}
    roots = [name for link in robot.findall("link") if (name := reader.name(link)) not in children]
    if len(roots) != 1:
        named = ", ".join(roots[:10]) + (f" and {len(roots) - 10} more" if len(roots) > 10 else "")
        raise InvalidFile(path, "links", f"must have one root that no joint moves, got {named or 'none'}")
    reader.root = roots[0]
    return {
        "name": robot.get("name") or path.stem,
        "links": [reader.link(link) for link in robot.findall("link") if reader.name(link) != roots[0]],
        "joints": [reader.joint(joint) for joint in joints],
        "gears": [reader.gear(joint) for joint in joints if joint.find("mimic") is not None],
    }


class _Reader:
    """Elements of one file as tables."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.root = ""

    def in_model(self, link: str) -> str:
        """Return what the model calls a link of the file."""
        if link == self.root:
            return "base"
        return BASE_FRAME if link == "base" else link

    def name(self, element: Element) -> str:
        found = element.get("name")
        if not found:
            raise InvalidFile(self.path, f"{element.tag}s", f"a <{element.tag}> has no name")
        return found

    def end(self, joint: Element, which: str) -> str:
        link = joint.find(which)
        found = None if link is None else link.get("link")
        if not found:
            raise InvalidFile(self.path, f"joints.{self.name(joint)}", f"names no {which} link")
        return found

    def numbers(
        self, element: Element | None, key: str, default: str, where: str, count: int = 3
    ) -> list[float]:
        text = default if element is None else element.get(key, default)
        try:
            found = [float(word) for word in text.split()]
        except ValueError:
            found = []
        if len(found) != count:
            raise InvalidFile(self.path, f"{where}.{key}", f"must be {count} numbers, got {text!r}")
        if wrong := out_of_range(tuple(found), "", size=False):
            raise InvalidFile(self.path, f"{where}.{key}", wrong)
        return found

    def pose(self, element: Element | None, where: str) -> dict[str, list[float]]:
        return {key: self.numbers(element, key, "0 0 0", where) for key in ("xyz", "rpy")}

    def link(self, link: Element) -> dict[str, Any]:
        where = f"links.{self.name(link)}"
        table: dict[str, Any] = {"name": self.in_model(self.name(link)), "type": "rigid", "mass": 0.0}
        inertial = link.find("inertial")
        if inertial is None:
            return table
        pose = self.pose(inertial.find("origin"), where)
        (table["mass"],) = self.numbers(inertial.find("mass"), "value", "0", where, 1)
        tensor = inertial.find("inertia")
        xx, yy, zz, xy, xz, yz = (
            self.numbers(tensor, key, "0", where, 1)[0] for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        )
        roll, pitch, yaw = pose["rpy"]
        turn: Matrix = from_rpy((roll, pitch, yaw))
        own: Matrix = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
        J = times(times(turn, own), transposed(turn))
        return {
            **table,
            "com": pose["xyz"],
            "inertia": [J[0][0], J[1][1], J[2][2], J[0][1], J[0][2], J[1][2]],
        }

    def joint(self, joint: Element) -> dict[str, Any]:
        name = self.name(joint)
        kind = joint.get("type", "")
        if kind not in _TYPES:
            allowed = ", ".join(_TYPES)
            raise InvalidFile(self.path, f"joints.{name}.type", f"must be one of {allowed}, got {kind!r}")
        table: dict[str, Any] = {
            "name": name,
            "type": _TYPES[kind],
            "parent": self.in_model(self.end(joint, "parent")),
            "child": self.in_model(self.end(joint, "child")),
            "origin": self.pose(joint.find("origin"), f"joints.{name}"),
        }
        if kind != "fixed":
            table["axis"] = self.numbers(joint.find("axis"), "xyz", "1 0 0", f"joints.{name}")
        offset = self.mimic(joint)[2]
        if offset != 0 and kind != "prismatic":
            what = f"is known for prismatic joints only, got {offset:g}"
            raise InvalidFile(self.path, f"joints.{name}.mimic.offset", what)
        if offset != 0 and any(table["axis"]):
            x, y, z = table["axis"]
            roll, pitch, yaw = table["origin"]["rpy"]
            shift = rotated(from_rpy((roll, pitch, yaw)), scaled(offset / hypot(x, y, z), (x, y, z)))
            table["origin"]["xyz"] = list(added(tuple(table["origin"]["xyz"]), shift))
        return table

    def mimic(self, joint: Element) -> tuple[str | None, float, float]:
        """Leading joint, multiplier and offset; no leader: no mimic."""
        mimic = joint.find("mimic")
        if mimic is None:
            return None, 1.0, 0.0
        where = f"joints.{self.name(joint)}.mimic"
        (multiplier,) = self.numbers(mimic, "multiplier", "1", where, 1)
        (offset,) = self.numbers(mimic, "offset", "0", where, 1)
        if multiplier == 0:
            raise InvalidFile(self.path, f"{where}.multiplier", "must not be 0")
        if wrong := out_of_range(multiplier, "-", size=True):
            raise InvalidFile(self.path, f"{where}.multiplier", wrong)
        return mimic.get("joint"), multiplier, offset

    def gear(self, joint: Element) -> dict[str, Any]:
        """angle of joint = multiplier x angle of leader, so ratio = 1/multiplier."""
        leader, multiplier, _ = self.mimic(joint)
        name = self.name(joint)
        return {"name": f"{name}_mimic", "input": leader, "output": name, "ratio": 1 / multiplier}
