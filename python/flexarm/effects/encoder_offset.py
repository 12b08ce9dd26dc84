r"""Offset of an encoder: its zero is not where the joint's is.

.. math:: \text{reading} = \text{true} + \text{offset}                                               (1)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import Channels, SignalEffect
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arrays import Floats


class EncoderOffset(SignalEffect):
    """Offset of an encoder.

    The offset is output-referred.
    """

    name = "encoder_offset"
    quantities = ("joint_angle",)
    of_drives = True
    offset: Number = value_in("rad", "offset of the encoder", 0.0)

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return reading + self.offset

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1) solved for the true angle."""
        return reading - self.offset

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a zero that is set by a mark, a gauge or a limit switch."""
        source = "engineering judgement: zeros set by marks, gauges or switches hold to about 0.1 degree"
        return {"offset": Prior(-3e-3, 3e-3, 0.0, "linear", "rad", source)}
