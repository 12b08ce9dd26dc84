r"""Offset of a sensor: a bridge that was not balanced, an IMU's bias, a probe that was not zeroed.

.. math:: \text{reading} = \text{true} + \text{offset}                                               (1)
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import ChannelEffect, Channels, Measured, Vector
from flexarm.arrays import Floats
from flexarm.quantities import channel_names
from flexarm.tables import to_python, value_in


def _number_or_three(value: Any) -> Any:
    value = to_python(value)
    each = list(value) if isinstance(value, list | tuple) else [value]
    fits = len(each) == 3 or not isinstance(value, list | tuple)
    if not fits or not all(isinstance(x, int | float) and not isinstance(x, bool) for x in each):
        raise ValueError(f"must be a number, or a list of 3 numbers along x, y, z, got {value!r}")
    return tuple(map(float, value)) if isinstance(value, list | tuple) else float(value)


class SensorOffset(ChannelEffect):
    """Offset of channels.

    `offset` is one number for all these channels, or three along the signal's axes x, y, z, of which those
    that are not measured count for nothing.
    """

    name = "sensor_offset"
    not_sought_in = ("position", "orientation")
    offset: Annotated[float | Vector, BeforeValidator(_number_or_three)] = value_in(
        "SI", "offset of the channels", 0.0
    )

    def misfit(self, what: Measured) -> str | None:
        """Also if three numbers are given for a signal without axes."""
        if isinstance(self.offset, tuple) and not set(channel_names(what.quantity, what.axes)) <= set("xyz"):
            return f"needs one number as offset, {what.name!r} measures {what.quantity} and has no axes"
        return super().misfit(what)

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return reading + self._offsets(channels)

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1) solved for the true value."""
        return reading - self._offsets(channels)

    def _offsets(self, channels: Channels) -> Floats:
        """Offset of every channel, shape (channels,)."""
        offset = self.offset
        values = [offset["xyz".index(name)] if isinstance(offset, tuple) else offset for name in channels]
        return np.where(self.acts_on(channels), values, 0.0)

    @classmethod
    def priors_from(cls, greatest: float, noise: float, unit: str) -> dict[str, Prior]:
        """Return up to a tenth of the greatest reading, but at least ten times the noise."""
        high = max(0.1 * greatest, 10 * noise)
        source = "10 % of the greatest reading in the records"
        return {"offset": Prior(-high, high, 0.0, "linear", unit, source)}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a bridge or a probe that was not zeroed."""
        source = "engineering judgement: one per cent of a range of 1 in SI units"
        names = [name for name, _, _ in self.parameters()]
        return dict.fromkeys(names, Prior(-1e-2, 1e-2, 0.0, "linear", "SI", source))
