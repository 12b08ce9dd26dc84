"""Universal and spherical joints of a model file, as hinges whose axes meet in a point.

    universal    R = R(u, q_1) R(v, q_2)                                                              (1)
    spherical    R = Rx(q_1) Ry(q_2) Rz(q_3)                                                          (2)

u is `axis` and v `second_axis`, of which the part across u counts. Hinges of a joint NAME are NAME_1, NAME_2
and NAME_3, with links without mass between them. (2) is singular where q_2 is a right angle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

AXES = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
NONE = {"type": "rigid", "mass": 0.0, "com": [0.0, 0.0, 0.0], "inertia": [0.0, 0.0, 0.0]}
"""A link without mass."""


def with_hinges(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of a model with hinges in place of universal and spherical joints."""
    joints, links = data.get("joints"), data.get("links")
    if not isinstance(joints, list | tuple) or not isinstance(links, list | tuple):
        return dict(data)
    found, between = [], list(links)
    for joint in joints:
        axes = _axes(joint)
        if not axes:
            found.append(joint)
            continue
        crosses = [f"{joint['name']}_cross{k}" for k in range(1, len(axes))]
        between += [{"name": name, **NONE} for name in crosses]
        found += _hinges(joint, axes, crosses)
    return {**data, "joints": found, "links": between}


def _axes(joint: Any) -> list[Any]:
    """Return the axes of the hinges of a joint; none for a joint that stays as it is."""
    if not isinstance(joint, Mapping) or not isinstance(joint.get("name"), str):
        return []
    keys = joint.keys() - {"name", "type", "parent", "child", "at", "origin"}
    if joint.get("type") == "spherical" and not keys:
        return list(AXES)
    if joint.get("type") == "universal" and keys == {"axis", "second_axis"}:
        return [joint["axis"], joint["second_axis"]]
    return []


def _hinges(joint: Mapping[str, Any], axes: list[Any], crosses: list[str]) -> Iterator[dict[str, Any]]:
    rest = {key: value for key, value in joint.items() if key not in ("second_axis", "child")}
    before = rest
    for k, (axis, child) in enumerate(zip(axes, [*crosses, joint.get("child")], strict=True), start=1):
        yield {**before, "name": f"{joint['name']}_{k}", "type": "revolute", "child": child, "axis": axis}
        before = {"parent": child}
