"""Robots (robot.py) as serial chains of rigid rods.

A link is cut at the two Gauss points of each of n equal segments, with springs EI/w and GJ/w, w = L/(2 n),
for bending and twist, and at its middle with EA/L for stretch: forces at its end move and turn the ends of
segments as they do a beam's (chain.py). A bow is a uniform curvature, rest = w 2 u/L^2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from hub import Hub
from robot import Block, Robot, Slosh, Tube
from serial_chain import Chain, Floats
from serial_motion import Hubs

AXES = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class Built:
    """A chain, its reducers, and where a fraction of a link is: degree of freedom, offset in its body."""

    chain: Chain
    hubs: Hubs
    stations: Mapping[tuple[str, float], tuple[int, Floats]]


class _Rows:
    """Rows of a chain while it is built; `ahead` is what lies between the last joint and the next one."""

    def __init__(self) -> None:
        self.rows: list[dict[str, object]] = []
        self.ahead = np.zeros(3)

    def joint(self, axis: str, slides: bool = False, **spring: float) -> int:
        """Adds a degree of freedom without a mass."""
        row = dict(slides=slides, axis=AXES[axis], offset=self.ahead, mass=0.0, com=np.zeros(3))
        row |= dict(
            inertia=np.zeros((3, 3)), stiffness=0.0, damping=0.0, rest=0.0, rest_time=0.0, hardening=0.0
        )
        self.rows.append(row | spring)
        self.ahead = np.zeros(3)
        return len(self.rows) - 1

    def body(self, mass: float, com: Floats, inertia: Floats) -> None:
        """Adds a body to the last joint, `com` from what lies ahead."""
        row, where = self.rows[-1], self.ahead + com
        total = row["mass"] + mass
        if total == 0:
            return
        centre = (row["mass"] * row["com"] + mass * where) / total
        both = row["inertia"] + _about(row["mass"], row["com"] - centre) + inertia
        row |= dict(mass=total, com=centre, inertia=both + _about(mass, where - centre))


def _about(mass: float, r: Floats) -> Floats:
    return mass * (r @ r * np.eye(3) - np.outer(r, r))


def build(robot: Robot) -> Built:
    rows, stations, driven = _Rows(), {}, []
    shaken = -1
    if np.isfinite(robot.base.stiffness):
        spring = dict(stiffness=robot.base.stiffness, damping=robot.base.damping)
        shaken = rows.joint(robot.turns[0].axis, **spring)
    for turn in robot.turns:
        rows.ahead = rows.ahead + turn.origin
        driven.append(rows.joint(turn.axis))
        stations[turn.link_name, 0.0] = driven[-1], np.zeros(3)
        if isinstance(turn.link, Block):
            rows.body(turn.link.mass, np.array(turn.link.com), np.diag(turn.link.inertia))
            rows.ahead = np.array(turn.link.end)
        else:
            _lay(rows, stations, turn.link_name, turn.link, robot.planar)
    tip = rows.ahead
    if robot.slosh is not None:
        _hang(rows, robot.slosh)
    free = [k for k in range(len(rows.rows)) if k not in driven]
    free += [k for k, turn in zip(driven, robot.turns, strict=True) if not turn.hub.rigid]
    chain = Chain(
        **{name: np.array([row[name] for row in rows.rows]) for name in rows.rows[0]},
        free=np.array(sorted(free)),
        turn=_rotation(*robot.tilt),
        gravity=np.array([0.0, 0.0, -robot.gravity]),
        drag=float(robot.drag),
        tip=tip,
        shaken=shaken,
    )
    return Built(chain, _hubs([turn.hub for turn in robot.turns], driven), stations)


def _rotation(x: float, y: float) -> Floats:
    """Of the rotation vector (x, y, 0)."""
    angle = np.hypot(x, y)
    if angle == 0:
        return np.eye(3)
    u = np.array([[0, 0, y], [0, 0, -x], [-y, x, 0]]) / angle
    return np.eye(3) + np.sin(angle) * u + (1 - np.cos(angle)) * u @ u


def _lay(rows: _Rows, stations: dict, name: str, tube: Tube, planar: bool) -> None:
    """Rods, springs and the load of one link, along z."""
    n, eta = tube.segments, tube.retardation
    half = 0.5 / np.sqrt(3)
    cuts = [(fraction, "bends") for fraction in ((i + 0.5 + s * half) / n for i in range(n) for s in (-1, 1))]
    cuts = [*sorted([*cuts, (0.5, "stretches")]), (1.0, "ends")]
    w, here = tube.length / (2 * n), 0.0
    for fraction, event in cuts:
        _rod(rows, tube, (fraction - here) * tube.length)
        here = fraction
        time = dict(rest_time=tube.bow_time)
        if event == "stretches":
            stations[name, 0.5] = len(rows.rows) - 1, rows.ahead
            k = tube.EA / tube.length
            rows.joint("z", True, stiffness=k, damping=eta * k, rest=tube.growth, **time)
        elif event == "bends":
            k, rest = tube.EI / w, w * 2 / tube.length**2
            soft = dict(stiffness=k, damping=eta * k, hardening=tube.hardening, **time)
            rows.joint("y", rest=rest * tube.bow[0], **soft)
            if not planar:
                rows.joint("x", rest=-rest * tube.bow[1], **soft)
                rows.joint("z", stiffness=tube.GJ / w, damping=eta * tube.GJ / w)
    stations[name, 1.0] = len(rows.rows) - 1, rows.ahead
    rows.body(tube.load.mass, np.array(tube.load.offset), tube.load.inertia * np.eye(3))


def _rod(rows: _Rows, tube: Tube, length: float) -> None:
    mass = tube.rho_A * length
    across, along = mass * length**2 / 12, 2 * tube.rho_I * length
    rows.body(mass, np.array([0, 0, length / 2]), np.diag([across, across, along]))
    rows.ahead = rows.ahead + np.array([0, 0, length])


def _hang(rows: _Rows, slosh: Slosh) -> None:
    omega = 2 * np.pi * slosh.frequency
    damping = 2 * slosh.damping_ratio * omega * slosh.mass
    rows.joint("x", True, stiffness=slosh.mass * omega**2, damping=damping)
    rows.body(slosh.mass, np.zeros(3), np.zeros((3, 3)))


def _hubs(hubs: list[Hub], dofs: list[int]) -> Hubs:
    def each(name: str) -> Floats:
        return np.array([float(getattr(hub, name)) for hub in hubs])

    rigid = np.array([hub.rigid for hub in hubs])
    own = {"dof", "rigid", "stiffness", "width"}
    same = [name for name in Hubs._fields if name not in own]
    stiffness = np.where(rigid, 0.0, each("stiffness"))
    width = each("hysteresis_width")
    return Hubs(np.array(dofs), rigid, stiffness, width=width, **{name: each(name) for name in same})
