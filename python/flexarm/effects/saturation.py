r"""Saturation: a sensor shows no more than the end of its range.

.. math:: \text{reading} = \min(\max(\text{true}, -\text{limit}), \text{limit})                      (1)

At the limit (1) has different derivatives on both sides.
"""

from __future__ import annotations

from math import inf

import numpy as np

from flexarm.arm.arm import Arm
from flexarm.arm.effect import Derivative
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ChannelEffect, Channels
from flexarm.arrays import Floats
from flexarm.tables import Number, value_in


class Saturation(ChannelEffect):
    """Channels that stop at the end of their range.

    `limit` is that of (1), by default infinite.
    """

    name = "saturation"
    competes = False
    varies_with = "time"
    limit: Number = value_in("SI", "end of the range, on both sides of zero", inf, gt=0)

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return np.where(self.acts_on(channels), np.clip(reading, -self.limit, self.limit), reading)

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Return the reading; at the end of the range nothing is known."""
        lost = self.acts_on(channels) & (np.abs(reading) >= self.limit * (1 - 1e-9))
        return np.where(lost, np.nan, reading)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Anywhere in the range of what arms do."""
        source = "engineering judgement: sensors are chosen with ranges of 1 to 10 times what they shall see"
        return {"limit": Prior(1e-3, 1e4, 1.0, "log", "SI", source)}

    def derivative(self, parameter: str) -> Derivative:
        """Return "one-sided": a reading at the limit moves with it on one side only."""
        return "one-sided"
