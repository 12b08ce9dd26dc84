r"""The weight statement: mass, centre and inertia of each link and of the whole, at q = 0 by default.

A uniform beam of length L, area A and second moments I_y, I_z weighs m = \rho A L and has, about its centre
and in its section's axes (x along the beam),

.. math::
    J_x = \rho L (I_y + I_z), \quad J_y = m L^2/12 + \rho L I_y, \quad J_z = m L^2/12 + \rho L I_z      (1)

the parts \rho L I in J_y and J_z being left out with "euler-bernoulli", which has no rotary inertia. A body
of mass m whose centre lies at d from the reference adds

.. math:: m (d^T d \, 1 - d d^T)                                                                     (2)

to the inertia about the reference (Steiner). Rotors turn and are no part of the statement.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import dist, hypot
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from flexarm.arm.inertia import Matrix, inertia_matrix
from flexarm.arm.joint import Joint
from flexarm.arm.link import Beam, Link, RigidLink, SuperElementLink
from flexarm.arm.names import from_base, link_of
from flexarm.arm.places import place_in_link
from flexarm.arm.rotation import (
    IDENTITY,
    Vector,
    added,
    chained,
    from_axes,
    from_rpy,
    from_vector,
    inverted,
    rotated,
    scaled,
    sum_of,
    times,
    transposed,
)

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm

NONE: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True)
class Body:
    """Mass [kg], centre [m] and inertia about the centre [kg m2], all in one frame."""

    mass: float
    centre: Vector
    inertia: Matrix

    def moved(self, rotation: Matrix, translation: Vector) -> Body:
        """Return the body in a frame in which its own frame has this rotation and translation."""
        inertia = times(times(rotation, self.inertia), transposed(rotation))
        return Body(self.mass, added(translation, rotated(rotation, self.centre)), inertia)

    def scaled(self, factor: float) -> Body:
        """Return the same body, `factor` times as heavy."""
        rows = [scaled(factor, row) for row in self.inertia]
        return Body(factor * self.mass, self.centre, (rows[0], rows[1], rows[2]))

    def to_json_dict(self) -> dict[str, Any]:
        """Plain lists for JSON."""
        return {
            "mass": self.mass,
            "centre": list(self.centre),
            "inertia": [list(row) for row in self.inertia],
        }


@dataclass(frozen=True)
class WeightStatement:
    """Bodies in the base's frame; links without their payloads, the whole with them."""

    links: dict[str, Body]
    payloads: dict[str, Body]
    whole: Body

    def to_json_dict(self) -> dict[str, Any]:
        """Plain dictionary for JSON."""
        return {
            "links": {name: body.to_json_dict() for name, body in self.links.items()},
            "payloads": {name: body.to_json_dict() for name, body in self.payloads.items()},
            "whole": self.whole.to_json_dict(),
        }


def weight_statement(
    arm: Arm,
    tilt: Matrix = IDENTITY,
    mass_scale: Mapping[str, float] = NONE,
    values: Mapping[str, float] = NONE,
) -> WeightStatement:
    """Return the weight statement of an arm without its effects; see also `flexarm.assembly.as_built`.

    `tilt` is the rotation, (3, 3), of everything that stands on the base, and `mass_scale` has factors on the
    mass of super-elements, whose tables cannot say it. `values` are those of joints [rad or m], 0 by default.

    Raise InvalidFile if the file of a super-element cannot be read.
    """
    frames = {
        name: chained((tilt, (0.0, 0.0, 0.0)), frame) for name, frame in link_frames(arm, values).items()
    }
    links = {
        link.name: body_of(link).scaled(mass_scale.get(link.name, 1.0)).moved(*frames[link.name])
        for link in arm.links
    }
    payloads = {
        load.name: Body(load.mass, load.position, inertia_matrix(load.inertia))
        .moved(*place_in_link(arm, load.link))
        .moved(*frames[link_of(load.link)])
        for load in arm.payloads
    }
    return WeightStatement(links, payloads, combined([*links.values(), *payloads.values()]))


def carried_moment(arm: Arm) -> float:
    """Return the greatest sum m d [kg m] of what a joint carries, 0 without joints.

    d is the distance of each centre from the joint's origin at q = 0: the moment of the stretched arm,
    whatever the direction of its axes.
    """
    weights, frames = weight_statement(arm), link_frames(arm)
    bodies = {name: [body] for name, body in weights.links.items()}
    for load in arm.payloads:
        bodies[link_of(load.link)].append(weights.payloads[load.name])
    greatest = 0.0
    for joint in reversed(from_base(arm.joints)):  # from the tips to the base
        child, parent = link_of(joint.child), link_of(joint.parent)
        origin = frames[child][1]
        greatest = max(greatest, sum(body.mass * dist(body.centre, origin) for body in bodies[child]))
        bodies.setdefault(parent, []).extend(bodies[child])
    return greatest


