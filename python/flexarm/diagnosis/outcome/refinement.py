"""Nominal values that moved: by how much, in their own unit and in the sigmas that the model states.

    moved = value - nominal,    pull = moved/sigma                                                   (1)

A value is determined by the data if they leave less than `KEPT` of its stated sigma.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import floor, isfinite, log10
from typing import TYPE_CHECKING

from flexarm.arm.parameter import parameters, path_of
from flexarm.comparison.align import KEPT
from flexarm.diagnosis.wording import scale, signed

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.diagnosis.named import Refined
    from flexarm.diagnosis.outcome.result import Diagnosis

STILL = 1e-3
"""Of its 1 sigma a value may move and still count as where it was."""


@dataclass(frozen=True)
class Refinement:
    """A refined value beside what was stated of it.

    Attributes
    ----------
    refined : Refined
        The value.
    sigma : float or None
        1 sigma that the model states; None if it states none.
    """

    refined: Refined
    sigma: float | None

    @property
    def moved(self) -> float:
        """From the nominal value, eq. (1)."""
        return self.refined.value - self.refined.nominal

    @property
    def pull(self) -> float | None:
        """In stated sigmas, eq. (1)."""
        return self.moved / self.sigma if self.sigma else None

    @property
    def determined(self) -> bool:
        """Whether the data say more than was known."""
        return self.sigma is None or self.refined.std < KEPT * self.sigma

    @property
    def changed(self) -> bool:
        """Whether the repaired model has another value; those that are left open mostly have not."""
        return abs(self.moved) > STILL * self.refined.std

    @property
    def texts(self) -> tuple[str, str, str]:
        """Moved and 1 sigma with the digits that this leaves, and the unit of both."""
        std = self.refined.std
        factor, unit = scale([self.moved, std], self.refined.unit)
        if not isfinite(std) or std <= 0:
            return signed(factor * self.moved, 2), "–", unit
        places = max(0, min(9, 1 - floor(log10(factor * std))))
        return signed(factor * self.moved, places), f"{factor * std:.{places}f}", unit


def refinements(diagnosis: Diagnosis) -> Iterator[Refinement]:
    """All refined values of a diagnosis."""
    for each in diagnosis.refined:
        yield Refinement(each, stated_sigma(diagnosis.arm, each.parameter))


def stated_sigma(arm: Arm, key: str) -> float | None:
    """1 sigma that `[uncertainty]` gives a parameter: of the value itself or of the vector it is part of.

    Parameters
    ----------
    arm : Arm
        The nominal model.
    key : str
        The parameter, such as "points.tip.position.x"; the model's own key may end in a unit.
    """
    for given in arm.uncertainty:
        if key in {parameter.key for parameter in parameters(arm, given)}:
            _, sigma = arm.sigma(given)
            component = path_of(arm, key).component or 0
            return float(sigma[component] if isinstance(sigma, tuple) else sigma) or None
    return None
