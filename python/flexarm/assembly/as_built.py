"""An arm as built: effects of payloads, links and points worked into its tables.

Rigid kinematics, weights and sensors that look along a link need the arm as it is, where the core's `System`
is not at hand. What tables cannot say stays out: stiffness, bows, the base, and the mass of super-elements.
"""

from __future__ import annotations

from collections.abc import Mapping

from flexarm.arm import Arm, Beam, RigidLink
from flexarm.arm.link import Link
from flexarm.arm.rotation import added
from flexarm.arm.weight import NONE, WeightStatement, weight_statement
from flexarm.assembly.machine import Load, Machine, Member, machine_of, tilted


def as_built(machine: Machine) -> Arm:
    """Return the machine as an arm without effects."""
    arm = machine.arm
    return arm.replace(
        effects=(),
        uncertainty={},
        links=tuple(_link(member) for member in machine.links.values()),
        payloads=tuple(load.replace(**_carried(machine.payloads[load.name])) for load in arm.payloads),
        points=tuple(point.replace(position=machine.points[point.name].position) for point in arm.points),
    )


def weight_as_built(arm: Arm, values: Mapping[str, float] = NONE) -> WeightStatement:
    """Return the weight statement of an arm with its effects, at joint values [rad or m], 0 by default.

    Raise InvalidFile if the file of a super-element cannot be read.
    """
    machine = machine_of(arm)
    parts = {
        name: member.mass_scale
        for name, member in machine.links.items()
        if member.table.type == "superelement"
    }
    return weight_statement(as_built(machine), tilted(machine.base), parts, values)


def _link(member: Member) -> Link:
    link, scale = member.table, member.mass_scale
    if isinstance(link, Beam):
        return link.replace(material=link.material.replace(density=scale * link.material.density))
    if isinstance(link, RigidLink):
        return link.replace(mass=scale * link.mass, inertia=tuple(scale * entry for entry in link.inertia))
    return link


def _carried(load: Load) -> dict[str, object]:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = load.inertia
    return {
        "mass": load.mass,
        "position": added(load.position, load.offset),
        "inertia": (xx, yy, zz, xy, xz, yz),
    }
