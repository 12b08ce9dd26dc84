r"""Scale of an encoder: its counts per turn, or the ratio it was divided by, are not what is believed.

.. math:: \text{reading} = \text{scale} \times \text{true}                                           (1)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import Channels, SignalEffect
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arrays import Floats


class EncoderScale(SignalEffect):
    """Scale of an encoder."""

    name = "encoder_scale"
    quantities = ("joint_angle",)
    of_drives = True
    scale: Number = value_in("-", "scale of the encoder", 1.0, gt=0)

    @classmethod
    def forms_families(cls) -> bool:
        """Return False: a wrong count or divisor is a mistake at one joint."""
        return False

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return self.scale * reading

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1) solved for the true angle."""
        return reading / self.scale

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors: counts are exact, measuring wheels and tapes are not."""
        source = "engineering judgement: a disc counts exactly, measuring wheels and tapes err by some 1e-3"
        return {"scale": Prior(0.995, 1.005, 1.0, "linear", "-", source)}
