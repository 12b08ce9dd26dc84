r"""Quantisation of an encoder: it counts in steps.

.. math:: \text{reading} = \text{step} \, \operatorname{round}(r / \text{step})                       (1)

with the reading r of the effects before it. The error is at most step/2 and, over many steps, step/sqrt(12)
rms: smoothing and weights take it as noise of that size. (1) has no derivative; without rounding it is the
identity.
"""

from __future__ import annotations

import numpy as np

from flexarm.arm.arm import Arm
from flexarm.arm.effect import Derivative
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import Channels, SignalEffect
from flexarm.arrays import Floats
from flexarm.tables import Number, value_in


class EncoderQuantisation(SignalEffect):
    """Quantisation of an encoder."""

    name = "encoder_quantisation"
    competes = False
    varies_with = "time"
    quantities = ("joint_angle",)
    of_drives = True
    rounds = True
    step: Number = value_in("rad", "step of the encoder, output-referred", 0.0, ge=0)

    def reading(self, reading: Floats, true: Floats, channels: Channels) -> Floats:
        """Return (1)."""
        return np.round(reading / self.step) * self.step if self.step else reading  # eq. (1)

    def noise(self, std: Floats, channels: Channels) -> Floats:
        """Return the noise with step/sqrt(12) added in quadrature."""
        found: Floats = np.hypot(std, self.step / np.sqrt(12))
        return found

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return the prior from a fine encoder before a reducer to a coarse one after it."""
        source = "catalogues: 23 bits a turn before a reducer of 100 (7e-9 rad) to 14 bits after it (4e-4)"
        return {"step": Prior(5e-9, 5e-4, 3e-6, "log", "rad", source)}

    def derivative(self, parameter: str) -> Derivative:
        """Return "none": a staircase has no derivative."""
        return "none"
