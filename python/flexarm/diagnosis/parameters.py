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

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import WEIGHT, Candidate
from flexarm.errors import InvalidParameter

BOUNDS = {"log": 8.0, "linear": 400.0, "uniform": 40.0}
"""Of a parameter in sigmas of its prior, by the prior's scale: factors of thousands, or turns."""
FACTOR = 30.0
"""The least reach of a logarithmic one: a mass that was written down wrong is many sigmas off."""
STEP, ACROSS = 3e-4, 1e-2
"""Of differences, in sigmas of a prior; laws with corners need steps that reach across those.

A hundredth of a sigma of a stiffness turns the phase of a vibration by tenths of a radian in a minute. The
derivative was off by 4 % then, which told it from the link's modulus, though nothing can.
"""
TURN = 0.01
"""Most that the step of a frequency may turn the phase until the end of a record [rad]."""


@dataclass(frozen=True)
class TransformedParameter:
    """A free parameter on the scale of its prior.

    Attributes
    ----------
    candidate : int
        Which effect of the set.
    name : str
        Of the parameter.
    prior : Prior
        At the start of the fit.
    smooth : bool
        Whether its law has no corners.
    weight : float
        Of its prior in a fit, unless that is uniform.
    """

    candidate: int
    name: str
    prior: Prior
    smooth: bool = True
    weight: float = WEIGHT

    @property
    def held(self) -> float:
        """Return the root of the weight with which its prior holds z in a fit."""
        return 1e-3 if self.prior.scale == "uniform" else self.weight

    def z(self, value: float) -> float:
        """Sigmas from the mode.

        Raises
        ------
        InvalidParameter
            If there is no such logarithm.
        """
        if self.prior.scale == "log" and not value > 0:
            raise InvalidParameter(f"{self.name} must be positive, got {value:g} {self.prior.unit}")
        mode, below, above = self._pieces()
        u = log(value) if self.prior.scale == "log" else value
        return (u - mode) / (below if u < mode else above)

    def value(self, z: float) -> float:
        """Return the parameter."""
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
            return self.widest_step
        return min(self.widest_step, TURN / (2 * pi * seconds * self.slope(z)))

    @property
    def widest_step(self) -> float:
        """Of differences, whatever z is."""
        return STEP if self.smooth else ACROSS

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
        bound = BOUNDS[self.prior.scale]
        return max(bound, log(FACTOR) / min(self._pieces()[1:])) if self.prior.scale == "log" else bound


def transformed_parameters(members: Sequence[Candidate], arm: Arm) -> tuple[TransformedParameter, ...]:
    """Return the free parameters of a set of effects, in their order."""
    return tuple(
        TransformedParameter(k, name, prior, member.effect.smooth, member.prior_weight(name))
        for k, member in enumerate(members)
        for name, prior in member.priors_in(arm).items()
        if name in member.free
    )


def prior_rows(parameters: Sequence[TransformedParameter], z: Floats) -> tuple[Floats, Floats]:
    """Return the priors' rows of a least-squares problem, with squares ln(1 + (z/3)^2), and their
    derivatives.
    """
    weak = np.array([c.held for c in parameters])
    x = weak * z
    rows = np.sign(x) * np.sqrt(np.log1p(x**2))
    near = np.abs(x) < 1e-4  # where the row is x
    jacobian = np.where(near, 1.0, x / (1 + x**2) / np.where(near, 1.0, rows))
    return rows, weak * jacobian


def members_at(
    members: Sequence[Candidate], parameters: Sequence[TransformedParameter], z: Floats
) -> tuple[Candidate, ...]:
    """Return the effects with these parameters."""
    found = list(members)
    for k, member in enumerate(found):
        values = {c.name: c.value(float(x)) for c, x in zip(parameters, z, strict=True) if c.candidate == k}
        found[k] = member.with_parameters(values)
    return tuple(found)
