r"""A unit error: a channel's numbers are not in the unit that the file states.

.. math:: \text{reading} = \text{factor} \times \text{true}                                          (1)

Millimetres stated as metres have factor = 1000, degrees stated as radians 57.3, g as m/s2 0.102. The factor
is negative where the channel counts the other way as well.
"""

from __future__ import annotations

from typing import Self

import numpy as np
from pydantic import model_validator

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ChannelEffect, Channels
from flexarm.arrays import Floats
from flexarm.tables import Inconsistent, Number, value_in


class UnitError(ChannelEffect):
    """Channels in another unit than stated."""

    name = "unit_error"
    competes = False
    varies_with = "time"
    factor: Number = value_in("-", "reading over true value", 1.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.factor == 0:
            raise Inconsistent((("factor",), "must not be zero, got 0; reading over true value"))
        return self

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return reading * self._factors(channels)

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1) solved for the true value."""
        return reading / self._factors(channels)

    def noise(self, std: Floats, channels: Channels) -> Floats:
        """Return the noise, which is in the wrong unit too."""
        return std * np.abs(self._factors(channels))

    def _factors(self, channels: Channels) -> Floats:
        return np.where(self.acts_on(channels), self.factor, 1.0)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From millimetres to metres and back, degrees and inches between."""
        source = "conversions of units in use: 1e-3 and 1e3 (mm), 0.0254 (inch), 0.0175 and 57.3 (degree)"
        return {"factor": Prior(5e-4, 2e3, 1.0, "log", "-", source)}
