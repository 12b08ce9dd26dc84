r"""Compliance of a joint: a linear spring and damper between motor and link.

.. math:: T = k (\varphi - \theta) + c (\dot\varphi - \dot\theta)                                    (1)

T [N m] is the torque on the link about +axis, \varphi the motor's angle over the ratio, \theta the link's
angle relative to its parent [rad]. Without this effect the drive train is rigid, \varphi = \theta.
"""

from __future__ import annotations

from math import inf, isinf
from typing import Any, ClassVar

from flexarm.arm.effect import Effect
from flexarm.tables import Number, value_in


class JointCompliance(Effect):
    """Linear spring and damper between motor and link, output side.

    Parameters
    ----------
    at : str
        The joint.
    stiffness : float
        k of (1) [N m/rad]; N/m for a prismatic joint. Left out: infinite, so without effect.
    damping : float
        c of (1) [N m s/rad]; default 0.
    """

    name: ClassVar[str] = "joint_compliance"
    place: ClassVar[str] = "joint"
    stiffness: Number = value_in("N m/rad", "stiffness of the joint", inf, gt=0)
    damping: Number = value_in("N m s/rad", "damping of the joint", 0.0, ge=0)

    def coupling_laws(self, core: Any) -> list[Any]:
        """Spring and damper, eq. (1); none without a stiffness: damping cannot act in a rigid joint."""
        return [] if isinf(self.stiffness) else [core.LinearSpring(self.stiffness, self.damping)]  # eq. (1)
