r"""Tilt of a joint: its bearing gives about the two axes across the joint's own.

.. math:: k_i \psi_i + c_i \dot\psi_i = M_i, \qquad i = 1, 2                                         (1)

\psi_i [rad] turns the joint about its own origin, with its axis and all that it carries, relative to its
parent; M_i [N m] is the moment that the joint takes about that axis. The first of the two is the x axis of
the joint's frame made normal to the joint's own axis (y where that is along x), the second is the joint's
axis times the first. They are fixed to the parent; a closure's are fixed at a. The bearing itself has no
mass. An arm that moves in a plane loads no bearing across it: there this changes nothing but the modes that
leave the plane.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import TYPE_CHECKING, ClassVar

from flexarm.arm.prior import Prior
from flexarm.arm.rotation import across
from flexarm.arm.spring_effect import Damping, SpringEffect, Stiffness
from flexarm.tables import value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.effect import Search, Trial
    from flexarm.assembly.machine import Machine


class JointTiltCompliance(SpringEffect):
    """Linear springs and dampers of a joint's bearing, about the two axes across its own.

    `stiffness` is k and `damping` c of (1), each one number for both axes or two; 1e12 about one of two is
    rigid.
    """

    name = "joint_tilt_compliance"
    leaves_plane = True
    at_closures = ("revolute",)
    always_turns = True
    typical_stiffness = 2e5
    hardly_softer: ClassVar[float] = 100.0
    """Factor by which bearings are hardly softer than typical: a search does not try more."""
    stiffness: Stiffness = value_in("N m/rad", "stiffness of the bearing, or of both axes", inf)
    damping: Damping = value_in("N m s/rad", "damping of the bearing, or of both axes", 0.0)

    def patch(self, machine: Machine) -> None:
        """Put two hinges between the parent and the joint, eq. (1)."""
        axes = across(machine.axis_of(self.at))
        machine.mount(self.at, self.soft_about(axes))  # eq. (1)

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield softer and softer bearings."""
        softer = [times for times in search.softer if times < self.hardly_softer]
        return super().trials(search._replace(softer=softer))

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From small bearings to large slewing rings; damping in proportion to the stiffness."""
        source = (
            "catalogues: tilting stiffness of crossed roller bearings, 1e4 (bore of 20 mm) to 1e7 N m/rad "
            "(bore of 400 mm), less in a light housing"
        )
        return self.spring_priors(arm, 5e3, 1e7, source)
