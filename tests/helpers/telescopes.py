"""Telescopic booms: the tail of an inner beam slides in an outer one, whose mouth slides along the inner."""

from __future__ import annotations

from typing import Any

import loops

import flexarm


def telescope(outer: dict[str, Any], inner: dict[str, Any], start: float, **more: Any) -> flexarm.Arm:
    """Return a boom of two beams along x in the x-z plane, its tail `start` from the pin at first [m].

    `extension` drives the tail along the outer beam; shoe and tilt leave it free across. `tip` is the inner
    beam's end.
    """
    none = {"type": "rigid", "mass": 0.0, "com": [0, 0, 0], "inertia": [0, 0, 0]}
    slide = {"type": "prismatic", "origin": {"xyz": [0, 0, 0]}}
    return flexarm.Arm.from_dict(
        {
            "name": "telescope",
            "links": [outer, {"name": "piston", **none}, {"name": "shoe", **none}, inner],
            "joints": [
                loops.hinge("pin", "base", outer["name"]),
                {"name": "extension", "parent": outer["name"], "child": "piston", "axis": [1, 0, 0], **slide},
                {"name": "lift", "parent": "piston", "child": "shoe", "axis": [0, 0, 1], **slide},
                loops.hinge("tilt", "shoe", inner["name"]),
            ],
            "closures": [
                {"name": "tail", "type": "point_on_beam", "a": outer["name"], "b": inner["name"]},
                {
                    "name": "mouth",
                    "type": "point_on_beam",
                    "a": inner["name"],
                    "b": outer["name"],
                    "b_at": "end",
                },
            ],
            "assembly": {"extension": start},
            "points": [{"name": "tip", "link": inner["name"], "position": inner["end"]}],
            **more,
        }
    )
