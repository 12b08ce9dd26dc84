r"""Dry friction in the output bearing of a joint, by Dahl's law.

.. math:: T \leftarrow T - T_c z, \qquad \dot z = (1 - z \operatorname{sgn}\dot\theta)\,\dot\theta / w    (1)

T_c [N m] is the friction torque, \theta [rad] the link's angle, z = 0 at the equilibrium from which the
motion starts, and w = 2e-5 rad the width over which stiction gives way. Rate-independent; z saturates at 1.
"""

from __future__ import annotations

from typing import Any, ClassVar

from flexarm.arm.effect import Effect
from flexarm.tables import Number, value_in

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
    place: ClassVar[str] = "joint"
    torque: Number = value_in("N m", "friction torque at the output bearing", 0.0, ge=0)

    def bearing_laws(self, core: Any) -> list[Any]:
        """Dahl's law, eq. (1)."""
        return [core.DahlFriction(self.torque, STICK_WIDTH)] if self.torque else []  # eq. (1)
