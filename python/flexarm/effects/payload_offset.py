r"""Centre of mass of a payload beside the nominal one.

.. math:: x_c = x + R \, \text{offset}                                                               (1)

in the frame of the link, or of the interface at `link:interface`: R turns with the section or interface that
carries the payload, so the moment of the weight about the joint turns with the arm. Inertia about the
payload's own centre stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Vector3, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class PayloadOffset(Effect):
    """Centre of mass beside the nominal one.

    The offset is in the frame that the payload's position is in.
    """

    name = "payload_offset"
    offset: Vector3 = value_in("m", "centre of mass from the nominal one", (0.0, 0.0, 0.0))

    def patch(self, machine: Machine) -> None:
        """Another centre, eq. (1)."""
        machine.payloads[self.at].offset = self.offset  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors: some centimetres either way."""
        source = "engineering judgement: centres of tools and stacked weights are known to a few centimetres"
        return {f"offset.{axis}": Prior(-0.06, 0.06, 0.0, "linear", "m", source) for axis in "xyz"}
