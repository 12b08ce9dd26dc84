r"""Viscous friction in the output bearing of a joint.

.. math:: T \leftarrow T - c \, \dot\theta                                                            (1)

T [N m] is the torque on the link about +axis, \theta [rad] the link's angle relative to its parent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.closure import PINNED
from flexarm.arm.effect import Effect
from flexarm.arm.motor_limits import back_emf_damping, within
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class ViscousFriction(Effect):
    """Viscous friction at the output bearing.

    `coefficient` is c of (1).
    """

    name = "viscous_friction"
    torque_at = "output"
    at_closures = PINNED
    in_motion = ("coefficient",)
    one_signed = True
    non_negative = ("coefficient",)
    varies_with = "rate"
    coefficient: Number = value_in("N m s/rad", "viscous friction of the output bearing", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Add a damper at the output bearing, eq. (1)."""
        from flexarm import _core

        machine.drive_trains[self.at].bearing.append(_core.ViscousFriction(self.coefficient))  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of the order of the dry friction at a rate of some 1 rad/s."""
        source = "engineering judgement: grease and seals, as much as the dry friction at 1 rad/s"
        prior = Prior(0.2, 300.0, 10.0, "log", "N m s/rad", source)
        return {"coefficient": within(back_emf_damping(arm, self.at), prior)}
