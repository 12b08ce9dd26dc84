"""Arms with closed loops, as dictionaries of a model file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import flexarm

BACK = [0, -1, 0]
"""Axis about which x turns to z."""


def hinge(name: str, parent: str, child: str, xyz: Any = (0, 0, 0), at: str = "start") -> dict[str, Any]:
    """Return a revolute joint of a flat mechanism in the x-z plane."""
    origin = {"xyz": list(xyz)}
    return {
        "name": name,
        "type": "revolute",
        "parent": parent,
        "child": child,
        "origin": origin,
        "axis": BACK,
        "at": at,
    }


def pin(name: str, a: str, a_xyz: Any, b: str, b_xyz: Any, kind: str = "revolute") -> dict[str, Any]:
    """Return a closure between two places of a flat mechanism."""
    found = {"name": name, "type": kind, "a": a, "a_origin": {"xyz": list(a_xyz)}, "b": b}
    found["b_origin"] = {"xyz": list(b_xyz)}
    if kind not in ("spherical", "fixed"):
        found["axis"] = BACK
    return found


def bar(name: str, length: float, mass: float) -> dict[str, Any]:
    """Return a uniform rigid bar along x."""
    across = mass * length**2 / 12
    return {
        "name": name,
        "type": "rigid",
        "mass": mass,
        "com": [length / 2, 0, 0],
        "inertia": [1e-3 * across, across, across],
    }


def beam(name: str, length: float, elements: int = 4, side: float = 0.02) -> dict[str, Any]:
    """Return a square steel beam along x."""
    return {
        "name": name,
        "type": "beam",
        "end": [length, 0, 0],
        "section": {"shape": "rectangle", "width": side, "height": side},
        "material": {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850},
        "elements": elements,
    }


def crane(boom: dict[str, Any] | None = None) -> flexarm.Arm:
    """Return a boom of 3 m that a cylinder holds, rigid by default, with 500 kg at its tip."""
    links = [
        boom or bar("boom", 3.0, 200.0),
        {"name": "cylinder", "type": "rigid", "mass": 25, "com": [0, 0, 0.35], "inertia": [1, 1, 0.05]},
        {"name": "rod", "type": "rigid", "mass": 12, "com": [0, 0, 0.5], "inertia": [1, 1, 0.01]},
    ]
    piston = {"name": "piston", "type": "prismatic", "parent": "cylinder", "child": "rod", "axis": [0, 0, 1]}
    return flexarm.Arm.from_dict(
        {
            "name": "crane",
            "links": links,
            "joints": [
                hinge("boom_pin", "base", "boom", (0, 0, 1)),
                hinge("cylinder_pin", "base", "cylinder", (0.3, 0, 0.2)),
                piston,
            ],
            "closures": [pin("rod_eye", "rod", (0, 0, 0.9), "boom", (1.2, 0, -0.15))],
            "payloads": [{"name": "load", "link": "boom", "position": [3, 0, 0], "mass": 500}],
            "points": [{"name": "tip", "link": "boom", "position": [3, 0, 0]}],
        }
    )


def flexible_crane(**more: Any) -> flexarm.Arm:
    """Return the crane with a boom that is a beam, and with more tables."""
    return flexarm.Arm.from_dict({**crane(beam("boom", 3.0, side=0.15)).to_dict(), **more})


def crane_record(arm: flexarm.Arm, lift: flexarm.Drive, step: float, seed: int) -> flexarm.Record:
    """Return a virtual record of the tip of a crane at 20 Hz and 20 micrometres of noise."""
    rng = np.random.default_rng(seed)
    stamps, told = np.arange(0.05, lift.end - 0.04, 0.05), np.linspace(0.0, lift.end, 201)
    tip = flexarm.simulate(arm, lift, step=step).at(stamps, "tip") + 2e-5 * rng.normal(size=(len(stamps), 3))
    stroke = flexarm.Signal(
        name="stroke", quantity="joint_angle", joint="piston", side="motor", unit="m", time=told,
        values=lift.joints["piston"](told) + 1e-6 * rng.normal(size=len(told)), noise_std=1e-6,
    )  # fmt: skip
    seen = flexarm.Signal(
        name="tip", quantity="position", point="tip", time=stamps, values=tip, noise_std=2e-5
    )
    return flexarm.Record(signals=[stroke, seen], drive="stroke")


CRANK, COUPLER, ROCKER, GROUND = 0.4, 1.1, 0.8, 1.0
"""Lengths of the bars of `four_bar` [m]; the shortest turns round."""


def four_bar(cut: str, make: Callable[..., dict[str, Any]] = bar, **more: Any) -> flexarm.Arm:
    """Return a crank and rocker in the plane, pins A and D on the ground, B and C between uniform bars.

    Parameters
    ----------
    cut : {"B", "C", "D"}
        The pin that is a closure; the others are joints.
    make : callable
        Makes the crank from its name, length and mass, such as `beam_of`; the others are rigid.
    more : dict
        More tables of the model.
    """
    crank, coupler, rocker = (
        make("crank", CRANK, 2.0),
        bar("coupler", COUPLER, 3.0),
        bar("rocker", ROCKER, 4.0),
    )
    along, across = (COUPLER, 0, 0), (ROCKER, 0, 0)
    flexible = crank["type"] == "beam"
    joints = [
        hinge("A", "base", "crank"),
        hinge(
            "B", "crank", "coupler", (0, 0, 0) if flexible else (CRANK, 0, 0), "end" if flexible else "start"
        ),
        hinge("C", "coupler", "rocker", along),
    ]
    middle = {"crank": CRANK / 2, "coupler": COUPLER / 2, "rocker": ROCKER / 2}
    end_of_rocker = (ROCKER, 0, 0)
    if cut == "D":
        closure = pin("D", "rocker", end_of_rocker, "base", (GROUND, 0, 0))
    else:
        joints[2] = hinge("D", "base", "rocker", (GROUND, 0, 0))
        closure = pin("C", "coupler", along, "rocker", across)
    if cut == "B":
        joints[1] = hinge("C", "rocker", "coupler", across)
        closure = pin("B", "coupler", along, "crank", (CRANK, 0, 0))
    return flexarm.Arm.from_dict(
        {
            "name": f"four-bar cut at {cut}",
            "links": [crank, coupler, rocker],
            "joints": joints,
            "closures": [closure],
            "points": [{"name": name, "link": name, "position": [x, 0, 0]} for name, x in middle.items()],
            **more,
        }
    )


def assembled(cut: str, angle: float) -> dict[str, float]:
    """Return a pose of `four_bar` near one at an angle of the crank, rocker upwards."""
    b = CRANK * np.array([np.cos(angle), np.sin(angle)])
    to_d = np.array([GROUND, 0]) - b
    span = np.hypot(*to_d)
    at_b = np.arccos((span**2 + COUPLER**2 - ROCKER**2) / (2 * span * COUPLER))
    coupler = float(np.arctan2(to_d[1], to_d[0]) + at_b)
    c = b + COUPLER * np.array([np.cos(coupler), np.sin(coupler)])
    rocker = float(np.arctan2(c[1], c[0] - GROUND))
    if cut == "D":
        return {"A": angle, "B": coupler - angle, "C": rocker + np.pi - coupler}
    if cut == "C":
        return {"A": angle, "B": coupler - angle, "D": rocker}
    return {"A": angle, "D": rocker, "C": coupler + np.pi - rocker}
