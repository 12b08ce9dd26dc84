r"""Scale of a frame of measurement: the metre of a tracker is wrong.

.. math:: \text{measured} = \text{scale} \cdot \text{true}                                            (1)

for positions in the frame's own axes, from its own origin. Orientations stay as they are.
"""

from __future__ import annotations

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ZERO, FrameEffect, Vector
from flexarm.tables import Number, value_in


class FrameScale(FrameEffect):
    """Scale of all positions that are seen in a frame."""

    name = "frame_scale"
    sees = ("position",)
    least_places = 2
    scale: Number = value_in("-", "measured over true distance", 1.0, gt=0)

    def moved(self) -> tuple[Vector, Vector, Vector]:
        """Return zeros: it neither shifts nor turns."""
        return ZERO, ZERO, ZERO

    def enlarged(self) -> float:
        """Eq. (1)."""
        return self.scale

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors: interferometers err by 1e-6, cameras scaled by a bar by up to some 1e-3."""
        source = "engineering judgement: lasers uncorrected for air err by 1e-5, cameras and cords by 1e-3"
        return {"scale": Prior(0.998, 1.002, 1.0, "linear", "-", source)}
