r"""Drift of a frame of measurement: the tracker's stand creeps, warms or settles.

.. math:: \text{measured} = \text{true} + \text{velocity} \, (t - t_0)                               (1)

in the base's axes; t_0 is the start of the run.
"""

from __future__ import annotations

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ZERO, FrameEffect, Vector
from flexarm.tables import Vector3, value_in


class FrameDrift(FrameEffect):
    """Drift of a frame."""

    name = "frame_drift"
    in_motion = ("velocity",)
    varies_with = "time"
    velocity: Vector3 = value_in("m/s", "velocity of what is measured while nothing moves", ZERO)

    def moved(self) -> tuple[Vector, Vector, Vector]:
        """Eq. (1)."""
        return ZERO, ZERO, self.velocity

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a tripod that settles or warms."""
        source = "engineering judgement: a tripod creeps by 10 um to some mm an hour"
        return {f"velocity.{axis}": Prior(-1e-6, 1e-6, 0.0, "linear", "m/s", source) for axis in "xyz"}
