"""Motor angles with two derivatives, as the chain of rods wants them and as flexarm does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Swing:
    """middle + amplitude sin(2 pi t/period) s(t/rise), s(x) = 10 x^3 - 15 x^4 + 6 x^5 up to x = 1, then 1."""

    amplitude: float
    period: float
    rise: float
    middle: float = 0.0

    def __call__(self, t: float) -> tuple[float, float, float]:
        """phi, phi', phi''."""
        w, x = 2 * np.pi / self.period, min(max(t / self.rise, 0.0), 1.0)
        S = x**3 * (10 - 15 * x + 6 * x * x)
        S1 = 30 * (x * (1 - x)) ** 2 / self.rise
        S2 = 60 * x * (1 - x) * (1 - 2 * x) / self.rise**2
        sine, cosine = np.sin(w * t), np.cos(w * t)
        return (
            self.middle + self.amplitude * sine * S,
            self.amplitude * (w * cosine * S + sine * S1),
            self.amplitude * (2 * w * cosine * S1 + sine * (S2 - w * w * S)),
        )


def held(angle: float):
    """A motor that stands."""
    return lambda t: (angle, 0.0, 0.0)
