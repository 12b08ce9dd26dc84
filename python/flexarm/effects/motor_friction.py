r"""Friction of the motor, referred to the output side.

.. math:: T_f = T_c z + c \, \dot\varphi, \qquad \dot z = (1 - z \operatorname{sgn}\dot\varphi)\,\dot\varphi /
w    (1)

\varphi [rad] is the motor's angle over the ratio; T_f [N m], the motor's own friction torque times the ratio,
opposes \dot\varphi; w = 2e-5 rad as in the output bearing. It acts on the motor and not on T, the torque on
the link: where the motor's angle is imposed it is seen only in the motor's torque.
"""

from __future__ import annotations

from typing import Any, ClassVar

from flexarm.arm.effect import Effect
from flexarm.effects.coulomb_friction import STICK_WIDTH
from flexarm.tables import Number, value_in


class MotorFriction(Effect):
    """Dry and viscous friction of the motor.

    Parameters
    ----------
    at : str
        The joint that the motor drives.
    coulomb : float
        T_c of (1) [N m], output-referred.
    viscous : float
        c of (1) [N m s/rad], output-referred.
    """

    name: ClassVar[str] = "motor_friction"
    place: ClassVar[str] = "joint"
    coulomb: Number = value_in("N m", "dry friction of the motor, output-referred", 0.0, ge=0)
    viscous: Number = value_in("N m s/rad", "viscous friction of the motor, output-referred", 0.0, ge=0)

    def motor_laws(self, core: Any) -> list[Any]:
        """Dahl's law and a damper, eq. (1)."""
        dry = [core.DahlFriction(self.coulomb, STICK_WIDTH)] if self.coulomb else []
        return dry + ([core.ViscousFriction(self.viscous)] if self.viscous else [])  # eq. (1)
