"""Mechanisms of the multibody literature, as models."""

from __future__ import annotations

from math import pi
from typing import Any

import loops
import numpy as np
from scipy.integrate import solve_ivp

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


CRANK_PIN, CRANK_LENGTH, ROD_LENGTH = np.array([0.0, 0.1, 0.12]), 0.08, 0.3
"""Pin of the crank of `spatial_slider_crank`, and lengths [m]; the slider moves along the x axis."""


def spatial_slider_crank(pin: np.ndarray) -> flexarm.Arm:
    """Return the spatial slider-crank of the library of the IFToMM, crank upright, slider at x = 0.2 m.

    Crank of 0.12 kg about x, rod of 0.5 kg in a ball at its end and in a cross at the slider of 2 kg. The
    cross turns about x in the slider and about the axis `pin` in the rod. Data of the test model of EXUDYN.
    """
    centre, eye = np.array([0.2, 0, 0]), CRANK_PIN + np.array([0, 0, CRANK_LENGTH])
    rod = eye - centre
    along = np.outer(rod, rod) / ROD_LENGTH**2
    across = 4e-3 * np.eye(3) - 3.6e-3 * along

    def body(name: str, mass: float, com: Any, inertia: Any) -> dict[str, Any]:
        numbers = {"com": list(map(float, com)), "inertia": list(map(float, inertia))}
        return {"name": name, "type": "rigid", "mass": mass, **numbers}

    def joint(
        name: str, kind: str, parent: str, child: str, axis: Any, xyz: Any = (0, 0, 0)
    ) -> dict[str, Any]:
        place = {"axis": list(map(float, axis)), "origin": {"xyz": list(map(float, xyz))}}
        return {"name": name, "type": kind, "parent": parent, "child": child, **place}

    ball = {"name": "B", "type": "spherical", "a": "crank", "a_origin": {"xyz": [0, 0, CRANK_LENGTH]}}
    return flexarm.Arm.from_dict(
        {
            "name": "spatial slider-crank",
            "gravity": [0, 0, -9.81],
            "links": [
                body("crank", 0.12, (0, 0, 0), (1e-4, 1e-5, 1e-4)),
                body("slider", 2.0, (0, 0, 0), (1e-4, 1e-4, 1e-4)),
                body("cross", 0.0, (0, 0, 0), (0, 0, 0)),
                body("rod", 0.5, rod / 2, (*np.diag(across), across[0, 1], across[0, 2], across[1, 2])),
            ],
            "joints": [
                joint("A", "revolute", "base", "crank", (1, 0, 0), CRANK_PIN),
                joint("D", "prismatic", "base", "slider", (1, 0, 0)),
                joint("roll", "revolute", "slider", "cross", (1, 0, 0)),
                joint("pin", "revolute", "cross", "rod", pin),
            ],
            "closures": [ball | {"b": "rod", "b_origin": {"xyz": list(map(float, rod))}}],
            "assembly": {"A": 0.0, "D": 0.2, "roll": 0.0, "pin": 0.0},
            "points": [
                {"name": "end_of_crank", "link": "crank", "position": [0, 0, CRANK_LENGTH]},
                {"name": "end_of_rod", "link": "rod", "position": list(map(float, rod))},
            ],
        }
    )


class SliderCrankEquation:
    """The one equation of `spatial_slider_crank`: J q'' + J' q'^2/2 + V' = 0, q the crank's angle.

    The pin keeps the angle with x that it has in the cross, which gives the rod's roll.
    """

    def __init__(self, pin: np.ndarray) -> None:
        self.lean, self.side = pin[0], 1.0
        self.side = 1.0 if np.allclose(self.pose(0.0)[3], pin) else -1.0

    def pose(self, q: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the crank's end, the slider, the direction from one to the other, and the pin."""
        eye = CRANK_PIN + CRANK_LENGTH * np.array([0, -np.sin(q), np.cos(q)])
        slider = np.array([np.sqrt(ROD_LENGTH**2 - eye[1] ** 2 - eye[2] ** 2), 0, 0])
        d = (slider - eye) / ROD_LENGTH
        n = np.array([1.0, 0, 0]) - d[0] * d
        part = self.lean / (n @ n)
        rest = self.side * np.sqrt(max(1 - part**2 * (n @ n), 0) / (n @ n))
        return eye, slider, d, part * n + rest * np.cross(d, n)

    def speeds(self, q: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return velocities of the crank's end and the slider and the rod's angular one, by q'."""
        eye, slider, d, pin = self.pose(q)
        x = np.array([1.0, 0, 0])
        v_eye = np.cross(x, eye - CRANK_PIN)
        v_slider = -(eye @ v_eye - eye[0] * v_eye[0]) / slider[0] * x
        turning = np.stack([np.cross(x, -d), np.cross(pin, -d)], axis=1) * ROD_LENGTH
        a, b = np.linalg.lstsq(turning, v_eye - v_slider, rcond=None)[0]
        return v_eye, v_slider, a * x + b * pin

    def inertia(self, q: float) -> float:
        """Return J [kg m2]."""
        v_eye, v_slider, w = self.speeds(q)
        v, along = (v_eye + v_slider) / 2, w @ self.pose(q)[2]
        rod = 0.5 * v @ v + 4e-3 * w @ w - 3.6e-3 * along**2
        return 1e-4 + 2 * v_slider @ v_slider + rod

    def run(self, time: np.ndarray) -> np.ndarray:
        """Return q at times, begun with 6 rad/s."""

        def slope(f: Any, q: float, h: float = 1e-5) -> float:
            return (f(q + h) - f(q - h)) / (2 * h)

        def change(t: float, y: np.ndarray) -> list[float]:
            weight = 9.81 * 0.5 / 2 * slope(lambda q: self.pose(q)[0][2], y[0])
            return [y[1], -(0.5 * slope(self.inertia, y[0]) * y[1] ** 2 + weight) / self.inertia(y[0])]

        return solve_ivp(change, (0, time[-1]), [0, 6], "DOP853", time, rtol=1e-9, atol=1e-10).y[0]
