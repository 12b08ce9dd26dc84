r"""A sign error: a channel counts the other way.

.. math:: \text{reading} = -\text{true}                                                              (1)
"""

from __future__ import annotations

import numpy as np

from flexarm.arm.sensor_effect import ChannelEffect, Channels
from flexarm.arrays import Floats


class SignError(ChannelEffect):
    """Channels of the wrong sign.

    It has no parameter of its own.
    """

    name = "sign_error"
    competes = False
    varies_with = "time"

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return np.where(self.acts_on(channels), -reading, reading)

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1) is its own inverse."""
        return self.reading(reading, true, channels)
