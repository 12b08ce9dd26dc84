"""From the model through its machine to the assembled system that the core computes with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm import _core
from flexarm.arm import Arm, Closure
from flexarm.arm.inertia import inertia_matrix
from flexarm.arm.joint import Joint, gear_input
from flexarm.arm.link import Beam, RigidLink, SuperElementLink
from flexarm.arm.rotation import Frame, chained, from_rpy
from flexarm.arm.section import General, Rectangle, Round, Tube
from flexarm.assembly.loops import Loops
from flexarm.assembly.machine import (
    Load,
    Machine,
    Member,
    core_hinges,
    machine_of,
    nominal_machine,
    pedestal,
    tilted,
)
from flexarm.errors import InvalidParameter
from flexarm.tables.ranges import out_of_range

_THEORIES = {
    "timoshenko": _core.BeamTheory.timoshenko,
    "euler-bernoulli": _core.BeamTheory.euler_bernoulli,
}


def core_arm(arm: Arm, loaded: Iterable[str] = (), *, nominal: bool = False) -> _core.Arm:
    """Return the arm as the core takes it; `nominal` leaves out effects, for displacements count from there.

    Points that are `loaded` carry point loads; on a beam they get a node of their own.

    Raise InvalidFile or InvalidParameter if the file of a super-element cannot be read.
    """
    machine = nominal_machine(arm) if nominal else machine_of(arm)
    loads = set(loaded)
    return _core.Arm(
        name=arm.name,
        gravity=np.array(arm.gravity),
        links=[_link(member) for member in machine.links.values()],
        joints=[_joint(joint, machine) for joint in arm.joints],
        payloads=[_payload(name, load) for name, load in machine.payloads.items()],
        points=[
            _core.Point(name=name, link=at.link, position=np.array(at.position), loaded=name in loads)
            for name, at in machine.points.items()
        ],
        gears=[_core.Gear(name=g.name, input=g.input, output=g.output, ratio=g.ratio) for g in arm.gears],
        pedestal=pedestal(machine),
        closures=[_closure(closure, machine) for closure in arm.closures],
        assembly=dict(arm.assembly),
    )


def assemble(
    arm: Arm,
    drives: Mapping[str, _core.DriveKind] | None = None,
    loaded: Iterable[str] = (),
    driven: Iterable[str] = (),
    *,
    nominal: bool = False,
) -> _core.System:
    """Assemble the arm, with its effects or `nominal` without them.

    `drives` says what each joint's motor is told; joints left out are locked, outputs of gears are free, and
    so are inputs of gears in series whose output is told. `loaded` are points with point loads, `driven`
    other joints whose drive is held. Joints of loops that are in neither follow, see `assembly.loops`.

    Raise InvalidParameter if a loop cannot be closed.
    """
    given = dict(drives or {})
    kinds = {gear.output: _core.DriveKind.free for gear in arm.gears}
    moved = set(given)
    for _ in arm.gears:  # gears in series
        moved |= {gear.input for gear in arm.gears if gear.output in moved}
    kinds |= dict.fromkeys(moved - given.keys(), _core.DriveKind.free)
    core = core_arm(arm, loaded, nominal=nominal)
    if not arm.closures:
        return _core.System(core, {**kinds, **given})
    kinds |= dict.fromkeys(following_joints(arm, given, driven), _core.DriveKind.free)
    return _core.System(core, {**kinds, **given})


@lru_cache(maxsize=16)
def loops_of(arm: Arm) -> Loops:
    """Return the loops of an arm with closures.

    Raise InvalidParameter if a loop cannot be closed.
    """
    turned = {gear.output: _core.DriveKind.free for gear in arm.gears}
    return Loops.of(arm, _core.System(core_arm(arm), turned))


def following_joints(arm: Arm, drives: Iterable[str], driven: Iterable[str]) -> tuple[str, ...]:
    """Return the joints of loops that follow, at the motors that gears couple to them.

    Joints in `drives` are driven themselves; those in `driven` have a motor held at the input of their gears.
    """
    if not arm.closures:
        return ()
    told = set(drives)
    return loops_of(arm).following({*told, *(gear_input(arm, name) for name in driven if name not in told)})


def joint_values(arm: Arm, joints: Mapping[str, float]) -> list[float]:
    """Return the drive angle of every joint in the model's order: 0 where not given, through gears.

    Joints of loops that are not given stand where the loops were closed first; those that follow are not
    read.

    Raise InvalidParameter if a joint does not exist, does not move, its value is not finite, or contradicts
    its gear.
    """
    moving = [joint.name for joint in arm.moving_joints]
    for name, value in joints.items():
        if name not in moving:
            raise InvalidParameter(
                f"there is no moving joint {name!r}; there are {', '.join(moving) or 'none'}", where="joints"
            )
        if not np.isfinite(value):
            raise InvalidParameter(f"must be finite, got {value}", where=f"joints.{name}")
        unit = "m" if arm.joint(name).type == "prismatic" else "rad"
        if wrong := out_of_range(float(value), unit, size=False):
            raise InvalidParameter(wrong, where=f"joints.{name}")
    values = _through_gears(arm, joints)
    return [float(values.get(joint.name, 0.0)) for joint in arm.joints]


def rigid_values(arm: Arm, joints: Mapping[str, float]) -> list[float]:
    """Return the value of every joint of the rigid arm without effects, those of loops closed.

    Raise InvalidParameter as `joint_values`, and if a loop cannot be closed.
    """
    values = joint_values(arm, joints)
    if not arm.closures:
        return values
    system = assemble(arm, driven=joints, nominal=True)
    return list(_core.joint_angles(system, system.rigid_state(values)))


def _through_gears(arm: Arm, joints: Mapping[str, float]) -> dict[str, float]:
    """Complete values through gears: angle of the input = ratio x angle of the output."""
    values = dict(joints)
    for _ in arm.gears:  # as often as there are gears, for trains of them
        for gear in arm.gears:
            if gear.output in values:
                values.setdefault(gear.input, values[gear.output] * gear.ratio)
            elif gear.input in values:
                values.setdefault(gear.output, values[gear.input] / gear.ratio)
    if arm.closures:
        values = {**loops_of(arm).assembled, **values}
    for gear in arm.gears:
        angle, wanted = values.get(gear.input, 0.0), values.get(gear.output, 0.0) * gear.ratio
        if abs(angle - wanted) > 1e-9 * max(1.0, abs(wanted)):
            raise InvalidParameter(
                f"contradicts gear {gear.name!r}: {gear.output!r} at {values[gear.output]:g} puts it at "
                f"{wanted:g}, got {angle:g}; give one of the two",
                where=f"joints.{gear.input}",
            )
    return values


def point_loads(arm: Arm, forces: Mapping[str, ArrayLike]) -> list[_core.PointLoad]:
    """Return forces at points, base axes [N], as the core takes them.

    Raise InvalidParameter if a point does not exist or a force is not three finite numbers.
    """
    names = [point.name for point in arm.points]
    loads = []
    for name, value in forces.items():
        if name not in names:
            raise InvalidParameter(
                f"there is no point {name!r}; there are {', '.join(names) or 'none'}", where="forces"
            )
        force: NDArray[np.float64] = np.asarray(value, dtype=float)
        if force.shape != (3,) or not np.all(np.isfinite(force)):
            raise InvalidParameter(f"must be three finite numbers [N], got {value!r}", where=f"forces.{name}")
        if wrong := out_of_range(tuple(map(float, force)), "N", size=False):
            raise InvalidParameter(wrong, where=f"forces.{name}")
        loads.append(_core.PointLoad(point=names.index(name), force=force))
    return loads


def _link(member: Member) -> _core.BeamLink | _core.RigidLink | _core.SuperElementLink:
    link = member.table
    if isinstance(link, Beam):
        return _core.BeamLink(
            name=link.name,
            end=np.array(link.end),
            up=np.zeros(3) if link.up is None else np.array(link.up),
            section=_section(link.section),
            material=_core.Material(
                youngs_modulus=link.material.youngs_modulus,
                shear_modulus=link.material.shear_modulus,
                density=link.material.density,
            ),
            theory=_THEORIES[link.theory],
            elements=link.elements,
            damping_ratio=link.damping_ratio,
            bending_scale=member.bending_scale,
            mass_scale=member.mass_scale,
            bow=np.array(member.bow),
            bow_time=member.bow_time,
            curvature=member.curvature,
        )
    if isinstance(link, RigidLink):
        return _core.RigidLink(
            name=link.name,
            mass=member.mass_scale * link.mass,
            com=np.array(link.com),
            inertia=member.mass_scale * np.array(inertia_matrix(link.inertia)),
        )
    return _part(link, member)


def _part(link: SuperElementLink, member: Member) -> _core.SuperElementLink:
    part = link.part
    return _core.SuperElementLink(
        name=link.name,
        interfaces=list(part.interfaces),
        frames=[_core.Frame(R, x) for R, x in zip(part.rotations, part.positions, strict=True)],
        stiffness=member.bending_scale * part.stiffness,
        mass=member.mass_scale * part.mass,
        damping=part.damping,
        damping_ratio=link.damping_ratio,
    )


def _section(section: Tube | Round | Rectangle | General) -> _core.Section:
    if isinstance(section, Tube):
        return _core.tube_section(section.outer_diameter, section.thickness)
    if isinstance(section, Round):
        return _core.round_section(section.diameter)
    if isinstance(section, General):
        torsion, (shear_y, shear_z) = section.torsion_constant, section.shear_area or (np.inf, np.inf)
    elif section.thickness is None:
        return _core.rectangle_section(section.width, section.height)
    else:
        torsion, (shear_y, shear_z) = section.hollow(section.thickness)
    i_y, i_z = section.second_moments
    return _core.Section(
        area=section.area,
        second_moment_y=i_y,
        second_moment_z=i_z,
        torsion_constant=torsion,
        shear_area_y=shear_y,
        shear_area_z=shear_z,
    )


def _payload(name: str, load: Load) -> _core.Payload:
    return _core.Payload(
        name=name,
        link=load.link,
        position=np.array(load.position),
        mass=load.mass,
        inertia=np.array(load.inertia),
        offset=np.array(load.offset),
        force=load.force,
    )


def _closure(closure: Closure, machine: Machine) -> _core.Closure:
    tilt: Frame = (tilted(machine.base), (0.0, 0.0, 0.0))
    origins = {}
    for end, place in (("a", closure.a), ("b", closure.b)):
        origin = getattr(closure, f"{end}_origin")
        at = machine.ends.get((closure.name, end))
        frame: Frame = (from_rpy(origin.rpy), origin.xyz if at is None else at.position)
        rotation, position = chained(tilt, frame) if place == "base" else frame
        origins[end] = _core.Frame(np.array(rotation), np.array(position))
    return _core.Closure(
        name=closure.name,
        type=getattr(_core.ClosureType, closure.type),
        a=closure.a,
        b=closure.b,
        a_at_end=closure.a_at == "end",
        b_at_end=closure.b_at == "end",
        a_origin=origins["a"],
        b_origin=origins["b"],
        axis=np.array(closure.axis),
        second_axis=np.array(closure.across),
        mount=core_hinges(machine.mounts[closure.name]),
        bearing=machine.drive_trains[closure.name].bearing,
    )


def _joint(joint: Joint, machine: Machine) -> _core.Joint:
    origin: Frame = (from_rpy(joint.origin.rpy), joint.origin.xyz)
    if joint.parent == "base":
        origin = chained((tilted(machine.base), (0.0, 0.0, 0.0)), origin)
    return _core.Joint(
        name=joint.name,
        type=getattr(_core.JointType, joint.type),
        parent=joint.parent,
        child=joint.child,
        at_end=joint.at == "end",
        origin=_core.Frame(np.array(origin[0]), np.array(origin[1])),
        axis=np.array(joint.axis if joint.moves else (0.0, 0.0, 1.0)),
        drive_train=machine.drive_trains[joint.name].core(),
        mount=core_hinges(machine.mounts[joint.name]),
    )
