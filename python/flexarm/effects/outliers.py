r"""Outliers: a share of the samples is far off, all their channels together.

With the probability `share` a row gains normal numbers of 1 sigma `size`, independent in each channel:

.. math:: p(r) = (1 - \text{share}) \, N(r; 0, \sigma^2) + \text{share} \, N(r; 0, \sigma^2 + \text{size}^2)
   (1)

r is what noise and outliers make of a row of d channels, \sigma the noise. A row is taken for an outlier
where the second term of (1) is the greater one, which is where

.. math:: |r|^2 \, \left(\frac{1}{\sigma^2} - \frac{1}{\sigma^2 + \text{size}^2}\right) > d \,
   \ln\frac{\sigma^2 + \text{size}^2}{\sigma^2} + 2 \ln\frac{1 - \text{share}}{\text{share}}          (2)

No prediction knows which rows: a virtual measurement draws them, a comparison removes them.
Source: the contaminated normal distribution of [Tukey1960].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.arm import Arm
from flexarm.arm.effect import Derivative
from flexarm.arm.prior import Prior
from flexarm.arm.sensor_effect import SignalEffect
from flexarm.arrays import Floats
from flexarm.tables import Number, value_in


class Outliers(SignalEffect):
    """Samples that are far off."""

    name = "outliers"
    competes = False
    varies_with = "time"
    share: Number = value_in("-", "share of rows that are off", 0.0, ge=0, lt=0.5)
    size: Number = value_in("SI", "1 sigma of how far off, per channel", 0.0, ge=0)

    def thrown(self, values: Floats, rng: np.random.Generator) -> Floats:
        """Values, shape (n, channels), a share of whose rows is off: a draw from (1)."""
        off = rng.random(len(values)) < self.share
        return values + off[:, None] * self.size * rng.standard_normal(values.shape)

    def told_apart(self, residual: Floats, noise: Floats) -> NDArray[np.bool_]:
        """Rows of residuals, shape (n, channels), that (2) takes for outliers; `noise` is by channel."""
        if not self.share or not self.size:
            return np.zeros(len(residual), dtype=bool)
        floor = np.maximum(noise, 1e-9 * self.size)
        wide = floor**2 + self.size**2
        evidence = np.sum(residual**2 * (1 / floor**2 - 1 / wide) - np.log(wide / floor**2), axis=1)
        return np.asarray(evidence > 2 * np.log((1 - self.share) / self.share))  # eq. (2)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of broken beams, reflections and lost words."""
        rare = "engineering judgement: a tracker in an open hall confuses 0.01 to 10 % of its samples"
        far = "engineering judgement: from a multiple of the noise to the size of the arm"
        return {
            "share": Prior(1e-4, 0.1, 5e-3, "log", "-", rare),
            "size": Prior(1e-4, 1.0, 1e-2, "log", "SI", far),
        }

    def derivative(self, parameter: str) -> Derivative:
        """No prediction depends on it."""
        return "none"
