"""Estimates of a calibration as data: parameters, families, frames and the measure of fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.calibration.policy import CalibrationPolicy


@dataclass(frozen=True)
class Range:
    """A value with its 90 % interval [its unit]."""

    value: float
    low90: float
    high90: float


@dataclass(frozen=True)
class CalibratedParameter:
    """An estimate."""

    name: str
    """Key of the model's parameter."""
    kind: str
    """What it is: "family", "nominal", "clock", "frame", "base"."""
    value: float
    std: float
    low90: float
    high90: float
    """Posterior mode, 1 sigma and 90 % interval [unit]."""
    unit: str
    prior: Range
    """What was known before."""
    identifiability: float
    """Share of the prior variance that the data removed [-], 0 to 1; of a member of a family, of its
    spread."""
    family: str = ""
    """Effect of its family; empty without one."""

    @property
    def determined(self) -> bool:
        """Return True if the data removed most of the prior variance."""
        return self.identifiability > CalibrationPolicy.determined


@dataclass(frozen=True)
class CalibratedFamily:
    """A family of effects."""

    effect: str
    parameter: str
    unit: str
    """The effect, one of its parameters, and that one's unit."""
    at: tuple[str, ...]
    """Its places."""
    shared: Range | None
    """Size that the members share; None for errors of either sign."""
    spread: float
    """Of the members about it: of their logarithms [-], or of errors of either sign [unit]."""


@dataclass(frozen=True)
class CalibratedFrame:
    """Pose of a frame of measurement in the base, as it was found: xyz [m], and roll, pitch, yaw [rad]."""

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
    """Effective number of parameters that the data determine: sum of identifiabilities of directions [-]."""
    inflation: Mapping[str, float]
    """By signal: variance of what is left over that of the noise, by which intervals are widened [-]."""

    @property
    def reduced(self) -> float:
        """Chi-square over its degrees of freedom [-]; 1 of a model that leaves noise."""
        return self.value / max(self.rows - self.parameters, 1.0)


def matrix(values: Any) -> Floats:
    """Return correlations as a square array."""
    found = np.asarray(values, dtype=float)
    return found.reshape(len(found), len(found))
