"""Mechanisms of the multibody literature, as models."""

from __future__ import annotations

from math import pi
from typing import Any

import loops
import numpy as np

import flexarm
from flexarm.effects import CableTorque

SQUEEZER_START = {
    "beta": -0.0617138900142764496,
    "theta": 0.0,
    "gamma": 0.455279819163070380,
    "delta": 0.487364979543842550,
    "phi": 0.222668390165885885,
    "epsilon": 1.23054744454982119,
    "omega": -0.222668390165885885,
}
"""Angles of Andrews' squeezer at rest at the time 0 [rad]."""
SQUEEZER_END = {
    "beta": 15.81077119629904,
    "theta": -15.75637105984298,
    "gamma": 0.04082224013073101,
    "delta": 0.5244099658805304,
    "phi": -0.5347301163226948,
    "epsilon": 1.048080741042263,
    "omega": 0.5347301163226948,
}
"""The same at 0.03 s, to all digits [rad]: the reference solution of the IVP test set."""


def andrews_squeezer() -> flexarm.Arm:
    """Return Andrews' squeezer: seven bodies in a plane, four loops with that of its spring.

    Data of [Schiehlen1990], in the notation of [HairerWanner1996]: each body's frame turns by its angle. The
    spring is a slide between two pins, without mass. `beta` turns the crank.
    """
    a, b, c = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
    mass = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
    inertia = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
    centre = (
        (92e-5, 0),
        (-115e-4, 0),
        (1043e-5, -1874e-5),
        (0, 1421e-5 - 2e-2),
        (2308e-5, 916e-5),
        (2e-2 - 1421e-5, 0),
        (-449e-5, -1228e-5),
    )
    bodies = zip(mass, inertia, centre, strict=True)
    links: list[dict[str, Any]] = [
        {"name": f"K{k}", "type": "rigid", "mass": m, "com": [x, 0, z], "inertia": [1e-3 * i, i, i]}
        for k, (m, i, (x, z)) in enumerate(bodies, 1)
    ]
    links += [
        {"name": name, "type": "rigid", "mass": 0.0, "com": [0, 0, 0], "inertia": [0, 0, 0]}
        for name in ("barrel", "plunger")
    ]
    slide = {"name": "spring", "type": "prismatic", "parent": "barrel", "child": "plunger", "axis": [1, 0, 0]}

    def at(x: float, z: float) -> tuple[float, float, float]:
        return (x, 0, z)

    joints = [
        loops.hinge("beta", "base", "K1"),
        loops.hinge("theta", "K1", "K2", at(7e-3, 0)),
        loops.hinge("gamma", "base", "K3", at(*b)),
        loops.hinge("delta", "base", "K5", at(*a)),
        loops.hinge("phi", "K5", "K4", at(4e-2, 0)),
        loops.hinge("epsilon", "base", "K7", at(*a)),
        loops.hinge("omega", "K7", "K6", at(0, -4e-2)),
        loops.hinge("C", "base", "barrel", at(*c)),
        slide,
    ]
    closures = [
        loops.pin("E3", "K3", at(0, -35e-3), "K2", at(-28e-3, 0)),
        loops.pin("E4", "K4", at(0, -2e-2), "K2", at(-28e-3, 0)),
        loops.pin("E6", "K6", at(2e-2, 0), "K2", at(-28e-3, 0)),
        loops.pin("D", "plunger", at(0, 0), "K3", at(2e-2, -18e-3)),
    ]
    gamma = SQUEEZER_START["gamma"]
    turned = np.array([[np.cos(gamma), -np.sin(gamma)], [np.sin(gamma), np.cos(gamma)]])
    span = np.array(b) + turned @ [2e-2, -18e-3] - c
    spring = {"C": float(np.arctan2(span[1], span[0])), "spring": float(np.hypot(*span))}
    model = flexarm.Arm.from_dict(
        {
            "name": "Andrews' squeezer",
            "gravity": [0, 0, 0],
            "links": links,
            "joints": joints,
            "closures": closures,
            "assembly": SQUEEZER_START | spring,
        }
    )
    return model.with_effect(CableTorque(at="spring", stiffness=4530.0, rest_angle=0.07785))


def four_bar_windows(n: int) -> flexarm.Arm:
    """Return n four-bars side by side: n + 1 cranks on the ground and n couplers, bars of 1 m and 1 kg.

    Crank 0 stands upright. Wherever all bars are in line, the mechanism has n + 1 freedoms for an instant.
    """
    cranks = [f"crank{k}" for k in range(n + 1)]
    couplers = [f"coupler{k}" for k in range(n)]
    return flexarm.Arm.from_dict(
        {
            "name": f"{n} four-bars",
            "links": [loops.bar(name, 1.0, 1.0) for name in (*cranks, *couplers)],
            "joints": [
                *(loops.hinge(f"A{k}", "base", name, (k, 0, 0)) for k, name in enumerate(cranks)),
                *(loops.hinge(f"B{k}", cranks[k], name, (1, 0, 0)) for k, name in enumerate(couplers)),
            ],
            "closures": [
                loops.pin(f"C{k}", name, (1, 0, 0), cranks[k + 1], (1, 0, 0))
                for k, name in enumerate(couplers)
            ],
            "assembly": {f"A{k}": pi / 2 for k in range(n + 1)} | {f"B{k}": -pi / 2 for k in range(n)},
        }
    )


def bricard() -> flexarm.Arm:
    """Return Bricard's mechanism: six hinges along six edges of a cube, each across its two bars.

    Five uniform bars of 1 m and 1 kg and the ground. Gruebler's formula counts no freedom, but it has one.
    """
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1), (0, 0, 1)], dtype=float)
    edges = np.roll(corners, -1, axis=0) - corners
    axes = np.cross(np.roll(edges, 1, axis=0), edges)
    links, joints = [], []
    for k in range(5):
        inertia = 1.0 / 12 * (1 + 1e-3 - edges[k] ** 2)
        links.append(
            {
                "name": f"rod{k}",
                "type": "rigid",
                "mass": 1.0,
                "com": list(edges[k] / 2),
                "inertia": list(map(float, inertia)),
            }
        )
        joints.append(
            {
                "name": f"h{k}",
                "type": "revolute",
                "parent": f"rod{k - 1}" if k else "base",
                "child": f"rod{k}",
                "origin": {"xyz": list(edges[k - 1]) if k else [0, 0, 0]},
                "axis": list(axes[k]),
            }
        )
    closure = {"name": "h5", "type": "revolute", "axis": list(axes[5]), "a": "rod4", "b": "base"}
    closure |= {"a_origin": {"xyz": list(edges[4])}, "b_origin": {"xyz": list(corners[5])}}
    return flexarm.Arm.from_dict(
        {
            "name": "Bricard's mechanism",
            "gravity": [0, -9.81, 0],
            "links": links,
            "joints": joints,
            "closures": [closure],
            "points": [{"name": "P3", "link": "rod2", "position": list(edges[2])}],
        }
    )
