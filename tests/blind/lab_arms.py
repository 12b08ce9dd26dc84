"""The arms of the blind tests, once as a robot of rods and once as flexarm's model: one table of numbers.

`hinged`: one tube on a hinge; `planar`: shoulder and elbow about y; `spatial`: a waist below them, about z.
Upright and straight at q = 0; tubes are of steel, Euler and Bernoulli's.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from hub import Hub
from robot import Block, Load, Robot, Tube, Turn, Vector

import flexarm

E, NU, DENSITY = 210e9, 0.3, 7850.0


@dataclass(frozen=True)
class TubeTable:
    """Length, outer diameter and wall [m], the load at its end and that load's name."""

    length: float
    diameter: float
    wall: float
    load_name: str
    load: Load

    @property
    def rods(self) -> Tube:
        """The same for robot.py; 2 % of damping."""
        outer, inner = self.diameter / 2, self.diameter / 2 - self.wall
        area, second = np.pi * (outer**2 - inner**2), np.pi / 4 * (outer**4 - inner**4)
        shear_modulus = E / (2 * (1 + NU))
        stiff = dict(EI=E * second, GJ=shear_modulus * 2 * second, EA=E * area)
        return Tube(
            self.length,
            rho_A=DENSITY * area,
            rho_I=DENSITY * second,
            damping_ratio=0.02,
            load=self.load,
            **stiff,
        )


@dataclass(frozen=True)
class JointTable:
    """A joint, what it carries, its reducer; stiffness 0 is a rigid one. Damping is 2e-3 s x stiffness."""

    name: str
    axis: str
    link_name: str
    link: TubeTable | Block
    ratio: float
    rotor: float
    stiffness: float
    origin: Vector = (0.0, 0.0, 0.0)

    @property
    def hub(self) -> Hub:
        """Reducer of the rods."""
        soft = dict(stiffness=self.stiffness, damping=2e-3 * self.stiffness) if self.stiffness else {}
        return Hub(gear_ratio=self.ratio, rotor_inertia=self.rotor, **soft)


@dataclass(frozen=True)
class Reflector:
    """A point on a link: fraction of its length, and offset there in the link's axes."""

    link: str
    fraction: float
    offset: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class LabArm:
    """An arm of the laboratory.

    Attributes
    ----------
    axes
        What a tracker reads: x and z in the plane.
    reflectors
        All there are; the first is the tip.
    """

    kind: str
    joints: tuple[JointTable, ...]
    reflectors: dict[str, Reflector] = field(hash=False)
    light_load: float

    @property
    def planar(self) -> bool:
        """Whether all joints turn about y."""
        return all(joint.axis == "y" for joint in self.joints)

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes of the tracker."""
        return ("x", "z") if self.planar else ("x", "y", "z")

    @property
    def tubes(self) -> dict[str, TubeTable]:
        """Links that bend, by name."""
        return {joint.link_name: joint.link for joint in self.joints if isinstance(joint.link, TubeTable)}

    @property
    def robot(self) -> Robot:
        """As a chain of rods."""
        turns = tuple(
            Turn(j.name, j.axis, j.link_name, getattr(j.link, "rods", j.link), j.hub, j.origin)
            for j in self.joints
        )
        return Robot(turns, self.planar)

    def model(
        self, rigid: Iterable[str] = (), points: Iterable[str] = (), effects: Iterable[dict] = ()
    ) -> flexarm.Arm:
        """flexarm's model: joints without compliance, reflectors (all unless named), further effects."""
        points = tuple(points) or tuple(self.reflectors)
        soft = [j for j in self.joints if j.stiffness and j.name not in rigid]
        compliances = [
            {
                "name": "joint_compliance",
                "at": j.name,
                "stiffness": j.stiffness,
                "damping": 2e-3 * j.stiffness,
            }
            for j in soft
        ]
        tubes = self.tubes
        uncertain = {f"links.{name}.material.youngs_modulus": 0.01 for name in tubes}
        uncertain |= {"payloads.load.mass": 0.005} | {f"points.{name}.position_m": 5e-4 for name in points}
        return flexarm.Arm.from_dict(
            {
                "format": "flexarm-arm/1",
                "name": self.kind,
                "gravity": [0, 0, -9.81],
                "joints": self._joint_tables(),
                "links": [_link_table(j.link_name, j.link) for j in self.joints],
                "payloads": [_payload(name, tube) for name, tube in tubes.items() if tube.load.mass],
                "points": [_point(name, self.reflectors[name], tubes) for name in points],
                "effects": [*compliances, *effects],
                "uncertainty": uncertain,
            }
        )

    def _joint_tables(self) -> list[dict]:
        tables, parent, at = [], "base", "start"
        for joint in self.joints:
            table = {"name": joint.name, "type": "revolute", "parent": parent, "child": joint.link_name}
            table |= {"axis": [float(axis == joint.axis) for axis in "xyz"], "gear_ratio": joint.ratio}
            table |= {"rotor_inertia": joint.rotor, "origin": {"xyz": list(joint.origin)}, "at": at}
            tables.append(table)
            parent, at = joint.link_name, "end" if isinstance(joint.link, TubeTable) else "start"
        return tables


