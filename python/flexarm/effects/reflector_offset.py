r"""A reflector that does not sit where the model says.

.. math:: x \leftarrow x + \text{offset}                                                             (1)

The point moves by offset in the frame of the link, or of the interface at `link:interface`, and then turns
with it: a circle of another radius for a hinge, where a shifted tracker moves the circle as it is. After
`link_length`, which moves a point in proportion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.arm.rotation import added
from flexarm.tables import Vector3, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class ReflectorOffset(Effect):
    """Point beside its nominal place.

    The offset is in the frame that the point's position is in.
    """

    name = "reflector_offset"
    offset: Vector3 = value_in("m", "point from its nominal place", (0.0, 0.0, 0.0))

    def patch(self, machine: Machine) -> None:
        """Another place, eq. (1)."""
        point = machine.points[self.at]
        point.position = added(point.position, self.offset)  # eq. (1)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a reflector whose nest was placed by hand."""
        source = "engineering judgement: nests glued or bolted by hand to 1 mm, drawings off by up to 5"
        return {f"offset.{axis}": Prior(-4e-3, 4e-3, 0.0, "linear", "m", source) for axis in "xyz"}

    def model_key(self, parameter: str) -> str:
        """Return the key of the point's position, which moves it alike."""
        return f"points.{self.at}.{parameter.replace('offset', 'position')}"
