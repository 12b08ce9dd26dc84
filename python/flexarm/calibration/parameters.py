"""Free parameters of a calibration, each on the scale u on which its prior is normal.

    u = ln p    where p must be positive,    u = p    elsewhere                                       (1)

Clocks, frames and nominal values with an uncertainty are those of the diagnosis (`diagnosis.nuisance`). To
them come the parameters of families of effects (`calibration.families`).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log
from typing import Literal

from flexarm.arm.prior import Prior
from flexarm.diagnosis.nuisance import NuisanceParameter

Kind = Literal["clock", "frame", "nominal", "start", "base", "family"]


@dataclass(frozen=True)
class FreeParameter:
    """A parameter that is estimated."""

    key: str
    """Parameter of the model."""
    unit: str
    kind: Kind
    """A "start" is an initial vibration of a record, "base" the tilt of its base."""
    scale: Literal["log", "linear"]
    """Of (1)."""
    centre: float
    sigma: float
    """Normal prior of u; of a member of a family that of the member alone."""
    step: float | None = None
    """Step of difference quotients [unit] of non-smooth laws; None: a small one."""

    @classmethod
    def of_nuisance(cls, given: NuisanceParameter) -> FreeParameter:
        """Return a clock, frame, nominal value or start; in the logarithm if it must be positive."""
        if given.one_sign and given.centre > 0:
            centre, sigma = log(given.centre), given.sigma / given.centre
            return cls(given.key, given.unit, given.kind, "log", centre, sigma)
        return cls(given.key, given.unit, given.kind, "linear", given.centre, given.sigma)

    @classmethod
    def of_family(cls, key: str, prior: Prior, sigma: float, step: float | None) -> FreeParameter:
        """Return a member of a family, centred on the typical value."""
        if prior.scale == "log":
            return cls(key, prior.unit, "family", "log", log(prior.typical), sigma, step)
        return cls(key, prior.unit, "family", "linear", prior.typical, sigma, step)

    @property
    def of_record(self) -> bool:
        """Return True if it belongs to one record, not to the model: it acts linearly about any model."""
        return self.kind in ("start", "base")

    def value(self, u: float) -> float:
        """Return p of (1)."""
        return exp(u) if self.scale == "log" else u

    def slope(self, u: float) -> float:
        """Return dp/du."""
        return exp(u) if self.scale == "log" else 1.0
