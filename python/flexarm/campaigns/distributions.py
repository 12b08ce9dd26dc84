"""Distributions of one parameter, by their quantile functions x(u) for u in (0, 1).

    normal      x = m + s z(u)                                              z: quantile of the standard normal
    lognormal   x = exp(mu + t z(u)),  t^2 = ln(1 + s^2/m^2),  mu = ln m - t^2/2                           (1)
    uniform     x = a + (b - a) u
    loguniform  x = a (b/a)^u
    values      x = x_k,  k = floor(u K)

m and s are mean and standard deviation of x itself, of the lognormal one too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats


@dataclass(frozen=True)
class Distribution:
    """A distribution."""

    kind: str
    """Its name in a study."""
    numbers: tuple[float, ...]
    """Mean and standard deviation, ends, or the values."""

    def quantile(self, u: Floats) -> Floats:
        """Return x(u)."""
        from scipy.special import ndtri

        x = np.asarray(self.numbers)
        if self.kind == "values":
            found = x[np.minimum((u * len(x)).astype(int), len(x) - 1)]
        elif self.kind == "uniform":
            found = x[0] + (x[1] - x[0]) * u
        elif self.kind == "loguniform":
            found = x[0] * (x[1] / x[0]) ** u
        elif self.kind == "lognormal":
            variance = np.log1p((x[1] / x[0]) ** 2)  # eq. (1)
            found = np.exp(np.log(x[0]) - variance / 2 + np.sqrt(variance) * ndtri(u))
        else:
            found = x[0] + x[1] * ndtri(u)
        return np.asarray(found, dtype=float)

    def levels(self, count: int | None) -> Floats:
        """Return the values of a grid: equally spaced from end to end, or midpoints of equal probability."""
        if self.kind == "values" or count is None:
            return np.asarray(self.numbers)
        if self.kind in ("uniform", "loguniform") and count > 1:
            return self.quantile(np.linspace(0, 1, count))
        return self.quantile((np.arange(count) + 0.5) / count)

    @property
    def median(self) -> float:
        """x(1/2)."""
        return float(self.quantile(np.array([0.5]))[0])
