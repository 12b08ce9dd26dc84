"""Estimates of a calibration as data: parameters, families, frames and the measure of fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from flexarm.json_values import KnownOrNan

OneSided = Literal["", "low", "high"]
Kind = Literal["family", "nominal", "clock", "frame", "base"]
"""Kinds of parameters, in the order of a result."""
DETERMINED = 0.5
"""Share of its prior variance [-] that data remove from a parameter that they determine."""


@dataclass(frozen=True)
class Range:
    """A value with its 90 % interval [its unit]."""

    value: float
    low90: KnownOrNan
    high90: KnownOrNan


@dataclass(frozen=True)
class CalibratedParameter:
    """Estimate of a parameter."""

    name: str
    """Key of the model's parameter."""
    kind: Kind
    value: float
    std: KnownOrNan
    low90: KnownOrNan
    high90: KnownOrNan
    """Posterior mode, 1 sigma and 90 % interval [unit]."""
    unit: str
    prior: Range
    """Before any data."""
    identifiability: Annotated[float, Field(ge=0, le=1)]
    """Share of the prior variance that the data removed [-]; of a member of a family, of its spread."""
    family: str = ""
    """Effect of its family; empty without one."""
    one_sided: OneSided = ""
    """The end that data alone set, if they set one: "low" of a spring that cannot be told from rigid, "high"
    of what cannot be told from none. The prior sets the other."""

    @property
    def determined(self) -> bool:
        """Return True if the data removed most of the prior variance, and set both ends."""
        return self.identifiability > DETERMINED and not self.one_sided


@dataclass(frozen=True)
class CalibratedFamily:
    """One parameter of an effect at all its places."""

    effect: str
    parameter: str
    unit: str
    at: tuple[str, ...]
    shared: Range | None
    """Size that the members share; None for errors of either sign."""
    spread: float
    """Standard deviation of the members about it: of ln(size) [-], or of errors of either sign [unit]."""


@dataclass(frozen=True)
class CalibratedFrame:
    """Estimated pose of a frame of measurement in the base: xyz [m], and roll, pitch, yaw [rad]."""

    name: str
    xyz: tuple[float, ...]
    rpy: tuple[float, ...]


@dataclass(frozen=True)
class ChiSquare:
    """Goodness of fit on the training."""

    value: float
    """Sum of squared residuals over their stated noise [-]."""
    rows: int
    parameters: float
    """Effective number that the data determine: trace of the covariance times J^T W J [-]."""
    inflation: Mapping[str, float]
    """Long-run variance of the residual over that of the noise by signal, which widens intervals [-]."""

    @property
    def reduced(self) -> float:
        """Chi-square over its degrees of freedom [-]; 1 if only noise is left."""
        return self.value / max(self.rows - self.parameters, 1.0)
