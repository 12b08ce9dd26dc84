r"""A base that does not stand upright.

.. math:: R = \exp(\alpha_x, \alpha_y, 0)                                                            (1)

turns everything that stands on the base about its origin; gravity and the tracker, which the base's axes in a
record stand for, do not turn. To first order the tip moves by \alpha \times r, as a turned registration of
the tracker would have it, and what the arm's weight does changes by that of \alpha \times r on the joint.

A record that states how its base stood takes precedence over the effect.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Vector2, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class BaseTilt(Effect):
    """Tilt of the base.

    `angle` is the rotation vector of (1).
    """

    name = "base_tilt"
    stated_by_records = True
    angle: Vector2 = value_in("rad", "tilt about the base's x and y", (0.0, 0.0))

    def patch(self, machine: Machine) -> None:
        """Another base, eq. (1)."""
        machine.base.tilt = self.angle  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a machine that was levelled with a spirit level, or not at all."""
        source = "engineering judgement: levelled machines stand within 0.1 to 1 mm/m, bolted frames within 5"
        return {f"angle.{axis}": Prior(-4e-3, 4e-3, 0.0, "linear", "rad", source) for axis in "xy"}
