r"""Radial compliance of a joint: its pin and bearing give along the two axes across the joint's own.

.. math:: k_i u_i + c_i \dot u_i = F_i, \qquad i = 1, 2                                              (1)

u_i [m] shifts the joint with all that it carries relative to its parent; F_i [N] is the force that the joint
takes along that axis. The first of the two is the x axis of the joint's frame made normal to the joint's own
axis (y where that is along x), the second is the joint's axis times the first. They are fixed to the parent;
a closure's are fixed at a. The bearing itself has no mass.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Annotated

from flexarm.arm.closure import PINNED
from flexarm.arm.prior import Prior
from flexarm.arm.rotation import across
from flexarm.arm.spring_effect import SpringEffect, one_or_two
from flexarm.tables import Number, Vector2, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class JointRadialCompliance(SpringEffect):
    """Linear springs and dampers of a joint's bearing, along the two axes across its own.

    `stiffness` is k and `damping` c of (1), each one number for both axes or two; 1e12 along one of two is
    rigid.
    """

    name = "joint_radial_compliance"
    pins_of_loops_only = True
    at_closures = PINNED
    always_turns = True
    typical_stiffness = 1e7
    stiffness: Annotated[Number | Vector2, one_or_two("N/m", positive=True)] = value_in(
        "N/m", "stiffness of the bearing, or of both axes", inf
    )
    damping: Annotated[Number | Vector2, one_or_two("N s/m", positive=False)] = value_in(
        "N s/m", "damping of the bearing, or of both axes", 0.0
    )

    def patch(self, machine: Machine) -> None:
        """Put two slides between the parent and the joint, eq. (1)."""
        axes = across(machine.axis_of(self.at))
        machine.mount(self.at, self.soft_about(axes), slides=True)  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a worn bush to a large roller bearing; damping in proportion to the stiffness."""
        source = "catalogues: radial stiffness of roller bearings, 1e8 to 1e10 N/m; less of bushes"
        return self.spring_priors(arm, 1e5, 1e9, source)
