r"""Registration of a frame of measurement: it does not stand where it is said to stand.

.. math:: \text{measured} = R(\text{rotation}) \, \text{true} + \text{translation}                   (1)

R of a rotation vector, about the base's origin, in the base's axes; a stated pose of the frame comes after.
"""

from __future__ import annotations

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ZERO, FrameEffect, Vector
from flexarm.tables import Vector3, value_in


class FrameRegistration(FrameEffect):
    """Error of the registration of a frame.

    `rotation` is a rotation vector.
    """

    name = "frame_registration"
    translation: Vector3 = value_in("m", "shift of what is measured", ZERO)
    rotation: Vector3 = value_in("rad", "turn of what is measured, about the base's origin", ZERO)

    def moved(self) -> tuple[Vector, Vector, Vector]:
        """Eq. (1)."""
        return self.translation, self.rotation, ZERO

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a laser tracker whose frame is found from a few points of the base."""
        where = "engineering judgement: a tracker registered on machined faces to 0.1 mm, on castings to 3 mm"
        turn = "engineering judgement: 0.1 to 1 mm over datum points that are 1 m apart"
        return {
            **{f"translation.{axis}": Prior(-3e-3, 3e-3, 0.0, "linear", "m", where) for axis in "xyz"},
            **{f"rotation.{axis}": Prior(-1e-3, 1e-3, 0.0, "linear", "rad", turn) for axis in "xyz"},
        }
