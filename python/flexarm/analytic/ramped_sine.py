"""A sine that starts from rest: the swing of the paper's arm without its jump of velocity."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from flexarm.analytic.nonlinear_modal import Array
from flexarm.errors import InvalidParameter

_RAMP = Polynomial([0, 0, 0, 10, -15, 6])
"""s(x) = 10 x³ - 15 x⁴ + 6 x⁵: from 0 to 1 with rate and acceleration zero at both ends."""


@dataclass(frozen=True)
class RampedSine:
    """φ(t) = A sin(2 π f t) s(t/T) for t > 0, with s = 1 from t = T on."""

    amplitude: float
    """A [rad]."""
    frequency: float
    """f [Hz]."""
    rise: float
    """T [s]."""

    def __post_init__(self) -> None:
        if not (self.rise > 0 and math.isfinite(self.rise)):
            raise InvalidParameter(f"rise of a ramped sine must be positive, got {self.rise} s")

    def __call__(self, t: ArrayLike, nu: int = 0, /) -> Array:
        """Return the nu-th derivative at `t` [s], by Leibniz' rule."""
        time, omega = np.maximum(np.asarray(t, dtype=float), 0.0), 2 * math.pi * self.frequency
        x = np.minimum(time / self.rise, 1.0)
        value = np.zeros_like(time)
        for k in range(nu + 1):
            ramp = (_RAMP.deriv(k) if k else _RAMP)(x) / self.rise**k
            if k:
                ramp = np.where(time < self.rise, ramp, 0.0)
            sine = omega ** (nu - k) * np.sin(omega * time + (nu - k) * math.pi / 2)
            value = value + math.comb(nu, k) * ramp * sine
        result: Array = self.amplitude * value
        return result
