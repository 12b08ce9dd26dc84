"""Arms on the solid hinge.

In both, the tube begins at the hub's arm flange, and the load stays at 3 m from the hinge axis, where it is
without a solid hinge: the rigid tip is (3 sin q, 0, 3 cos q).

`solid_arm` is the finite-element model: all three groups are super-elements, and a gear ties the hinge to the
motor's shaft, which turns in the housing. `bench_arm` has the reducer as a spring in the hinge's drive train,
with the torsional stiffness of the reduced part, so that friction of the bearing can act between housing and
hub, in parallel with the reducer. (A tree of links has no place for a bearing beside a solid reducer: it
would close a loop.) There the cross-roller ring carries everything but the torque.

The models that ship with flexarm: Table 1 of the paper prints a section area of 5.92e-5 m2 beside a wall of
3.25e-3 m and I = 2.37e-7 m4, which give an outside diameter of 60.24 mm and an area of 5.82e-4 m2. Both are
there by name.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.link import Beam
from flexarm.effects import JointCompliance
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from flexarm.mockup.hinge import SolidHinge

Tables = dict[str, Any]

AXIS = [0.0, 1.0, 0.0]


def solid_arm(hinge: SolidHinge, like: Arm | None = None) -> Arm:
    """Return the finite-element model: the solid hinge with tube, load and points of another model.

    That model, by default `model()`, has links `tube`, payload and points on it. Its `joint_compliance` and
    whatever else acts at its hinge are left out: the parts take their place.
    """
    base = like or model()
    tables = hinge_tables(hinge, base.joint("hinge").gear_ratio)
    return Arm.from_dict(_with_tube(tables, base, hinge, f"{base.name}, solid hinge"))


def bench_arm(hinge: SolidHinge, like: Arm) -> Arm:
    """Return the arm with the reducer as a spring and damper, and the drive effects of another model.

    That has drive train, sensors and controllers, such as `mock_up()`.
    """
    housing, hub = hinge.parts["housing"], hinge.parts["hub"]
    drive = like.joint("hinge").to_plain()
    span = hub.interface("input")[1] - housing.interface("seat")[1]
    reducer = {
        "name": "reducer",
        "link": "housing:seat",
        "position": [0.0, 0.0, 0.0],
        "mass": hinge.parts["reducer"].mass_total,
    }
    tables: Tables = {
        "joints": [
            _mount(hinge),
            {**drive, "parent": "housing:seat", "child": "hub:input", "origin": {"xyz": span.tolist()}},
        ],
        "links": [_part(hinge, "housing"), _part(hinge, "hub")],
        "payloads": [*_rigid_bodies(hinge), reducer],
        "sensors": [sensor.to_plain() for sensor in like.sensors],
        "controllers": [controller.to_plain() for controller in like.controllers],
    }
    arm = Arm.from_dict(_with_tube(tables, like, hinge, f"{like.name}, reducer as a spring"))
    stiffness = shaft_stiffness(hinge)
    spring = JointCompliance(
        at="hinge", stiffness=stiffness, damping=hinge.design.damping_time.reducer * stiffness
    )
    for effect in like.effects:
        arm = arm if effect.name == "joint_compliance" else arm.with_effect(effect)
    return arm.with_effect(spring)


def shaft_stiffness(hinge: SolidHinge) -> float:
    """Return the torsional stiffness of the reducer between its interfaces, all else free [N m/rad]."""
    part = hinge.parts["reducer"]
    held = part.stiffness[6:12, 6:12]  # of the second interface, the first one held
    return float(1 / np.linalg.inv(held)[4, 4])  # rotation about y


def hinge_tables(hinge: SolidHinge, ratio: float = 120.0) -> Tables:
    """Return the joints, gear, links and rigid bodies of the hinge alone."""
    rigid = hinge.design.rigid
    return {
        "joints": [
            _mount(hinge),
            {
                "name": "motor_shaft",
                "type": "revolute",
                "parent": "housing:motor",
                "child": "rotor",
                "axis": AXIS,
            },
            {"name": "seat", "type": "fixed", "parent": "housing:seat", "child": "reducer:input"},
            {
                "name": "hinge",
                "type": "revolute",
                "parent": "reducer:output",
                "child": "hub:input",
                "axis": AXIS,
            },
        ],
        "gears": [{"name": "reduction", "input": "motor_shaft", "output": "hinge", "ratio": ratio}],
        "links": [
            *(_part(hinge, name) for name in hinge.parts),
            {
                "name": "rotor",
                "type": "rigid",
                "mass": rigid.rotor_mass,
                # a body of revolution about y; across it a shaft as long as it is thick
                "inertia": [rigid.rotor_inertia, rigid.rotor_inertia, rigid.rotor_inertia],
            },
        ],
        "payloads": _rigid_bodies(hinge),
    }


def _with_tube(tables: Tables, like: Arm, hinge: SolidHinge, name: str) -> Tables:
    """Add tube, load and points of another model, all as far from the hinge axis."""
    tube = like.link("tube")
    assert isinstance(tube, Beam)
    start = hinge.design.hub.flange_radius
    shorter = tube.replace(end=_from(tube.end, start))
    loads = [{**load.to_plain(), "position": _from(load.position, start)} for load in like.payloads]
    points = [{**point.to_plain(), "position": _from(point.position, start)} for point in like.points]
    weld = {"name": "weld", "type": "fixed", "parent": "hub:output", "child": "tube"}
    return {
        "format": "flexarm-arm/1",
        "gravity": list(like.gravity),
        **tables,
        "name": name,
        "joints": [*tables["joints"], weld],
        "links": [*tables["links"], shorter.to_plain()],
        "payloads": [*tables["payloads"], *loads],
        "points": points,
    }


def _from(position: tuple[float, float, float], start: float) -> list[float]:
    """Return a place on the tube, measured from its start."""
    x, y, z = position
    return [x, y, round(z - start, 12)]


def _mount(hinge: SolidHinge) -> Tables:
    place = hinge.parts["housing"].interface("base")[1].tolist()
    return {
        "name": "mount",
        "type": "fixed",
        "parent": "base",
        "child": "housing:base",
        "origin": {"xyz": place},
    }


def _part(hinge: SolidHinge, name: str) -> Tables:
    return {"name": name, "type": "superelement", "file": str(hinge.file(name))}


def _rigid_bodies(hinge: SolidHinge) -> list[Tables]:
    """Return the motor and the halves of the cross-roller ring, lumped at the interfaces that carry them."""
    rigid = hinge.design.rigid
    polar = rigid.ring_mass * rigid.ring_radius**2
    ring = {"mass": rigid.ring_mass, "inertia": [polar / 2, polar, polar / 2], "position": [0.0, 0.0, 0.0]}
    return [
        {"name": "motor", "link": "housing:motor", "position": [0.0, 0.0, 0.0], "mass": rigid.motor_mass},
        {"name": "ring-fixed", "link": "housing:seat", **ring},
        {"name": "ring-turning", "link": "hub:input", **ring},
    ]


FOLDER = Path(__file__).parent
PARAMETER_SETS = {"consistent": "model.toml", "printed": "model-printed-area.toml"}
"""Parameter sets of Table 1, files in `FOLDER`: the area that wall and I give (default), and as printed."""


def model(parameters: str = "consistent") -> Arm:
    """Return the model that is compared with the mock-up.

    Parameters
    ----------
    parameters : {"consistent", "printed"}
        Section area 5.82e-4 m2 (rod 13.7 kg) or, as printed, 5.92e-5 m2 (rod 1.4 kg).

    Examples
    --------
    >>> flexarm.mockup.model().link("tube").section  # doctest: +SKIP
    """
    if parameters not in PARAMETER_SETS:
        raise InvalidParameter(f"must be one of {', '.join(PARAMETER_SETS)}, got {parameters!r}")
    return Arm.from_toml(FOLDER / PARAMETER_SETS[parameters])


def mock_up() -> Arm:
    """Return the model behind the virtual measurement, with its controller."""
    return Arm.from_toml(FOLDER / "mockup.toml")
