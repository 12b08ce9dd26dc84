r"""A free parameter on the scale of its prior, so that all parameters of a fit are alike.

    z = (u - m)/s,    u = ln p where the prior is logarithmic, else p                                  (1)

p is the parameter, m and s mode and sigma of its prior (of a lopsided one that on the side where u is; of a
uniform one an eighth of its width). The density of z has the wide tails of Student's t with three degrees of
freedom, as some machines are unlike all others,

    ln p(z) = -2 ln(1 + z^2/3) + ln(2/(pi sqrt 3)).                                                    (2)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log, log1p, pi

from flexarm.arm import Arm
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.diagnosis.candidates.candidate import Candidate

BOUNDS = {"log": 8.0, "linear": 400.0, "uniform": 40.0}
"""Of a parameter in sigmas of its prior, by the prior's scale: factors of thousands, or turns."""
STEP = 1e-2
"""Of differences, in sigmas of a prior: laws with corners need steps that reach beyond them."""
TURN = 0.1
"""Most that the step of a frequency may turn the phase until the end of a record [rad]."""


@dataclass(frozen=True)
class Coordinate:
    """A free parameter on the scale of its prior.

    Attributes
    ----------
    candidate : int
        Which effect of the set.
    name : str
        Of the parameter.
    prior : Prior
        At the start of the fit.
    """

    candidate: int
    name: str
    prior: Prior

    def z(self, value: float) -> float:
        """Sigmas from the mode."""
        mode, below, above = self._pieces()
        u = log(value) if self.prior.scale == "log" else value
        return (u - mode) / (below if u < mode else above)

    def value(self, z: float) -> float:
        """The parameter."""
        mode, below, above = self._pieces()
        u = mode + z * (below if z < 0 else above)
        return exp(u) if self.prior.scale == "log" else u

    def slope(self, z: float) -> float:
        """d(value)/dz."""
        _, below, above = self._pieces()
        size = below if z < 0 else above
        return size * self.value(z) if self.prior.scale == "log" else size

    def step(self, z: float, seconds: float) -> float:
        """Of differences; of a frequency so small that the wave stays in step for so many seconds."""
        if self.name != "frequency" or seconds == 0:
            return STEP
        return min(STEP, TURN / (2 * pi * seconds * self.slope(z)))

    def log_density(self, z: float) -> float:
        """Eq. (2); of a uniform prior, the same everywhere."""
        if self.prior.scale == "uniform":
            return -log(8.0)
        return -2.0 * log1p(z * z / 3.0) - 1.0008889  # eq. (2)

    def _pieces(self) -> tuple[float, float, float]:
        low, mode, high = self.prior.low, self.prior.typical, self.prior.high
        if self.prior.scale == "uniform":
            return mode, (high - low) / 8, (high - low) / 8
        if self.prior.scale == "log":
            low, mode, high = log(low), log(mode), log(high)
        return mode, (mode - low) / QUANTILE, (high - mode) / QUANTILE

    @property
    def bound(self) -> float:
        """Greatest size of z in a fit."""
        return BOUNDS[self.prior.scale]


def coordinates_of(members: Sequence[Candidate], arm: Arm) -> tuple[Coordinate, ...]:
    """The free parameters of a set of effects, in their order."""
    return tuple(
        Coordinate(k, name, prior)
        for k, member in enumerate(members)
        for name, prior in member.priors_in(arm).items()
        if name in member.free
    )
