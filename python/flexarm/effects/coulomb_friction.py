r"""Dry friction in the output bearing of a joint, by Dahl's law.

.. math:: T \leftarrow T - T_c z, \qquad \dot z = (1 - z \operatorname{sgn}\dot\theta)\,\dot\theta / w    (1)

T_c [N m] is the friction torque, \theta [rad] the link's angle, z = 0 at the equilibrium from which the
motion starts, and w = 2e-5 rad the width over which stiction gives way. Rate-independent; z saturates at 1.
Other shapes have another w, creep at slow rates, or fall with the rate: `flexarm.arm.friction_effect`, eqs.
(1), (2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.closure import PINNED
from flexarm.arm.friction_effect import FrictionEffect
from flexarm.arm.motor_limits import stall_torque, within
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class CoulombFriction(FrictionEffect):
    """Dry friction at the output bearing.

    `torque` is T_c of (1); the other parameters are the shape of `FrictionEffect`.
    """

    name = "coulomb_friction"
    torque_at = "output"
    at_closures = PINNED
    in_motion = ("torque", *FrictionEffect.shape)
    non_negative = ("torque",)
    torque: Number = value_in("N m", "friction torque at the output bearing", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Dry friction at the output bearing, eq. (1)."""
        machine.drive_trains[self.at].bearing += self.laws(self.torque)  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a small cross-roller bearing to a preloaded slewing ring."""
        source = "engineering judgement: starting torques of cross-roller bearings and sealed slewing rings"
        prior = Prior(0.2, 200.0, 8.0, "log", "N m", source)
        return {"torque": within(stall_torque(arm, self.at), prior), **self.shape_priors()}
