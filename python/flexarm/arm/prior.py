r"""Prior distributions of parameters.

A two-piece normal distribution [Wallis2014]_ of u, the value itself or its logarithm, about its mode m,

.. math:: p(u) = \frac{2}{\sqrt{2\pi} (\sigma_1 + \sigma_2)} \exp\left(-\frac{(u - m)^2}{2\sigma^2}\right),
   \quad \sigma = \sigma_1 \; (u < m), \; \sigma_2 \; (u \ge m)                                       (1)

With \sigma_1 = (m - u_{low})/1.96 and \sigma_2 = (u_{high} - m)/1.96 the range low to high holds 95 %
exactly, wherever in it the mode lies. A value with a logarithmic scale has the density p(\ln x)/x. An angle
of which nothing is known is uniform from low to high.

References
----------
.. [Wallis2014] K. F. Wallis, "The two-piece normal, binormal, or double Gaussian distribution: its origin and
   rediscoveries", Statistical Science 29(1), 2014.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, inf, log, pi, sqrt
from typing import TYPE_CHECKING, Literal

from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    import numpy as np

QUANTILE = 1.959963984540054
"""97.5 % quantile of the normal distribution."""


@dataclass(frozen=True)
class Prior:
    """Plausible values of a parameter."""

    low: float
    high: float
    """Range that holds about 95 % of machines; all of them with scale "uniform"."""
    typical: float
    """The most plausible value."""
    scale: Literal["log", "linear", "uniform"]
    """What is normally distributed, eq. (1): the logarithm or the value; "uniform": neither."""
    unit: str
    """Of the three values."""
    source: str
    """Where they come from, one sentence."""

    def __post_init__(self) -> None:
        if not self.low < self.typical < self.high:
            raise InvalidParameter(
                f"must have low < typical < high, got {self.low:g}, {self.typical:g}, {self.high:g} "
                f"{self.unit}",
                where="Prior",
            )
        if self.scale == "log" and self.low <= 0:
            raise InvalidParameter(f"a logarithmic scale needs low > 0, got {self.low:g}", where="Prior")

    def log_density(self, value: float) -> float:
        """ln p of a value, eq. (1); -inf where none is possible."""
        if self.scale == "uniform":
            return -log(self.high - self.low) if self.low <= value <= self.high else -inf
        if self.scale == "log" and value <= 0:
            return -inf
        mode, below, above = self.two_pieces()
        u = log(value) if self.scale == "log" else value
        sigma = below if u < mode else above
        peak = log(2 / (sqrt(2 * pi) * (below + above)))
        return peak - (u - mode) ** 2 / (2 * sigma**2) - (u if self.scale == "log" else 0.0)  # eq. (1)

    def sample(self, rng: np.random.Generator) -> float:
        """Return a random value."""
        if self.scale == "uniform":
            return float(rng.uniform(self.low, self.high))
        mode, below, above = self.two_pieces()
        size = abs(float(rng.standard_normal()))
        left = float(rng.uniform()) * (below + above) < below  # share of (1) on that side
        u = mode - below * size if left else mode + above * size
        return exp(u) if self.scale == "log" else u

    def two_pieces(self) -> tuple[float, float, float]:
        """Return m, sigma_1 and sigma_2 of (1)."""
        low, mode, high = self.low, self.typical, self.high
        if self.scale == "log":
            low, mode, high = log(low), log(mode), log(high)
        return mode, (mode - low) / QUANTILE, (high - mode) / QUANTILE


Priors = Mapping[str, Prior]
Values = Mapping[str, float]
"""By the names of parameters."""
