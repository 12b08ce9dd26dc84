r"""Joint dynamics written into a MuJoCo model (MJCF).

An elastic joint becomes two on the same axis, whose angles add: `NAME`, the motor's \varphi with `armature`
J n^2 and its friction, and `NAME_deflection`, \theta - \varphi with `stiffness` k and `damping` c. Friction
of the bearing acts on their sum, by a fixed tendon `NAME_bearing`. So actuators on `NAME` drive the motor,
as in flexarm. A rigid joint keeps its one element, with `armature`, `damping` and `frictionloss`. Source:
MuJoCo, XML Reference, `joint`, `tendon/fixed`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.arguments import takes
from flexarm.export.joint_dynamics import JointDynamics, joint_dynamics, left_out, not_written, own_friction
from flexarm.export.robot_file import add, number, read_robot, refuse_no_joint, remove, write_robot

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from flexarm.arm import Arm

_PLACED = ("class", "type", "pos", "axis", "group", "springdamper")
"""What the deflection has in common with its joint."""


@takes()
def export_mjcf(arm: Arm, mjcf: str | Path, out: str | Path, force: bool = True) -> list[str]:
    """Write a MuJoCo model again, with the friction, stiffness and rotors of a model's joints.

    Parameters
    ----------
    arm : Arm
        The model; its joints are found by their names.
    mjcf : str or Path
        The file to read; files that it includes are not followed.
    out : str or Path
        The file to write.
    force : bool
        Replace a file that exists.

    Returns
    -------
    list of str
        What was not written, and why. Compliance needs a rotor's inertia, since MuJoCo has no angle without
        one.

    Raises
    ------
    InvalidFile
        If the file is no MJCF, has none of the model's joints, or `out` cannot be written.
    """
    path, file, notes, written = Path(mjcf), read_robot(Path(mjcf), "mujoco"), [], 0
    root = file.root
    joints = {
        name: (parent, joint, stated)
        for world in root.findall("worldbody")
        for parent, joint, stated in _joints(world, "main", _defaults(root))
        if (name := joint.get("name"))
    }
    wanted = list(joint_dynamics(arm))
    notes += not_written(arm)
    for dynamics in wanted:
        if dynamics.joint not in joints:
            notes.append(f"joint {dynamics.joint} is not in {path.name}")
            continue
        written += 1
        notes += left_out(dynamics)
        parent, joint, stated = joints[dynamics.joint]
        _remove_earlier(root, parent, dynamics.joint)
        notes += own_friction(dynamics, stated, "damping", "frictionloss")
        notes += _replace_springdamper(dynamics, joint, stated)
        if dynamics.elastic and dynamics.armature > 0:
            if stated.get("stiffness", "").strip("0."):
                what = f"stiffness {stated['stiffness']} of the file is replaced by its joint_compliance"
                notes.append(f"joint {dynamics.joint}: {what}")
            _write_elastic(root, parent, joint, dynamics)
            continue
        if dynamics.elastic:
            what = "its joint_compliance is not written; give the joint a rotor_inertia"
            notes.append(f"joint {dynamics.joint}: {what}")
        if dynamics.armature > 0:
            _set(joint, armature=dynamics.armature)
        _set_friction(joint, dynamics, dynamics.viscous, dynamics.dry)
    refuse_no_joint(path, [dynamics.joint for dynamics in wanted], list(joints), written)
    write_robot(file, Path(out), [path], force)
    return notes


def _joints(
    parent: Element, of_class: str, defaults: Mapping[str, dict[str, str]]
) -> Iterator[tuple[Element, Element, dict[str, str]]]:
    """Yield each joint, the body or frame in which it stands, and its attributes with those of its class."""
    for child in parent:
        if child.tag == "joint":
            yield parent, child, defaults.get(child.get("class", of_class), {}) | child.attrib
        elif child.tag in ("body", "frame", "replicate"):
            yield from _joints(child, child.get("childclass", of_class), defaults)


def _defaults(root: Element) -> dict[str, dict[str, str]]:
    """Return the attributes that each class gives to its joints; a class has those of the one around it."""
    found: dict[str, dict[str, str]] = {}

    def take(default: Element, outer: dict[str, str]) -> None:
        own = outer.copy()
        for joint in default.findall("joint"):
            own |= joint.attrib
        found[default.get("class", "main")] = own
        for inner in default.findall("default"):
            take(inner, own)

    for default in root.findall("default"):
        take(default, found.get("main", {}))
    return found


def _write_elastic(root: Element, parent: Element, joint: Element, dynamics: JointDynamics) -> None:
    from xml.etree.ElementTree import Element

    _set(joint, armature=dynamics.armature, stiffness=0.0)
    _set_friction(joint, dynamics, dynamics.motor_viscous, dynamics.motor_dry)
    placed = {key: joint.attrib[key] for key in _PLACED if key in joint.attrib}
    spring = Element("joint", {"name": f"{dynamics.joint}_deflection", **placed, "limited": "false"})
    _set(
        spring,
        stiffness=dynamics.stiffness,
        damping=dynamics.damping,
        armature=0.0,
        frictionloss=0.0,
        springref=0.0,
        ref=0.0,
    )
    spring.tail = joint.tail
    parent.insert(list(parent).index(joint) + 1, spring)
    if not (dynamics.bearing_viscous or dynamics.bearing_dry):
        return
    section = root.find("tendon")
    tendons = Element("tendon") if section is None else section
    if section is None:
        add(root, tendons)
    bearing = Element("fixed", {"name": f"{dynamics.joint}_bearing"})
    add(tendons, bearing)
    _set(bearing, damping=dynamics.bearing_viscous, frictionloss=dynamics.bearing_dry)
    for name in (dynamics.joint, f"{dynamics.joint}_deflection"):
        add(bearing, Element("joint", {"joint": name, "coef": "1"}))


def _remove_earlier(root: Element, parent: Element, joint: str) -> None:
    """Remove the deflection of an earlier export beside a joint, and its tendon."""
    written = [(parent, "joint", f"{joint}_deflection")]
    written += [(tendons, "fixed", f"{joint}_bearing") for tendons in root.findall("tendon")]
    for place, tag, name in written:
        for child in place.findall(tag):
            if child.get("name") == name:
                remove(place, child)


def _replace_springdamper(dynamics: JointDynamics, joint: Element, stated: dict[str, str]) -> list[str]:
    """Return a note on a `springdamper`, which MuJoCo takes in place of stiffness and damping."""
    value = stated.get("springdamper", "")
    if not value.strip("0. "):
        return []
    told = f"joint {dynamics.joint}: springdamper {value} of the file"
    if "viscous" in dynamics.states or (dynamics.elastic and dynamics.armature > 0):
        joint.set("springdamper", "0 0")
        return [f"{told} is replaced by stiffness and damping"]
    return [f"{told} stays, as the model has no viscous friction"]


def _set_friction(joint: Element, dynamics: JointDynamics, viscous: float, dry: float) -> None:
    """Write the friction that the model has; what it has none of stays as the file has it."""
    stated = {"viscous": {"damping": viscous}, "dry": {"frictionloss": dry}}
    for kind in dynamics.states:
        _set(joint, **stated[kind])


def _set(element: Element, **values: float) -> None:
    element.attrib.update({key: number(value) for key, value in values.items()})
