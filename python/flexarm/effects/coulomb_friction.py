r"""Dry friction in the output bearing of a joint, by Dahl's law.

.. math:: T \leftarrow T - T_c z, \qquad \dot z = (1 - z \operatorname{sgn}\dot\theta)\,\dot\theta / w    (1)

T_c [N m] is the friction torque, \theta [rad] the link's angle, z = 0 at the equilibrium from which the
motion starts, and w = 2e-5 rad the width over which stiction gives way. Rate-independent; z saturates at 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from flexarm.arm.effect import Effect
from flexarm.arm.motor_limits import stall_torque, within
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine

STICK_WIDTH = 2e-5
"""w of (1) [rad]."""


class CoulombFriction(Effect):
    """Dry friction at the output bearing.

    Parameters
    ----------
    at : str
        The joint.
    torque : float
        T_c of (1) [N m].
    """

    name: ClassVar[str] = "coulomb_friction"
    torque_at = "output"
    in_motion = ("torque",)
    smooth = False
    one_signed = True
    non_negative = ("torque",)
    varies_with = "rate"
    torque: Number = value_in("N m", "friction torque at the output bearing", 0.0, ge=0)

    def patch(self, machine: Machine) -> None:
        """Dahl's law at the output bearing, eq. (1)."""
        from flexarm import _core

        machine.drive_trains[self.at].bearing.append(_core.DahlFriction(self.torque, STICK_WIDTH))  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a small cross-roller bearing to a preloaded slewing ring."""
        source = "engineering judgement: starting torques of cross-roller bearings and sealed slewing rings"
        prior = Prior(0.2, 200.0, 8.0, "log", "N m", source)
        return {"torque": within(stall_torque(arm, self.at), prior)}
