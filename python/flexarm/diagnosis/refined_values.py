"""Refined nominal values of a model, with the sigmas that it states."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, isfinite, log10

from flexarm.arm import Arm
from flexarm.arm.parameter import parameters, path_of
from flexarm.comparison.align import KEPT
from flexarm.named_effects import Refined
from flexarm.wording import scale, signed


@dataclass(frozen=True)
class Refinement:
    """A refined value and its stated sigma."""

    refined: Refined
    """The value."""
    sigma: float | None
    """1 sigma that the model states; None if it states none."""

    @property
    def moved(self) -> float:
        """Return the distance from the nominal value [unit]."""
        return self.refined.value - self.refined.nominal

    @property
    def pull(self) -> float | None:
        """Return `moved` in stated sigmas."""
        return self.moved / self.sigma if self.sigma else None

    @property
    def determined(self) -> bool:
        """Return True if the data say more than was known."""
        return self.sigma is None or self.refined.std < KEPT * self.sigma

    @property
    def changed(self) -> bool:
        """Return True if the repaired model has another value; those that are left open mostly have not."""
        return self.refined.changed

    @property
    def texts(self) -> tuple[str, str, str]:
        """Moved and 1 sigma with the digits that this leaves, and the unit of both."""
        std = self.refined.std
        factor, unit = scale([self.moved, std], self.refined.unit)
        if not isfinite(std) or std <= 0:
            return signed(factor * self.moved, 2), "–", unit
        places = max(0, min(9, 1 - floor(log10(factor * std))))
        return signed(factor * self.moved, places), f"{factor * std:.{places}f}", unit


def stated_sigma(arm: Arm, key: str) -> float | None:
    """Return 1 sigma of a parameter from `[uncertainty]`: of the value itself or of its vector, or None.

    `key` is such as "points.tip.position.x"; the model's own key may end in a unit.
    """
    for given in arm.uncertainty:
        if key in {parameter.key for parameter in parameters(arm, given)}:
            _, sigma = arm.sigma(given)
            component = path_of(arm, key).component or 0
            return float(sigma[component] if isinstance(sigma, tuple) else sigma) or None
    return None
