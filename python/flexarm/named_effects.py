"""Effects and values as a diagnosis names them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from flexarm.json_values import KnownOrNan, LogEvidence

Probability = Annotated[float, Field(ge=0, le=1)]
Place = str | tuple[str, ...]
"""Where an effect sits: a place, or all places of a family."""


def place_text(at: Place) -> str:
    """Return a place, or places with commas."""
    return at if isinstance(at, str) else ", ".join(at)


NORMAL_90 = 1.6448536
"""Deviations of a normal distribution between which 90 % lie."""


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter."""

    name: str
    """As `Effect.parameters` spells it, such as "stiffness" or "offset.x"."""
    value: float
    std: KnownOrNan
    low90: KnownOrNan
    high90: KnownOrNan
    """Estimate, 1 sigma, and the 90 % interval [unit]."""
    unit: str
    """Of all four."""

    @classmethod
    def normal(cls, name: str, value: float, std: float, unit: str) -> Estimate:
        """Return an estimate with the 90 % interval of a normal distribution."""
        return cls(name, value, std, value - NORMAL_90 * std, value + NORMAL_90 * std, unit)


@dataclass(frozen=True)
class Alternative:
    """An effect that the data cannot tell from the named one."""

    name: str
    at: Place
    probability: Probability
    """Among the named effect and its alternatives."""


@dataclass(frozen=True)
class NamedEffect:
    """An effect that the diagnosis names."""

    name: str
    at: Place
    probability: Probability
    """That this is the effect, all alternatives considered."""
    parameters: tuple[Estimate, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    """All others within a Bayes factor of 20."""
    evidence: str = ""
    """One sentence for a person."""

    @property
    def places(self) -> tuple[str, ...]:
        """Return its place, or all places of a family."""
        return (self.at,) if isinstance(self.at, str) else self.at


@dataclass(frozen=True)
class Nuisance:
    """A clock offset or registration that was fitted along: an effect within its stated uncertainty."""

    name: str
    at: str
    parameters: tuple[Estimate, ...]
    undetermined: tuple[str, ...] = ()
    """Names of the parameters that the data leave as they are stated."""


@dataclass(frozen=True)
class Refined:
    """A nominal value that was refined within its stated uncertainty; `parameter` is its key."""

    parameter: str
    value: float
    std: float
    nominal: float
    unit: str = ""

    @property
    def changed(self) -> bool:
        """Return True if the value moved by more than a thousandth of its standard deviation.

        Values that the data do not tell, as across the plane of a planar arm, have not.
        """
        return abs(self.value - self.nominal) > 1e-3 * self.std


@dataclass(frozen=True)
class Rejected:
    """A candidate that was tried: its evidence against the chosen effects', and why it was not taken.

    `log_bayes_factor` is the natural logarithm of evidence with the candidate over evidence with what was
    chosen: 0 is as good, below -ln 20 is out of reach.
    """

    name: str
    at: Place
    log_bayes_factor: LogEvidence
    why: str


@dataclass(frozen=True)
class Stage:
    """A model on the way from the nominal to the repaired one, with its gap by record [the signal's unit]."""

    label: str
    """What was added: "nominal", an effect, "nominal values refined"."""
    rms: Mapping[str, KnownOrNan]
    """Total rms of the main signal, aligned, by record (the held-out one too)."""
