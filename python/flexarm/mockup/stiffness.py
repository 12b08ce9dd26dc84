r"""Equivalent torsional stiffness of the solid hinge.

.. math:: k = T/\beta                                                                               (1)

T: torque about the hinge axis on the seat of the tube, as two opposite forces, without gravity. \beta: turn
of that seat relative to the base about the same axis, the motor's shaft held. It is the stiffness that a
spring between a rigid housing and a rigid hub would need.
"""

from __future__ import annotations

from math import atan2
from typing import TYPE_CHECKING

from flexarm.arm import Arm
from flexarm.mockup.arms import hinge_tables
from flexarm.statics import static

if TYPE_CHECKING:
    from flexarm.mockup.hinge import SolidHinge


def torsional_stiffness(hinge: SolidHinge) -> float:
    """Return k of (1) [N m/rad]."""
    half_arm = 0.1  # the two forces act at this distance to both sides of the seat [m]
    torque = 100.0  # T of (1) [N m]; small enough for a linear answer
    tables = hinge_tables(hinge)
    seats = {"ahead": half_arm, "behind": -half_arm}
    arm = Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "name": "hinge",
            "gravity": [0.0, 0.0, 0.0],
            **tables,
            "points": [
                {"name": name, "link": "hub:output", "position": [x, 0.0, 0.0]} for name, x in seats.items()
            ],
        }
    )
    force = torque / (2 * half_arm)
    # About +y a torque turns z towards x: down ahead (x > 0), up behind.
    found = static(arm, forces={"ahead": [0, 0, -force], "behind": [0, 0, force]})
    axes = found.rotation[0]
    return torque / atan2(axes[0, 2], axes[2, 2])  # eq. (1)
