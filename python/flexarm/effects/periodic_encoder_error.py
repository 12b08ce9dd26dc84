r"""Periodic error of an encoder that turns: so many periods per turn of the output.

.. math:: \text{reading} = \text{true}
   + \text{amplitude} \, \sin(\text{order} \cdot \text{true} + \text{phase})                          (1)

Solving (1) for the true angle converges by repeated substitution, as amplitude x order < 1. A linear scale
has no turn, so that it cannot have such an error.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.joint_units import slides
from flexarm.arm.sensor_effect import Channels, SignalEffect
from flexarm.arm.wave_effect import WaveEffect

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arrays import Floats


class PeriodicEncoderError(WaveEffect, SignalEffect):
    """Error of an encoder over the turn; a subclass has `order`, `amplitude` and `phase`."""

    quantities = ("joint_angle",)
    of_drives = True

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Also refuse an encoder of a joint that slides."""
        yield from super().problems(arm)
        if slides(arm, self.at):
            yield "at", f"{self.name} repeats with turns, and the joint of {self.at!r} slides"

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1)."""
        return reading + self._error(true)

    def undone(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Eq. (1) without its last term, for a true angle known so far."""
        return reading - self._error(true)

    def _error(self, true: Floats) -> Floats:
        return self.value_of("amplitude") * np.sin(self.value_of("order") * true + self.value_of("phase"))
