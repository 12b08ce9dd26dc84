"""The machine: an arm's data as mutable parts that effects patch before the core's system is made.

`Arm` says what the model is, frozen; a `Machine` is made from it for one assembly and thrown away. Effects
are applied in the order of the vocabulary, `flexarm.arm.vocabulary`, never in that of the file. A law that an
effect brings is there even where its parameter is zero, so that the structure of the assembled system does
not depend on values: sensitivities difference two systems of one structure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arm.inertia import inertia_matrix
from flexarm.arm.link import Link
from flexarm.arm.rotation import Vector
from flexarm.arm.vocabulary import order_of
from flexarm.assembly.drive_train import DriveTrain


@dataclass
class Load:
    """A payload: its place, its mass [kg], its inertia about its centre, link's axes [kg m2]."""

    link: str
    position: Vector
    mass: float
    inertia: NDArray[np.float64]


@dataclass
class Place:
    """A point: its link, and where in the link's frame [m]."""

    link: str
    position: Vector


@dataclass
class Member:
    """A link: its table."""

    table: Link


@dataclass
class Machine:
    """An arm's data, by name, in the order of the model."""

    drive_trains: dict[str, DriveTrain]
    payloads: dict[str, Load]
    links: dict[str, Member]
    points: dict[str, Place]


def machine_of(arm: Arm) -> Machine:
    """The machine that an arm with its effects describes."""
    machine = _nominal(arm)
    for effect in sorted(arm.effects, key=lambda effect: order_of(effect.name)):
        effect.patch(machine)
    return machine


def _nominal(arm: Arm) -> Machine:
    """The machine without effects."""
    return Machine(
        drive_trains={joint.name: DriveTrain(joint.gear_ratio, joint.rotor_inertia) for joint in arm.joints},
        payloads={
            load.name: Load(load.link, load.position, load.mass, np.array(inertia_matrix(load.inertia)))
            for load in arm.payloads
        },
        links={link.name: Member(link) for link in arm.links},
        points={point.name: Place(point.link, point.position) for point in arm.points},
    )
