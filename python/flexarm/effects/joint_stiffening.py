r"""Stiffening of a joint: its spring grows stiffer with its deflection.

.. math:: T = k e + k_3 e^3 + c \dot d                                                                  (1)

d [rad] is the deflection of the reducer, e what of it lies beyond half its gap, k and c those of the joint's
`joint_compliance`, which the spring needs. Flexsplines and rollers that come into contact bit by bit do this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.effects.joint_compliance import spring_at
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class JointStiffening(Effect):
    """Cubic part of the spring between motor and link.

    `cubic_stiffness` is k_3 of (1).
    """

    name = "joint_stiffening"
    requires = "joint_compliance"
    non_negative = ("cubic_stiffness",)
    varies_with = "torque"
    cubic_stiffness: Number = value_in("N m/rad3", "cubic stiffness, added to the linear spring", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Add the cubic part to the reducer's spring, eq. (1)."""
        machine.drive_trains[self.at].cubic_stiffness = self.cubic_stiffness  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors: the tangent stiffness grows by 3 k_3 e^2; k is that at full load."""
        k = spring_at(arm, self.at)
        source = (
            "catalogues of strain-wave reducers: stiffness K1 < K2 < K3 rises by a fifth to double "
            "towards the rated torque, at deflections of 2e-4 to 5e-3 rad"
        )
        low, typical, high = (gain * k / (3 * e**2) for gain, e in ((0.2, 5e-3), (0.5, 1e-3), (1.0, 2e-4)))
        return {"cubic_stiffness": Prior(low, high, typical, "log", "N m/rad3", source)}
