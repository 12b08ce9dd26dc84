r"""Compliance of a joint: a linear spring and damper between motor and link.

.. math:: T = k (\varphi - \theta) + c (\dot\varphi - \dot\theta)                                    (1)

T [N m] is the torque on the link about +axis, \varphi the motor's angle over the ratio, \theta the link's
angle relative to its parent [rad]. Without this effect the drive train is rigid, \varphi = \theta.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from flexarm.arm.prior import Prior
from flexarm.arm.spring_effect import SpringEffect
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class JointCompliance(SpringEffect):
    """Linear spring and damper between motor and link, output side.

    `stiffness` is k and `damping` c of (1); without a stiffness the joint is rigid.
    """

    name = "joint_compliance"
    stiffness: Number = value_in("N m/rad", "stiffness of the joint", inf, gt=0)
    damping: Number = value_in("N m s/rad", "damping of the joint", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Give the reducer its spring and damper, eq. (1); damping cannot act in a rigid joint."""
        train = machine.drive_trains[self.at]
        train.stiffness, train.damping = self.stiffness, self.damping  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From small strain-wave to large cycloidal reducers; damping in proportion to the stiffness."""
        source = "catalogues: small strain-wave reducers (some 1e3) to large cycloidal ones (1200 N m/arcmin)"
        return self.spring_priors(arm, 3e3, 4e6, source)


def spring_at(arm: Arm, joint: str) -> float:
    """Stiffness of the joint's compliance [N m/rad]; a typical one where it has none."""
    spring = arm.effect(JointCompliance.name, joint)
    return (
        JointCompliance.typical_stiffness if spring is None or spring.inert else spring.value_of("stiffness")
    )
