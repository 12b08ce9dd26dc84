r"""Viscous friction in the output bearing of a joint.

.. math:: T \leftarrow T - c \, \dot\theta                                                            (1)

T [N m] is the torque on the link about +axis, \theta [rad] the link's angle relative to its parent.
"""

from __future__ import annotations

from typing import Any, ClassVar

from flexarm.arm.effect import Effect
from flexarm.tables import Number, value_in


class ViscousFriction(Effect):
    """Viscous friction at the output bearing.

    Parameters
    ----------
    at : str
        The joint.
    coefficient : float
        c of (1) [N m s/rad].
    """

    name: ClassVar[str] = "viscous_friction"
    place: ClassVar[str] = "joint"
    coefficient: Number = value_in("N m s/rad", "viscous friction of the output bearing", 0.0, ge=0)

    def bearing_laws(self, core: Any) -> list[Any]:
        """A damper, eq. (1)."""
        return [core.ViscousFriction(self.coefficient)] if self.coefficient else []  # eq. (1)
