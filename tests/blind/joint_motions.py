"""Angles of motors with two derivatives at arrays of times, for robots of rods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from serial_chain import Floats

Angles = tuple[Floats, Floats, Floats]


def smooth_step(x: Floats) -> Angles:
    """s = 10 x^3 - 15 x^4 + 6 x^5 from 0 to 1, and its derivatives by x."""
    x = np.clip(x, 0.0, 1.0)
    first, second = 30 * (x * (1 - x)) ** 2, 60 * x * (1 - x) * (1 - 2 * x)
    return x**3 * (10 - 15 * x + 6 * x * x), first, second


@dataclass(frozen=True)
class Sines:
    """middle + s(t/rise) sum_i a_i sin(2 pi f_i t + p_i): a sine, or a multisine."""

    amplitudes: Sequence[float]
    frequencies: Sequence[float]
    phases: Sequence[float]
    middle: float = 0.0
    rise: float = 3.0

    def __call__(self, t: Floats) -> Angles:
        """phi, phi' and phi''."""
        f = f1 = f2 = np.zeros_like(t)
        for a, frequency, phase in zip(self.amplitudes, self.frequencies, self.phases, strict=True):
            w = 2 * np.pi * frequency
            sine, cosine = a * np.sin(w * t + phase), a * np.cos(w * t + phase)
            f, f1, f2 = f + sine, f1 + w * cosine, f2 - w * w * sine
        s, s1, s2 = smooth_step(np.asarray(t) / self.rise)
        s1, s2 = s1 / self.rise, s2 / self.rise**2
        return self.middle + s * f, s * f1 + s1 * f, s * f2 + 2 * s1 * f1 + s2 * f


@dataclass(frozen=True)
class Stops:
    """Rests at angles, one after the other: moves begin at `starts` and last `lasts` [s]."""

    angles: Sequence[float]
    starts: Sequence[float]
    lasts: Sequence[float]

    def __call__(self, t: Floats) -> Angles:
        """phi, phi' and phi''."""
        f, f1, f2 = np.full_like(t, self.angles[0]), np.zeros_like(t), np.zeros_like(t)
        for way, start, last in zip(np.diff(self.angles), self.starts, self.lasts, strict=True):
            s, s1, s2 = smooth_step((np.asarray(t) - start) / last)
            f, f1, f2 = f + way * s, f1 + way * s1 / last, f2 + way * s2 / last**2
        return f, f1, f2