def _link_table(name: str, link: TubeTable | Block) -> dict:
    if isinstance(link, Block):
        return {"name": name, "type": "rigid", "mass": link.mass, "com": link.com, "inertia": link.inertia}
    section = {"shape": "tube", "outer_diameter": link.diameter, "thickness": link.wall}
    material = {"youngs_modulus": E, "poisson_ratio": NU, "density": DENSITY}
    table = {"name": name, "type": "beam", "end": [0, 0, link.length], "section": section, "elements": 4}
    return table | {"theory": "euler-bernoulli", "material": material, "damping_ratio": 0.02}


def _payload(link: str, tube: TubeTable) -> dict:
    place = [*tube.load.offset[:2], tube.length + tube.load.offset[2]]
    inertia = [tube.load.inertia] * 3
    return {
        "name": tube.load_name,
        "link": link,
        "position": place,
        "mass": tube.load.mass,
        "inertia": inertia,
    }


def _point(name: str, reflector: Reflector, tubes: dict[str, TubeTable]) -> dict:
    x, y, z = reflector.offset
    length = tubes[reflector.link].length if reflector.link in tubes else 0.0
    return {"name": name, "link": reflector.link, "position": [x, y, z + reflector.fraction * length]}


HINGED = LabArm(
    "hinged",
    (
        JointTable(
            "hinge",
            "y",
            "rod",
            TubeTable(2.8, 0.058, 3.4e-3, "load", Load(12.5)),
            110,
            1.1e-3,
            1.1e5,
            (0, 0, 0.5),
        ),
    ),
    {
        "tip": Reflector("rod", 1.0),
        "mid": Reflector("rod", 0.5, (0.04, 0.0, 0.0)),
        "hub": Reflector("rod", 0.0, (0.22, 0.0, 0.0)),
    },
    4.0,
)

PLANAR = LabArm(
    "planar",
    (
        JointTable(
            "shoulder",
            "y",
            "upper_arm",
            TubeTable(2.2, 0.088, 4e-3, "elbow_motor", Load(4.5, inertia=0.02)),
            120,
            1.1e-3,
            2.2e5,
            (0, 0, 0.6),
        ),
        JointTable("elbow", "y", "forearm", TubeTable(1.8, 0.058, 3e-3, "load", Load(9.0)), 100, 6e-4, 9e4),
    ),
    {
        "tip": Reflector("forearm", 1.0),
        "forearm_mid": Reflector("forearm", 0.5, (0.03, 0.0, 0.0)),
        "elbow_target": Reflector("upper_arm", 1.0, (0.07, 0.0, 0.0)),
        "shoulder_target": Reflector("upper_arm", 0.0, (0.25, 0.0, 0.0)),
    },
    3.0,
)

SPATIAL = LabArm(
    "spatial",
    (
        JointTable(
            "waist",
            "z",
            "column",
            Block((0, 0, 0), 28.0, (0.02, 0.0, 0.2), (0.9, 0.9, 0.4)),
            150,
            1e-3,
            3e5,
            (0, 0, 0.3),
        ),
        JointTable(
            "shoulder",
            "y",
            "upper_arm",
            TubeTable(1.7, 0.078, 3.5e-3, "elbow_motor", Load(4.0, inertia=0.015)),
            120,
            1e-3,
            2e5,
            (0.12, 0.0, 0.4),
        ),
        JointTable(
            "elbow",
            "y",
            "forearm",
            TubeTable(1.4, 0.058, 3e-3, "load", Load(7.5, (0.0, 0.05, 0.0), 0.02)),
            100,
            5e-4,
            8e4,
        ),
    ),
    {
        "tip": Reflector("forearm", 1.0),
        "forearm_mid": Reflector("forearm", 0.5, (0.03, 0.0, 0.0)),
        "elbow_target": Reflector("upper_arm", 1.0, (0.07, 0.0, 0.0)),
        "waist_target": Reflector("column", 0.0, (0.3, 0.0, 0.1)),
    },
    2.5,
)

LAB_ARMS = {arm.kind: arm for arm in (HINGED, PLANAR, SPATIAL)}
