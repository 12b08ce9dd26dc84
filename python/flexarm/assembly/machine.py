"""The machine: an arm's data as mutable parts that effects patch before the core's system is made.

`Arm` says what the model is, frozen; a `Machine` is made from it for one assembly and thrown away. Effects
are applied in the order of the vocabulary, `flexarm.arm.vocabulary`, never in that of the file. A law that an
effect brings is there even where its parameter is zero, so that the structure of the assembled system does
not depend on values: sensitivities difference two systems of one structure.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.inertia import Matrix, inertia_matrix
from flexarm.arm.link import Link
from flexarm.arm.rotation import Vector, from_vector, rotated
from flexarm.arm.vocabulary import order_of
from flexarm.arm.weight import base_axis
from flexarm.assembly.drive_train import DriveTrain


def tilted(base: Base) -> Matrix:
    """Return the rotation of everything that stands on the base, about its origin."""
    return from_vector((*base.tilt, 0.0))


def core_hinges(hinges: Iterable[Hinge]) -> list[_core.Hinge]:
    """Return hinges as the core takes them."""
    return [
        _core.Hinge(
            axis=np.array(each.axis),
            stiffness=each.stiffness,
            damping=each.damping,
            type=_core.JointType.prismatic if each.slides else _core.JointType.revolute,
            laws=list(each.laws),
            follows=each.follows,
        )
        for each in hinges
    ]


def pedestal(machine: Machine) -> _core.Pedestal | None:
    """Return the pedestal of a compliant base, or None where the base is rigid. It tilts with the base."""
    base, turn = machine.base, tilted(machine.base)
    if not base.hinges:
        return None
    amplitude, frequency, phase = base.vibration or (0.0, 0.0, 0.0)
    return _core.Pedestal(
        hinges=core_hinges(replace(each, axis=rotated(turn, each.axis)) for each in base.hinges),
        axis=np.array(rotated(turn, base_axis(machine.arm))),
        amplitude=amplitude,
        frequency=frequency,
        phase=phase,
    )


@dataclass
class Load:
    """A payload."""

    link: str
    position: Vector
    """Where it sits: in the link's frame [m]."""
    mass: float
    inertia: Matrix
    """Mass [kg], and inertia about its centre, link's axes [kg m2]."""
    offset: Vector = (0.0, 0.0, 0.0)
    """Of its centre from `position`, turning with the link there [m], shape (3,)."""
    force: _core.StateTable | None = None
    """At its centre, base axes [N]."""


@dataclass
class Place:
    """A point: its link, and where in the link's frame [m]."""

    link: str
    position: Vector


@dataclass
class Member:
    """A link."""

    table: Link
    """What the model says of it, perhaps changed."""
    bending_scale: float = 1.0
    mass_scale: float = 1.0
    """On EI of both planes (the stiffness of a super-element), and on rho A and rho I (any link's mass)
    [-]."""
    bow: Vector = (0.0, 0.0, 0.0)
    bow_time: float = 0.0
    """Where the tip of the unloaded beam is, from its place on a straight one, link's axes [m], and the time
    constant with which it gets there [s]; 0: it is there."""
    curvature: _core.StateTable | None = None
    """Without load; the tip bends in its direction, link's axes [1/m]."""


Spring = tuple[Vector, float, float]
"""Axis, stiffness and damping of a hinge."""


@dataclass(frozen=True)
class Hinge:
    """A hinge that nothing drives, between two parts that were one."""

    axis: Vector
    """Direction; its length is arbitrary, shape (3,)."""
    stiffness: float = 0.0
    damping: float = 0.0
    """Of its spring and damper [N m/rad], [N m s/rad]."""
    slides: bool = False
    """True if it gives along the axis [N/m], [N s/m]."""
    laws: tuple[_core.RadialClearance, ...] = ()
    follows: _core.StateTable | None = None
    """In place of spring and damper: laws, or a table that turns it [rad]."""


@dataclass
class Base:
    """The base of the arm."""

    tilt: tuple[float, float] = (0.0, 0.0)
    """Rotation vector about the base's x and y [rad]; gravity and trackers do not turn, shape (2,)."""
    hinges: list[Hinge] = field(default_factory=list)
    """Through the base's origin, axes in the base's frame; none: it stands still."""
    vibration: tuple[float, float, float] | None = None
    """Amplitude [N m], frequency [Hz], phase [rad] of a moment about the arm's first axis."""

    def turn(self, axis: Vector, table: _core.StateTable) -> None:
        """Put the base on a hinge whose angle a table gives [rad]."""
        self.hinges.append(Hinge(axis, follows=table))

    def hinge(self, springs: Iterable[Spring]) -> None:
        """Put the base on hinges, one behind the other."""
        self.hinges += [Hinge(*spring) for spring in springs]


@dataclass
class Machine:
    """An arm's data, by name, in the order of the model; `arm` is the model itself.

    `mounts` are hinges between a joint and its parent, axes in the joint's frame. A closure has a mount on
    its side a too, and of a drive train the output bearing. `ends` are the places of closures by their name
    and "a" or "b", without those measured from the far end of a beam.
    """

    arm: Arm
    drive_trains: dict[str, DriveTrain]
    mounts: dict[str, list[Hinge]]
    payloads: dict[str, Load]
    links: dict[str, Member]
    points: dict[str, Place]
    base: Base
    ends: dict[tuple[str, str], Place] = field(default_factory=dict)

    def mount(self, joint: str, springs: Iterable[Spring], *, slides: bool = False) -> None:
        """Put hinges, or slides, between a joint (or closure) and its parent, one behind the other."""
        self.mounts[joint] += [Hinge(*spring, slides) for spring in springs]

    def axis_of(self, joint: str) -> Vector:
        """Return the axis of a joint or closure, in its own frame, shape (3,)."""
        axes = {each.name: each.axis for each in self.arm.joints}
        return (axes | {each.name: each.axis for each in self.arm.closures})[joint]


def machine_of(arm: Arm) -> Machine:
    """Return the machine that an arm with its effects describes."""
    machine = nominal_machine(arm)
    for effect in sorted(arm.effects, key=lambda effect: order_of(effect.name)):
        effect.patch(machine)
    return machine


def nominal_machine(arm: Arm) -> Machine:
    """Return the machine without effects."""
    trains = {joint.name: DriveTrain(joint.gear_ratio, joint.rotor_inertia) for joint in arm.joints}
    trains |= {closure.name: DriveTrain() for closure in arm.closures}
    return Machine(
        arm=arm,
        drive_trains=trains,
        mounts={name: [] for name in trains},
        payloads={
            load.name: Load(load.link, load.position, load.mass, inertia_matrix(load.inertia))
            for load in arm.payloads
        },
        links={link.name: Member(link) for link in arm.links},
        points={point.name: Place(point.link, point.position) for point in arm.points},
        base=Base(),
        ends={
            (closure.name, end): Place(link, origin.xyz)
            for closure in arm.closures
            for end, link, at, origin in (
                ("a", closure.a, closure.a_at, closure.a_origin),
                ("b", closure.b, closure.b_at, closure.b_origin),
            )
            if at == "start"
        },
    )
