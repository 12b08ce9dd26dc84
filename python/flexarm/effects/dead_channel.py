r"""A dead channel: a broken wire or a stopped converter shows one value for ever.

.. math:: \text{reading} = \text{value}                                                              (1)
"""

from __future__ import annotations

import numpy as np

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ChannelEffect, Channels
from flexarm.arrays import Floats
from flexarm.tables import Number, value_in


class DeadChannel(ChannelEffect):
    """Channels that hold one value, without noise."""

    name = "dead_channel"
    competes = False
    varies_with = "time"
    value: Number = value_in("SI", "what the dead channels show", 0.0)

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return np.where(self.acts_on(channels), self.value, reading)

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Nothing is known of a dead channel."""
        return np.where(self.acts_on(channels), np.nan, reading)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return priors: an open input shows zero, its supply or its last value."""
        source = "engineering judgement: an open input shows zero, the end of its range or its last value"
        return {"value": Prior(-10.0, 10.0, 0.0, "linear", "SI", source)}