def body_of(link: Link) -> Body:
    """Return mass, centre and inertia of a link in its own frame."""
    if isinstance(link, RigidLink):
        return Body(link.mass, link.com, inertia_matrix(link.inertia))
    return _part(link) if isinstance(link, SuperElementLink) else _beam(link)


def _part(link: SuperElementLink) -> Body:
    part = link.part
    x, y, z = map(float, part.centre)
    rows = [[float(entry) for entry in row] for row in part.inertia]
    about = (rows[0][0], rows[1][1], rows[2][2], rows[0][1], rows[0][2], rows[1][2])
    return Body(part.mass_total, (x, y, z), inertia_matrix(about))


def _beam(link: Beam) -> Body:
    density, length = link.material.density, link.length
    iy, iz = link.section.second_moments
    mass = density * link.section.area * length
    rotary = density * length if link.theory == "timoshenko" else 0.0
    bar = mass * length**2 / 12
    about = (density * length * (iy + iz), bar + rotary * iy, bar + rotary * iz)  # eq. (1)
    axes = from_axes(link.end, link.lean)
    return Body(mass, (0.0, 0.0, 0.0), inertia_matrix(about)).moved(axes, scaled(0.5, link.end))


def combined(bodies: Iterable[Body]) -> Body:
    """Return several bodies as one."""
    bodies = list(bodies)
    mass = sum(body.mass for body in bodies)
    if mass == 0:
        return Body(0.0, (0.0, 0.0, 0.0), inertia_matrix((0.0, 0.0, 0.0)))
    centre: Vector = (0.0, 0.0, 0.0)
    for body in bodies:
        centre = added(centre, scaled(body.mass / mass, body.centre))
    inertia: Matrix = inertia_matrix((0.0, 0.0, 0.0))
    for body in bodies:
        arm = added(body.centre, scaled(-1.0, centre))
        inertia = sum_of(inertia, sum_of(body.inertia, _steiner(body.mass, arm)))
    return Body(mass, centre, inertia)


def _steiner(m: float, d: Vector) -> Matrix:
    x, y, z = d
    return inertia_matrix(
        (m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y), -m * x * y, -m * x * z, -m * y * z)
    )  # eq. (2)


def link_frames(arm: Arm, values: Mapping[str, float] = NONE) -> dict[str, tuple[Matrix, Vector]]:
    """Return the pose in the base of every undeformed link at joint values [rad or m], 0 by default."""
    frames: dict[str, tuple[Matrix, Vector]] = {"base": (IDENTITY, (0.0, 0.0, 0.0))}
    ends = {link.name: link.end for link in arm.links if isinstance(link, Beam)}
    for joint in from_base(arm.joints):
        frame = chained(frames[link_of(joint.parent)], place_in_link(arm, joint.parent))
        if joint.at == "end":
            frame = chained(frame, (IDENTITY, ends[link_of(joint.parent)]))
        frame = chained(frame, (from_rpy(joint.origin.rpy), joint.origin.xyz))
        frame = chained(frame, _motion(joint, values.get(joint.name, 0.0)))
        frames[link_of(joint.child)] = chained(frame, inverted(*place_in_link(arm, joint.child)))
    return frames


def _motion(joint: Joint, value: float) -> tuple[Matrix, Vector]:
    """Return the turn or shift of a joint's child by a value of the joint."""
    if not joint.moves or value == 0.0:
        return IDENTITY, (0.0, 0.0, 0.0)
    along = scaled(value / hypot(*joint.axis), joint.axis)
    return (IDENTITY, along) if joint.type == "prismatic" else (from_vector(along), (0.0, 0.0, 0.0))


def first_turning_joint(arm: Arm) -> Joint | None:
    """Return the revolute joint nearest to the base, the first in the file if several; None if none."""
    return next((joint for joint in from_base(arm.joints) if joint.type == "revolute"), None)


def base_axis(arm: Arm) -> Vector:
    """Return the axis of that joint at q = 0 in base axes, about which a compliant base turns.

    Its length is arbitrary.
    """
    joint = first_turning_joint(arm)
    if joint is None:
        return (0.0, 0.0, 1.0)
    child = link_frames(arm)[link_of(joint.child)]
    rotation, _ = chained(child, place_in_link(arm, joint.child))  # turning about the axis leaves it
    return rotated(rotation, joint.axis)
