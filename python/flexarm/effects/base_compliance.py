r"""A base that gives way: everything that stands on it turns about its origin.

.. math:: k \psi + c \dot\psi = M                                                                    (1)

\psi [rad] is the angle about the axis of the first joint that turns (of the joints nearest to the base the
first in the file, at q = 0), and M [N m] the moment of the arm about that axis through the base's origin. The
base itself has no mass. Where the arm has one joint, at the base's origin, statics cannot tell this from a
compliance of the joint by the tip; by what stands on the base beside the joint they can.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from typing import TYPE_CHECKING, ClassVar

from flexarm.arm.base_axis import first_turning_joint
from flexarm.arm.prior import Prior
from flexarm.arm.spring_effect import SpringEffect
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class BaseCompliance(SpringEffect):
    """Linear spring and damper under the base.

    Parameters
    ----------
    at : str
        "base".
    stiffness : float
        k of (1) [N m/rad]. Left out: infinite, so without effect.
    damping : float
        c of (1) [N m s/rad]; default 0.
    """

    name: ClassVar[str] = "base_compliance"
    stiffness: Number = value_in("N m/rad", "stiffness of the base", inf, gt=0)
    damping: Number = value_in("N m s/rad", "damping of the base", 0.0, ge=0)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """There must be an axis to turn about."""
        if first_turning_joint(arm) is None:
            yield "at", "the base turns about the axis of the first revolute joint, and the model has none"

    def patch(self, machine: Machine) -> None:
        """Add a spring and a damper, eq. (1)."""
        machine.base.stiffness, machine.base.damping = self.stiffness, self.damping  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From a frame on a floor of wood to a plate on bedrock; damping in proportion."""
        typical = 3e6
        stiffness = typical if self.inert else self.stiffness
        where = (
            "engineering judgement: frames bolted to a floor from 1e5, plates grouted into concrete to 1e8"
        )
        loss = "engineering judgement: 0.1 to 10 % of critical for an arm that swings on it at a few Hz"
        return {
            "stiffness": Prior(1e5, 1e8, typical, "log", "N m/rad", where),
            "damping": Prior(1e-4 * stiffness, 1e-2 * stiffness, 1e-3 * stiffness, "log", "N m s/rad", loss),
        }
