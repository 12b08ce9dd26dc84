"""Joint dynamics written into a URDF file.

URDF has `<dynamics damping="" friction="">`: viscous [N m s/rad] and dry friction [N m] of a rigid joint.
What it has no word for stands in an element `<flexarm stiffness="" damping="" rotor_inertia=""
gear_ratio="">` of the joint, which other readers pass over: stiffness and damping of the reducer, output
side, and the rotor, motor side.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.arguments import takes
from flexarm.export.joint_dynamics import JointDynamics, joint_dynamics, left_out, not_written, own_friction
from flexarm.export.robot_file import add, number, read_robot, refuse_no_joint, remove, write_robot

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from flexarm.arm import Arm


@takes()
def export_urdf(arm: Arm, urdf: str | Path, out: str | Path, force: bool = True) -> list[str]:
    """Write a URDF file again, with the friction, stiffness and rotors of a model's joints.

    Parameters
    ----------
    arm : Arm
        The model; its joints are found by their names.
    urdf : str or Path
        The file to read.
    out : str or Path
        The file to write.
    force : bool
        Replace a file that exists.

    Returns
    -------
    list of str
        What was not written, and why.

    Raises
    ------
    InvalidFile
        If the file is no URDF, has none of the model's joints, or `out` cannot be written.
    """
    from xml.etree.ElementTree import Element

    path, file, notes, written = Path(urdf), read_robot(Path(urdf), "robot"), [], 0
    joints = {name: joint for joint in file.root.findall("joint") if (name := joint.get("name"))}
    wanted = list(joint_dynamics(arm))
    notes += not_written(arm)
    for dynamics in wanted:
        joint = joints.get(dynamics.joint)
        if joint is None:
            notes.append(f"joint {dynamics.joint} is not in {path.name}")
            continue
        written += 1
        notes += left_out(dynamics)
        stated = {"viscous": ("damping", dynamics.viscous), "dry": ("friction", dynamics.dry)}
        friction = dict(stated[kind] for kind in sorted(dynamics.states, reverse=True))
        element = joint.find("dynamics")
        notes += own_friction(dynamics, {} if element is None else element.attrib, "damping", "friction")
        if element is None and any(friction.values()):
            element = Element("dynamics")
            add(joint, element)
        if element is not None:
            element.attrib.update({key: number(value) for key, value in friction.items()})
        _write_own(joint, dynamics)
    refuse_no_joint(path, [dynamics.joint for dynamics in wanted], list(joints), written)
    write_robot(file, Path(out), [path], force)
    return notes


def _write_own(joint: Element, dynamics: JointDynamics) -> None:
    """Write what URDF has no word for; an element of an earlier export is replaced."""
    from xml.etree.ElementTree import Element

    for old in joint.findall("flexarm"):
        remove(joint, old)
    values: dict[str, float] = {}
    if dynamics.elastic:
        values |= {"stiffness": dynamics.stiffness, "damping": dynamics.damping}
    if dynamics.rotor_inertia > 0:
        values |= {"rotor_inertia": dynamics.rotor_inertia, "gear_ratio": dynamics.gear_ratio}
    if values:
        add(joint, Element("flexarm", {key: number(value) for key, value in values.items()}))
