r"""Error of the gear ratio: the output turns by a little less, or more, than the nominal ratio says.

.. math:: \psi = \varphi / s                                                                            (1)

\varphi [rad] is the motor's angle over the nominal ratio, s the true ratio over the nominal one, \psi where
the teeth put the output, in front of the reducer's spring. A belt, a friction drive or a wrong data sheet
does this; teeth that mesh do not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class GearRatio(Effect):
    """Scale of the gear ratio.

    `scale` is s of (1).
    """

    name = "gear_ratio"
    driven_joints_only = True
    scale: Number = value_in("-", "true over nominal gear ratio", 1.0, gt=0)

    def patch(self, machine: Machine) -> None:
        """Scales what the teeth make of the motor's angle, eq. (1)."""
        machine.drive_trains[self.at].teeth().scale = self.scale  # eq. (1)

    @classmethod
    def forms_families(cls) -> bool:
        """Return False: a ratio that is another one is a mistake at one joint."""
        return False

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Off by parts per thousand where it is off at all."""
        source = "engineering judgement: creep of belts and friction drives, rounded ratios in data sheets"
        return {"scale": Prior(0.996, 1.004, 1.0, "linear", "-", source)}
